"""`realitygap effects`: what can be hidden in reality, and what the diagnosis calls it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, out_option
from realitygap.studies.cli.say import say


@app.command(epilog="Example: realitygap effects | less")
def effects(
    out: Annotated[
        Path | None, out_option("Write them as Markdown instead; must not exist yet.")
    ] = None,
    force: Force = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Names alone, a line each.")] = False,
) -> None:
    """Print the catalogue: names and keys for --effect, physics, and the cause that is named.

    Keys show [bounds] and unit; null is the value that changes nothing.
    """
    from rich.console import Console

    table = rg.effects(out=out, force=force)
    if out is not None:
        return
    if quiet:
        for name in table["effect"]:
            say(name)
        return
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
