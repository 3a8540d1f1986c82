"""Bad input, said once and clearly."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

LONGEST = 200
"""Letters that are printed of a text from outside. Our choice: two lines of a terminal."""
LONGEST_EXPECTED = 1000
"""Letters that are printed of what would be valid: it may list every cause of the catalogue."""
LONGEST_NAME = 60
"""Letters of a name that are listed or compared; no name of ours is half as long."""


def shown(value: object, most: int = LONGEST) -> str:
    """A value as text that is safe to print: one line, escaped, cut with an ellipsis.

    Whatever is not printable (line ends, escape codes, marks that turn the direction of writing,
    bytes of a file's name that are no UTF-8) becomes its escape sequence.
    """
    try:
        text = str(value)
    except (ValueError, RecursionError):  # an integer of more digits than Python turns into text
        text = f"a {type(value).__name__} too large to print"
    short = text[: most + 1]
    if not short.isprintable():
        short = "".join(letter if letter.isprintable() else _escaped(letter) for letter in short)
    return short if len(short) <= most else short[: most - 1] + "…"


def quoted(value: object) -> str:
    """As `shown`, of the value as Python writes it: a text in quotation marks."""
    try:
        return shown(repr(value))
    except (ValueError, RecursionError):
        return shown(value)


def reason(error: BaseException) -> str:
    """What an exception says, in one line."""
    said = getattr(error, "strerror", None) or str(error).strip() or type(error).__name__
    return shown(str(said).splitlines()[0])


class InputError(ValueError):
    """Input that cannot be used: which field, what was received, what was expected.

    The command line prints it as one line and exits with 2. Its texts are as `shown`.
    """

    def __init__(self, field: str, got: object, expected: str) -> None:
        self.field, self.got = shown(field), shown(got)
        self.expected = shown(expected, LONGEST_EXPECTED)
        super().__init__(f"{self.field}: got {self.got}, expected {self.expected}")

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, str]]:
        """Of its fields: workers send it to their parent."""
        return type(self), (self.field, self.got, self.expected)


class Diverged(ArithmeticError):
    """A model or a world left the finite numbers; says where."""


def nearest(name: str, valid: Iterable[str]) -> str:
    """The valid names as text, and which of them is most like `name`."""
    names = [shown(one, LONGEST_NAME) for one in valid]
    close = difflib.get_close_matches(shown(name, LONGEST_NAME), names, n=1, cutoff=0.5)
    meant = f" (did you mean {close[0]}?)" if close else ""
    listed = shown(", ".join(names), LONGEST_EXPECTED - 2 * LONGEST_NAME)
    return f"one of {listed}{meant}"


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape", "surrogatepass").decode("ascii")
