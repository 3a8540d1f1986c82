"""`realitygap effects`: what can be hidden in reality, and what the diagnosis calls it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, out_option
from realitygap.studies.cli.outcome import Outcome, command
from realitygap.studies.cli.say import say_all

if TYPE_CHECKING:
    from pandas import DataFrame


@command(app, epilog="Example: realitygap effects | less")
def effects(
    out: Annotated[
        Path | None, out_option("Write them as Markdown instead; must not exist yet.")
    ] = None,
    force: Force = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Names alone, a line each.")] = False,
) -> Outcome:
    """Print the catalogue: names and keys for --effect, physics, and the cause that is named.

    Keys show [bounds] and unit; null is the value that changes nothing.
    """
    table = rg.effects(out=out, force=force)
    if out is not None:
        return Outcome(table, f"{len(table)} effects", out)
    if quiet:
        return Outcome(table, show=lambda: say_all(table["effect"]))
    return Outcome(table, show=lambda: _print(table))


def _print(table: DataFrame) -> None:
    """What the catalogue holds, in a few lines per effect."""
    from rich.console import Console

    console = Console(highlight=False)

    def write(text: str, style: str = "") -> None:
        console.print(text, style=style, markup=False, soft_wrap=not console.is_terminal)

    for kind, part in table.groupby("kind", sort=False):
        write(str(kind).upper(), "bold")
        for one in part.to_dict("records"):
            write(f"\n  {one['effect']}" + ("  (place)" if one["place"] else ""), "bold cyan")
            for key in one["keys"]:
                write(f"      {key}")
            write(f"      physics: {one['physics']}")
            write(f"      diagnosis: {one['cause'] or 'not in its catalogue'}")
            if one["confusable_with"]:
                write(f"      confusable with: {', '.join(one['confusable_with'])}")
        write("")
