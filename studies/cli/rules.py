"""`realitygap rules`: every number that naming was tuned to."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, out_option

PIPED = 160
"""Letters of a line where nobody says how wide a terminal is. Our choice."""


@app.command(epilog="Example: realitygap rules | less")
def rules(
    out: Annotated[
        Path | None, out_option("Write them as Markdown instead; must not exist yet.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON, a list of objects.")] = False,
    force: Force = False,
) -> None:
    """Print every number that naming was tuned to: value, unit, reason, and how it was set."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    found = rg.rules(out=out, force=force)
    if out is not None:
        return
    if as_json:
        typer.echo(found.to_json(orient="records", indent=1, force_ascii=False))
        return
    table = Table(box=box.SIMPLE)
    for name in found.columns:
        table.add_column(name, no_wrap=name in ("rule", "value"))
    for one in found.to_dict("records"):
        table.add_row(one["rule"], f"{one['value']:.4g}", one["unit"], one["reason"], one["origin"])
    wide = None if sys.stdout.isatty() else PIPED
    Console(highlight=False, width=wide).print(table)
