"""`realitygap rules`: every number that naming was tuned to."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, out_option
from realitygap.studies.cli.outcome import Outcome, command

if TYPE_CHECKING:
    from pandas import DataFrame

PIPED = 160
"""Letters of a line where nobody says how wide a terminal is. Our choice."""


@command(app, epilog="Example: realitygap rules | less")
def rules(
    out: Annotated[
        Path | None, out_option("Write them as Markdown instead; must not exist yet.")
    ] = None,
    force: Force = False,
) -> Outcome:
    """Print every number that naming was tuned to: value, unit, reason, and how it was set."""
    found = rg.rules(out=out, force=force)
    if out is not None:
        return Outcome(found, f"{len(found)} rules", out)
    return Outcome(found, show=lambda: _print(found))


def _print(found: DataFrame) -> None:
    """As a table."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE)
    for name in found.columns:
        table.add_column(name, no_wrap=name in ("rule", "value"))
    for one in found.to_dict("records"):
        table.add_row(one["rule"], f"{one['value']:.4g}", one["unit"], one["reason"], one["origin"])
    wide = None if sys.stdout.isatty() else PIPED
    Console(highlight=False, width=wide).print(table)
