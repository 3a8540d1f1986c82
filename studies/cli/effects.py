"""`realitygap effects`, `laws`, `rules`: what can be hidden, found as an equation, and tuned."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, out_option
from realitygap.studies.cli.outcome import Outcome, command, say_all

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


@command(app, epilog="Example: realitygap laws out/odd-diagnosis/extended.toml")
def laws(
    file: Annotated[Path, typer.Argument(help="A model file, such as extended.toml.")],
) -> Outcome:
    """Print the laws of a model file: equations in Unicode and LaTeX, readings, amplitudes."""
    found = rg.Model.load(file).laws
    if not len(found):
        return Outcome(found, f"{file.name} has no laws")
    return Outcome(found, show=lambda: say_all(list(_lines(found))))


def _lines(found: DataFrame) -> Iterator[str]:
    """Each law, and a line for each robot's amplitude."""
    for (_, equation, latex, reading), own in found.groupby(
        ["law", "equation", "latex", "reading"], sort=False
    ):
        yield str(equation)
        yield f"  LaTeX: {latex}"
        yield f"  {reading}"
        for one in own.to_dict("records"):
            who = "every other robot" if one["robot"] is None else f"robot {one['robot']}"
            unit = "" if one["unit"] == "1" else f" {one['unit']}"
            known = one["low"] == one["low"]  # not NaN
            interval = f" ({one['low']:.4g} to {one['high']:.4g})" if known else ""
            yield f"  {who}: a = {one['value']:.4g}{unit}{interval}"


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
    return Outcome(found, show=lambda: _print_rules(found))


def _print_rules(found: DataFrame) -> None:
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
