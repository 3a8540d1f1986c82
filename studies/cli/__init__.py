"""The command line, `realitygap`: one module per command; heavy imports wait until one runs."""

from __future__ import annotations

import importlib
import io
import sys
from typing import Any

import typer

from embedded_sim.errors import LONGEST_EXPECTED, Diverged, InputError, shown

app = typer.Typer(
    name="realitygap",
    help="Measure the reality gap of a robot swarm's simulator: show it, name its cause, close it.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)

COMMANDS = (
    "demo",
    "run",
    "capture",
    "import_",
    "gap",
    "study",
    "transfer",
    "reference",
    "diagnose",
    "gain",
    "effects",
    "blind",
)
"""Modules of this package; importing one adds its command to `app`."""

_UsageError: Any = typer.BadParameter.__base__
"""Typer's error for wrong words on the command line; it exports only this child of it."""

for _name in COMMANDS:
    importlib.import_module(f"studies.cli.{_name}")


def main() -> None:
    """Run a command: bad input is one line and exit code 2, divergence 1, an interrupt 130."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # as stderr does: a name that is no text, or a terminal without our letters
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        sys.exit(app(standalone_mode=False))
    except InputError as error:
        sys.stderr.write(f"realitygap: {error}\n")
        sys.exit(2)
    except _UsageError as error:
        if said := error.format_message():  # empty after a command without words: help was shown
            sys.stderr.write(f"realitygap: {shown(said, LONGEST_EXPECTED)} (see --help)\n")
        sys.exit(2)
    except Diverged as error:
        sys.stderr.write(f"realitygap: {shown(error, LONGEST_EXPECTED)}\n")
        sys.exit(1)
    except typer.Abort:
        sys.exit(130)
    except KeyboardInterrupt:
        sys.stderr.write("realitygap: interrupted\n")
        sys.exit(130)
