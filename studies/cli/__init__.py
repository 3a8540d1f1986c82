"""The command line, `realitygap`: a module per few commands; heavy imports wait until one runs."""

from __future__ import annotations

import atexit
import importlib
import logging
import sys
from typing import Annotated, Any

import typer

from realitygap.embedded_sim.errors import LONGEST_EXPECTED, Diverged, InputError, shown
from realitygap.studies.plumbing.lifetime import Ended, deafened, listening
from realitygap.studies.plumbing.rooms import clear_temporary, close_rooms
from realitygap.studies.plumbing.streams import open_streams

app = typer.Typer(
    name="realitygap",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)

COMMANDS = (
    "demo",
    "capture",
    "import_",
    "model",
    "gap",
    "replay",
    "study",
    "reference",
    "diagnose",
    "gain",
    "effects",
    "blind",
    "measure",
)
"""Modules of this package; importing one adds its commands to `app`."""

_UsageError: Any = typer.BadParameter.__base__
"""Typer's error for wrong words on the command line; it exports only this child of it."""


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"realitygap {version('reality-gap')}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Measure the reality gap of a robot swarm's simulator: show it, name its cause, close it."""


for _name in COMMANDS:
    importlib.import_module(f"realitygap.studies.cli.{_name}")


def main() -> None:
    """Run a command and end the process.

    Its exit code is 0, or what the command says of its result; 2 after bad input; 1 after
    divergence or if the machine failed, as a full disk; 128 and the number of the signal that
    ended it. Whatever it was, it is said in one line, and nothing unfinished is left.
    """
    out, err = open_streams()
    with listening():
        try:
            try:
                code, line = _outcome()
            finally:
                deafened()  # what is left to do is quick, and not to be left half done
        except Ended as ended:
            deafened()
            code, line = 128 + ended.number, str(ended)
        close_rooms()
        sys.stdout.flush()
        if out.failed:
            code, line = code or 1, line or f"cannot write to standard output: {out.failed}"
        if line:
            sys.stderr.write(f"realitygap: {line}\n")
        sys.stderr.flush()
    atexit.register(deafened)
    sys.exit(code or int(err.failed is not None))


def _outcome() -> tuple[int, str]:
    """A command's exit code, and the line that says why."""
    try:
        clear_temporary()
        return app(standalone_mode=False) or 0, ""
    except InputError as error:
        logging.getLogger("realitygap").debug("refused", exc_info=True)
        return 2, str(error)
    except _UsageError as error:
        said = error.format_message()  # empty after a command without words: help was shown
        return 2, f"{shown(said, LONGEST_EXPECTED)} (see --help)" if said else ""
    except Diverged as error:
        return 1, shown(error, LONGEST_EXPECTED)
    except OSError as error:
        path = error.filename2 or error.filename  # of a copy what is written
        where = "" if path is None else f"{shown(path)}: "
        return 1, f"{where}{shown(error.strerror or error)}"
