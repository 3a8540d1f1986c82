"""Bad input, said once and clearly."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Input that cannot be used: which field, what was received, what was expected.

    The command line prints it as one line and exits with 2.
    """

    def __init__(self, field: str, got: object, expected: str) -> None:
        self.field, self.got, self.expected = field, got, expected
        super().__init__(f"{field}: got {got}, expected {expected}")


class Diverged(ArithmeticError):
    """A model or a world left the finite numbers; says where."""


def nearest(name: str, valid: Iterable[str]) -> str:
    """The valid names as text, with the one most like `name` first in mind."""
    names = list(valid)
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    listed = ", ".join(names)
    return f"one of {listed} (did you mean {close[0]}?)" if close else f"one of {listed}"
