"""`realitygap effects`: what can be hidden in reality, and what the diagnosis calls it."""

from __future__ import annotations

from typing import Annotated

import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.say import say


@app.command(epilog="Example: realitygap effects | less")
def effects(
    quiet: Annotated[bool, typer.Option("--quiet", help="Names alone, a line each.")] = False,
) -> None:
    """Print the catalogue: names and keys for --effect, physics, and the cause that is named.

    Keys show [bounds] and unit; null is the value that changes nothing.
    """
    from rich.console import Console

    from realitygap.studies.catalogue import KINDS, entries

    if quiet:
        for kind in KINDS:
            for entry in entries(kind):
                say(entry.effect.name)
        return
    console = Console(highlight=False)

    def write(text: str, style: str = "") -> None:
        console.print(text, style=style, markup=False, soft_wrap=not console.is_terminal)

    for kind, heading in KINDS.items():
        write(heading.upper(), "bold")
        for entry in entries(kind):
            effect = entry.effect
            write(f"\n  {effect.name}" + ("" if effect.per_robot else "  (place)"), "bold cyan")
            for key in entry.keys:
                write(f"      {key}")
            write(f"      physics: {effect.physics}")
            write(f"      diagnosis: {entry.cause or 'not in its catalogue'}")
            if entry.confusable_with:
                write(f"      confusable with: {', '.join(entry.confusable_with)}")
        write("")
