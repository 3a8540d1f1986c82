"""Commands written for a reader, so that they can be pasted into a shell."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import Path


def typed(*words: object) -> str:
    """What a user would type: every word quoted for a shell where it needs to be.

    A path that begins with a dash is told from an option by `./`.

    What a terminal would not print (line ends, escape codes, bytes of a file's name that are no
    UTF-8) is written as bash and zsh spell it, `$'...'`.
    """
    dashed = [isinstance(word, Path) and str(word).startswith("-") for word in words]
    return " ".join(
        _quoted(f"./{word}" if dash else str(word))
        for word, dash in zip(words, dashed, strict=True)
    )


def option(name: str, values: Iterable[object]) -> list[object]:
    """The words of an option that is given once for each value."""
    return [word for value in values for word in (name, value)]


def _quoted(word: str) -> str:
    if word.isprintable():
        return shlex.quote(word)
    return "$'" + "".join(_spelt(letter) for letter in word) + "'"


def _spelt(letter: str) -> str:
    if letter in "\\'":
        return "\\" + letter
    if letter.isprintable():
        return letter
    # an octal escape ends after three digits, whatever follows
    return "".join(f"\\{byte:03o}" for byte in letter.encode("utf-8", "surrogateescape"))
