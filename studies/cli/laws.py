"""`realitygap laws`: what an extension's laws say, as equations."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.outcome import Outcome, command
from realitygap.studies.cli.say import say_all

if TYPE_CHECKING:
    from pandas import DataFrame


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
