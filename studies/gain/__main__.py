"""`python -m realitygap.studies.gain --out DIR`: the gain over the catalogue, effect by effect."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Annotated, Any, Optional

import numpy as np
import pandas as pd
import typer
from rich.console import Console

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.blind.known import known_effects
from realitygap.studies.execution import Unfinished, Workers
from realitygap.studies.gain.catalogue import HIDDEN_BY_NATURE, groups, run_catalogue
from realitygap.studies.output import whole_file
from realitygap.studies.paper.page import number

MOST = 1.3
MEDIAN = 1.1
CLOSED = 0.8
"""What must hold: errors over healthy ones, their median, and the share of the gap closed."""


def main(
    out: Annotated[Path, typer.Option(help="The study's directory; goes on where it stopped.")],
    times: Annotated[float, typer.Option(help="Sizes in bars of the blind battery.")] = 2.0,
    runs: Annotated[int, typer.Option(help="Held-out runs of each altered reality.")] = 6,
    minutes: Annotated[float, typer.Option(help="Simulated minutes of each.")] = 2.0,
    draws: Annotated[int, typer.Option(help="Times every effect is drawn.")] = 1,
    seed: Annotated[int, typer.Option(help="Everything follows from it.")] = 0,
    jobs: Annotated[int, typer.Option(help="Processes.")] = 1,
    only: Annotated[
        Optional[list[str]],  # noqa: UP045 - typer reads this at run time
        typer.Option(help="Effect, repeatable; all that have a term if absent."),
    ] = None,
) -> None:
    """Hide every effect, name it from one log, extend the model, and measure on held-out runs."""
    names = tuple(only or (n for n in known_effects() if n not in HIDDEN_BY_NATURE))
    console = Console(highlight=False)
    asked: dict[str, Any] = {"times": times, "runs": runs, "minutes": minutes, "seed": seed}
    planned = groups(names, **asked, draws=draws)
    workers = Workers.chosen(jobs, None)
    table = run_catalogue(planned, {"effects": list(names), **asked}, out, workers, console.print)
    with whole_file(out / "catalogue.csv", force=True) as part:
        table.to_csv(part, index=False)
    with whole_file(out / "catalogue.md", force=True) as part:
        part.write_text(markdown(table), encoding="utf-8")
    console.print(markdown(table), markup=False)


def markdown(table: pd.DataFrame) -> str:
    """The table and its totals as Markdown."""
    lines = [
        "| effect | hidden | answer | where | minimal | healthy | extended | true "
        "| of healthy | gap closed |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in table.to_dict("records"):
        factor, unit = (1e3, f"m{row['unit']}") if row["unit"] in ("m", "rad") else (1, row["unit"])
        errors = [
            number(factor * row[name]) for name in ("before", "healthy", "extended", "oracle")
        ]
        cells = [
            row["effect"],
            row["hidden"],
            row["answer"],
            f"{row['channel']} ({unit})",
            *errors,
            _with_interval(row, "over_healthy", 1.0, ""),
            _with_interval(row, "closed", 100.0, " %"),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    named = table[table["answer"].str.startswith("named")]
    told = named[named["closed"].notna()]
    within, enough = told["over_healthy"] <= MOST, told["closed"] >= CLOSED
    lines += [
        "",
        f"{len(named)} of {len(table)} named; in {len(told)} of them there was something to gain: "
        f"error over healthy {told['over_healthy'].median():.2f} in the median "
        f"(at most {MEDIAN}), at most {MOST} in {within.sum()} of {len(told)}, "
        f"at least {CLOSED:.0%} of the gap closed in {enough.sum()} of {len(told)}.",
        "",
    ]
    return "\n".join(lines)


def _with_interval(row: Mapping[Hashable, Any], name: str, factor: float, unit: str) -> str:
    if np.isnan(row[name]):
        return "–"
    value, low, high = (factor * row[f"{name}{end}"] for end in ("", "_low", "_high"))
    digits = 0 if factor == 100.0 else 2
    return f"{value:.{digits}f}{unit} ({low:.{digits}f}–{high:.{digits}f})"


if __name__ == "__main__":
    try:
        typer.run(main)
    except (InputError, Unfinished) as error:
        sys.stderr.write(f"realitygap.studies.gain: {error}\n")
        sys.exit(2 if isinstance(error, InputError) else 1)
