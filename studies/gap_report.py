"""The gap report: `gap.json`, a tidy table, and a figure, from a measured log and a model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from embedded_sim import InputError, PointModel
from models.horizons import horizon_errors
from models.log import MeasuredLog

SCHEMA = 1


def write_gap(log: MeasuredLog, model: PointModel, out: Path) -> dict[str, Any]:
    """Write `gap.json`, `horizons.parquet` and `horizons.png` into an existing directory.

    Raises:
        InputError: no window of any horizon lies within the log.
    """
    table = horizon_errors(log, model)
    if table.empty:
        raise InputError("log", "no two tracked rows in a row", "at least one replayable step")
    report = {
        "schema": SCHEMA,
        "log": {
            "rows": len(log.t),
            "runs": int(log.segments["run"].nunique()),
            "robots": int(log.segments["robot"].nunique()),
            "step_s": log.step,
        },
        "horizons": summarise(table),
        "notes": list(log.notes),
    }
    table.to_parquet(out / "horizons.parquet", index=False)
    _figure(table, out / "horizons.png")
    (out / "gap.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    return report


def summarise(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Per horizon, the median over robots and runs of their median errors."""
    rows = []
    for name, part in table.groupby("horizon", sort=False):
        rows.append(
            {
                "horizon": name,
                "seconds": float(part["seconds"].median()),
                "windows": int(part["windows"].sum()),
                "position_median_m": float(part["position_median"].median()),
                "heading_median_rad": float(part["heading_median"].median()),
            }
        )
    return rows


def _figure(table: pd.DataFrame, path: Path) -> None:
    """Error against horizon, one line per robot and run."""
    sns.set_theme(style="whitegrid")
    figure = Figure(figsize=(9, 4), layout="constrained")
    axes = figure.subplots(1, 2)
    who = table["run"] + " / " + table["robot"].astype(str)
    for axis, channel, unit in zip(axes, ("position", "heading"), ("m", "rad"), strict=True):
        sns.lineplot(
            x=table["seconds"],
            y=table[f"{channel}_median"],
            units=who,
            estimator=None,
            ax=axis,
            marker="o",
            alpha=0.6,
        )
        axis.set(xscale="log", yscale="log", xlabel="horizon (s)")
        axis.set_ylabel(f"median {channel} error ({unit})")
    figure.suptitle("What the point model gets wrong, by horizon")
    figure.savefig(path, dpi=120, metadata={"Software": ""})
