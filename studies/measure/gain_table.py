"""`realitygap measure gain`: the gain over the catalogue, effect by effect, as a table."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.studies.blind.battery import known_effects
from realitygap.studies.measure.gain import HIDDEN_BY_NATURE, groups, run_catalogue
from realitygap.studies.pages.page import number
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.run.settings import run_config

MOST = 1.3
MEDIAN = 1.1
CLOSED = 0.8
"""What must hold: errors over healthy ones, their median, and the share of the gap closed."""


def measure_gains(
    out: Path,
    *,
    times: float = 2.0,
    runs: int = 6,
    minutes: float = 2.0,
    draws: int = 1,
    seed: int = 0,
    jobs: int | None = None,
    only: Sequence[str] = (),
    say: Callable[[str], None] = lambda line: None,
) -> str:
    """Hide every effect, name it from one log, extend the model, and measure on held-out runs.

    Args:
        out: The study's directory, with catalogue.csv and catalogue.md; it goes on where it
            stopped.
        times: Sizes in bars of the blind battery.
        runs: Held-out runs of each altered reality.
        minutes: Simulated, of each.
        draws: Times every effect is drawn.
        seed: Everything random follows from it.
        jobs: Processes; all cores if absent.
        only: Effects; all that have a term if absent.
        say: Told in a line of what is done, and of what went wrong.

    Returns:
        The table and its totals as Markdown.

    Raises:
        InputError: there is no such effect, a value cannot be used, or `out` cannot be used.
        Unfinished: the healthy runs could not be measured.
    """
    known = [name for name in known_effects() if name not in HIDDEN_BY_NATURE]
    for name in only:
        if name not in known:
            raise InputError("--only", repr(name), nearest(name, known))
    if not 0.0 < times < np.inf:
        raise InputError("--times", times, "a number above 0")
    run_config(minutes=minutes, seed=seed)  # refused before anything is written
    names = list(only or known)
    asked: dict[str, Any] = {"times": times, "runs": runs, "minutes": minutes, "seed": seed}
    planned = groups(names, **asked, draws=draws)
    workers = Workers.chosen(jobs, None)
    table = run_catalogue(planned, {"effects": names, **asked}, out, workers, say)
    text = markdown(table)
    with whole_file(out / "catalogue.csv", force=True) as part:
        table.to_csv(part, index=False)
    with whole_file(out / "catalogue.md", force=True) as part:
        part.write_text(text, encoding="utf-8")
    return text


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
