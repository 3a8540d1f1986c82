"""Lines for the person at the terminal."""

from __future__ import annotations

from collections.abc import Iterable

import typer

from realitygap.embedded_sim.errors import shown

LONGEST_LINE = 2000
"""Letters of a line: our own are shorter, and what they quote may be of any length."""


def say(line: str, *, err: bool = False) -> None:
    """Print a line, with what is not printable escaped."""
    typer.echo(shown(line, LONGEST_LINE), err=err)


def say_all(lines: Iterable[str]) -> None:
    """Print lines."""
    for line in lines:
        say(line)
