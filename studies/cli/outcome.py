"""How every command speaks and ends: its result in one line and where its page is, or as JSON."""

from __future__ import annotations

import inspect
import logging
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, redirect_stdout
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ParamSpec, cast

import typer

import realitygap as rg
from realitygap.embedded_sim.errors import InputError, nearest, shown

LONGEST_LINE = 2000
"""Letters of a line: our own are shorter, and what they quote may be of any length."""


def say(line: str, *, err: bool = False) -> None:
    """Print a line, with what is not printable escaped."""
    typer.echo(shown(line, LONGEST_LINE), err=err)


def say_all(lines: Iterable[str]) -> None:
    """Print lines."""
    for line in lines:
        say(line)


if TYPE_CHECKING:
    from pandas import DataFrame

LEVELS = ("debug", "info", "warning", "error")
"""Of --log-level: `logging`'s own, from everything to errors alone."""

P = ParamSpec("P")

AsJson = Annotated[
    bool,
    typer.Option("--json", help="Print the result as JSON alone; messages go to standard error."),
]
LogLevel = Annotated[
    str, typer.Option("--log-level", help=f"What is logged on standard error: {', '.join(LEVELS)}.")
]


@dataclass(frozen=True)
class Outcome:
    """What a command came to."""

    result: Any
    """For --json: an object of JSON, a table, or a file (.json, .csv) that holds it."""
    line: str = ""
    """The result in one line; empty: what `show` prints is the result."""
    page: Path | None = None
    """What to look at: a page, or else the file or directory that was written."""
    notes: Sequence[str] = ()
    """Lines before that line."""
    show: Callable[[], None] | None = None
    """Prints what a command was asked to print, also if quiet."""
    code: int = 0
    """The exit code."""

    def tell(self, quiet: bool) -> None:
        """Print it for the person at the terminal."""
        if self.show is not None:
            self.show()
        if quiet:
            return
        say_all(self.notes)
        end = "" if self.page is None else f" See {shown(self.page, LONGEST_LINE)}"
        if self.line:
            line = shown(self.line, LONGEST_LINE)
            typer.echo(line.removesuffix(".") + f".{end}" if end else line)

    def print_json(self) -> None:
        """Print it for a script."""
        from realitygap.studies.plumbing.provenance import as_json_bytes

        result = self.result
        if isinstance(result, Path) and result.suffix == ".json":
            typer.echo(result.read_text(encoding="utf-8"), nl=False)
            return
        if isinstance(result, Path):
            import pandas as pd

            result = pd.read_csv(result)
        if hasattr(result, "to_json"):
            result = records(result)
        typer.echo(as_json_bytes(result), nl=False)


def records(table: DataFrame) -> Any:
    """A table as JSON has it: an object per row; what is missing or not finite is null."""
    import json

    return json.loads(table.to_json(orient="records", double_precision=15))


def command(
    group: typer.Typer, *, epilog: str, name: str | None = None
) -> Callable[[Callable[P, Outcome]], Callable[P, Outcome]]:
    """Make a function a command of a group, with --json and --log-level.

    Its docstring is the help, wrapped anew to the terminal.

    Args:
        group: The app or one of its groups.
        epilog: An example.
        name: If it is not the function's.
    """

    def added(function: Callable[P, Outcome]) -> Callable[P, Outcome]:
        @wraps(function)
        def run(*, as_json: bool, log_level: str, **words: Any) -> None:
            _listen(log_level)
            with redirect_stdout(sys.stderr) if as_json else nullcontext():
                ended = cast("Callable[..., Outcome]", function)(**words)
            if as_json:
                ended.print_json()
            else:
                ended.tell(quiet=words.get("quiet", False))
            if ended.code:
                raise typer.Exit(ended.code)

        own, shared = (inspect.signature(one, eval_str=True) for one in (function, _shared))
        both = [*own.parameters.values(), *shared.parameters.values()]
        run.__signature__ = own.replace(parameters=both)  # type: ignore[attr-defined]
        run.__annotations__ = {one.name: one.annotation for one in both}
        paragraphs = (inspect.getdoc(function) or "").split("\n\n")
        text = "\n\n".join(" ".join(one.split()) for one in paragraphs)
        group.command(name, help=text, epilog=epilog)(run)
        return function

    return added


def _shared(*, as_json: AsJson = False, log_level: LogLevel = "warning") -> None:
    """The options that every command has."""


def _listen(level: str) -> None:
    """Show what is logged, ours and the libraries', on standard error."""
    if level not in LEVELS:
        raise InputError("--log-level", repr(level), nearest(level, LEVELS))
    form = "%(levelname)s %(name)s: %(message)s"
    logging.basicConfig(level=level.upper(), format=form, force=True)


@contextmanager
def resumable() -> Iterator[None]:
    """Turn work that ended before it was whole into one line and exit code 1."""
    try:
        yield
    except rg.Unfinished as error:
        say(f"realitygap: {error}; start the command again to go on", err=True)
        raise typer.Exit(1) from None
