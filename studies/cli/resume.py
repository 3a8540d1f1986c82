"""What a command says that can be started again to go on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import typer

import realitygap as rg
from realitygap.studies.cli.say import say


@contextmanager
def resumable() -> Iterator[None]:
    """Turn work that ended before it was whole into one line and exit code 1."""
    try:
        yield
    except rg.Unfinished as error:
        say(f"realitygap: {error}; start the command again to go on", err=True)
        raise typer.Exit(1) from None
