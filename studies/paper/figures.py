"""The paper's figures 6, 7 and 8, in its form and order."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from realitygap.studies.paper.conditions import COEVOLVED, LABELS, LAMP_RANGE, PAPER
from realitygap.studies.paper.readings import DEFAULT, LAMPS
from realitygap.studies.paper.tables import StudyTables

DARK, LIGHT, POINT = "#33658a", "#a9c6de", "#222222"
"""Before and after half-time, and single runs."""
THIRDS = ("#f2b134", "#9aa5b1", "#2a9d8f")
"""Light opposite, no light, light at nest."""
THIRD_NAMES = ("light opposite", "no light", "light at nest")
EDGES = (0.0, 0.33, 0.66, 0.99)
"""Of the thirds of S0 (paper, Fig. 5)."""
PERIODS = 20
"""Boxes along a run in Fig. 8: 3 minutes each in an hour; our choice."""


def save(figure: Figure, path: Path) -> None:
    """PNG and SVG, the same bytes for the same numbers."""
    with mpl.rc_context({"svg.hashsalt": path.stem, "svg.fonttype": "none"}):
        figure.savefig(path.with_suffix(".png"), dpi=110, metadata={"Software": ""})
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None, "Creator": None})


def style() -> None:
    """One look for all figures."""
    sns.set_theme(style="whitegrid", context="notebook", font_scale=0.85)


def food(tables: StudyTables) -> Figure:
    """Fig. 6: total food per condition, mean and distribution, halves shaded apart."""
    figure = Figure(figsize=(10, 4.6), layout="constrained")
    axes = figure.subplots()
    names = [condition.name for condition in PAPER]
    papers = tables.runs[tables.runs["condition"].isin(names)]
    data = papers.assign(condition=pd.Categorical(papers["condition"], names))
    common = {"data": data, "x": "condition", "ax": axes, "errorbar": None, "width": 0.72}
    sns.barplot(y="food_total", color=LIGHT, **common)
    sns.barplot(y="food_first", color=DARK, **common)
    sns.boxplot(
        data=data, x="condition", y="food_total", ax=axes, width=0.3, fill=False, color=POINT,
        linewidth=1.1, showfliers=False,
    )  # fmt: skip
    sns.stripplot(
        data=data, x="condition", y="food_total", ax=axes, size=3, color=POINT, jitter=False
    )
    axes.axvline(4.5, color="0.5", linestyle=":")
    _label(axes, names)
    axes.set(xlabel="", ylabel="items brought to the nest in a run")
    half = tables.minutes / 2.0
    handles = [
        Patch(color=DARK, label=f"mean before {half:g} min"),
        Patch(color=LIGHT, label=f"mean after {half:g} min"),
        Line2D([], [], color=POINT, marker="o", markersize=3, label="runs (box: quartiles)"),
    ]
    axes.legend(handles=handles, frameon=True)
    axes.set_title("Fig. 6: total food collected")
    return figure


def retrieval(tables: StudyTables) -> Figure:
    """Fig. 7: time from pick-up to nest in each half, a value per run."""
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    axes = figure.subplots()
    names = [condition.name for condition in COEVOLVED]
    half = f"{tables.minutes / 2.0:g} min"
    rows = (
        tables.runs[tables.runs["condition"].isin(names)]
        .melt(
            id_vars=["condition", "run"],
            value_vars=["retrieval_first", "retrieval_second"],
            var_name="half",
            value_name="seconds",
        )
        .dropna(subset=["seconds"])
    )
    rows["half"] = rows["half"].map(
        {"retrieval_first": f"T < {half}", "retrieval_second": f"T > {half}"}
    )
    common = {"data": rows, "x": "condition", "y": "seconds", "hue": "half", "order": names}
    palette = [DARK, LIGHT]
    if len(rows):  # in a study so short that nothing was brought home there is nothing to draw
        sns.boxplot(**common, ax=axes, palette=palette, width=0.6, showfliers=False)
        sns.stripplot(
            **common,
            ax=axes,
            palette=[POINT, POINT],
            dodge=True,
            size=3,
            legend=False,
            jitter=False,
        )
        _label(axes, names)
        axes.legend(title=None, frameon=True)
    axes.set(xlabel="", ylabel="mean time from pick-up to nest (s)")
    axes.set_title("Fig. 7: retrieval time, a point per run")
    return figure


def beliefs(tables: StudyTables) -> Figure:
    """Fig. 8: mean S0 over time, and beside it the share of robots in each third."""
    figure = Figure(figsize=(12, 13), layout="constrained")
    panels = figure.subplots(len(COEVOLVED), 2, sharex=True, sharey=True)
    width = tables.minutes / PERIODS
    evolved = tables.generations[tables.generations["s0"].notna()]
    period = np.minimum(evolved["minute"] // width, PERIODS - 1).astype(int)
    evolved = evolved.assign(period=period)
    for (left, right), condition in zip(panels, COEVOLVED, strict=True):
        rows = evolved[evolved["condition"] == condition.name]
        _boxes(left, rows, width)
        _shares(right, rows, width)
        for axes in (left, right):
            if condition.case in ("at-nest-to-opposite", "opposite-to-at-nest"):
                axes.axvline(tables.minutes / 2.0, color="crimson", linestyle="--", linewidth=1.2)
            axes.set(xlim=(0.0, tables.minutes), ylim=(0.0, 1.0))
        left.set_ylabel(f"{LABELS[condition.name]}\nmean S0 of the swarm")
        right.set_ylabel("share of robots")
    panels[0, 0].set_title("Fig. 8: mean S0, a box per period over runs")
    panels[0, 1].set_title("What the robots believe: share in each third")
    handles = [
        Patch(color=color, label=name) for color, name in zip(THIRDS, THIRD_NAMES, strict=True)
    ]
    panels[0, 1].legend(handles=handles, frameon=True, loc="upper right")
    for axes in panels[-1]:
        axes.set_xlabel("time (min)")
    return figure


def lamps(weighed: pd.DataFrame, claims: pd.DataFrame) -> Figure:
    """Estimates of the claims of Fig. 6 against the lamp's range, with their intervals.

    Args:
        weighed: `readings.csv`.
        claims: `claims.csv`, for where each is true.
    """
    ranges = {DEFAULT: LAMP_RANGE, **{name: one["lamp_range"] for name, one in LAMPS.items()}}
    rows = weighed[weighed["variant"].isin(ranges) & (weighed["low"] > 0.0)]
    ordered = claims[claims["family"] == "Fig. 6"]
    figure = Figure(figsize=(13, 5.6), layout="constrained")
    panels = figure.subplots(2, -(-len(ordered) // 2), sharex=True).flat
    for axes, (_, claim) in zip(panels, ordered.iterrows(), strict=False):
        found = rows[rows["claim"] == claim["claim"]]
        at = found["variant"].map(ranges)
        reach = [found["effect"] - found["low"], found["high"] - found["effect"]]
        axes.errorbar(at, found["effect"], reach, fmt="o", color=DARK, capsize=3)
        axes.axhspan(
            claim["claimed_above"], min(claim["claimed_below"], 1e3), color=LIGHT, alpha=0.4
        )
        ends = [*found["low"], *found["high"], claim["claimed_above"]]
        axes.set(yscale="log", ylim=(0.8 * min(ends), 1.25 * max(ends)))
        axes.set_title(claim["claim"], fontsize=9)
    figure.supxlabel("lamp's range (m)")
    figure.supylabel("estimate (shaded: the claim is true)")
    return figure


def _boxes(axes: Axes, rows: pd.DataFrame, width: float) -> None:
    """Mean S0 of a run in each period, boxed over runs; the thirds shaded."""
    for color, low, high in zip(THIRDS, EDGES[:-1], EDGES[1:], strict=True):
        axes.axhspan(low, high, color=color, alpha=0.22, linewidth=0)
    means = rows.groupby(["index", "period"], sort=True)["s0"].mean().reset_index()
    means["minute"] = (means["period"] + 0.5) * width
    if len(means):
        sns.boxplot(
            data=means, x="minute", y="s0", native_scale=True, ax=axes, color="white", width=0.7,
            linewidth=0.9, fliersize=2,
        )  # fmt: skip
    axes.set_xlabel("")
    axes.grid(visible=False)


def _shares(axes: Axes, rows: pd.DataFrame, width: float) -> None:
    """Stacked shares of robots over time."""
    if rows.empty:
        return
    shares = pd.crosstab(rows["period"], rows["s0_third"], normalize="index")
    shares = shares.reindex(columns=range(3), fill_value=0.0)
    minutes = (shares.index.to_numpy() + 0.5) * width
    axes.stackplot(minutes, shares.to_numpy(dtype=float).T, colors=THIRDS, alpha=0.9)
    axes.grid(visible=False)


def _label(axes: Axes, names: list[str]) -> None:
    axes.set_xticks(range(len(names)))
    axes.set_xticklabels([LABELS[name].replace(" ", "\n", 1) for name in names])
