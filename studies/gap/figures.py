"""The gap in pictures: error against horizon, shares, residual maps, the arena, the sensors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from realitygap.models.gap.flips import Means
from realitygap.models.gap.motion_gap import UNITS, MotionGap
from realitygap.models.gap.sensor_gap import SensorGap
from realitygap.models.gap.whole import COLUMNS, LEVEL, Gap
from realitygap.models.log.measured import MeasuredLog
from realitygap.studies.fitness_gap.generations import CoevolutionGap
from realitygap.studies.pages.drawing import save, themed

MAPPED = "1 s"
"""Horizon whose maps are drawn; `maps.parquet` has every horizon."""
CELLS = 12
"""Cells of the arena's picture along each axis."""
LEAST_REACH = 0.01
"""m from the middle that a map shows at least, of a robot that stayed there."""
ACROSS = 6
"""Conditions side by side."""
MOST_LABELS = 12
DIVERGING = "vlag"
SHARE_COLOURS = {"noise": "0.75", "bias": "C1", "structured": "C3"}


def draw_figures(
    log: MeasuredLog, gap: Gap, out: Path, coevolution: CoevolutionGap | None = None
) -> None:
    """Write the figures into a directory: horizons, shares, maps, arena, sensors, coevolution."""
    with themed():
        save(_horizons(gap), out / "horizons.png")
        save(_shares(gap), out / "shares.png")
        drawn = next((g for g in gap.motion if g.horizon == MAPPED), None)
        drawn = drawn or (gap.motion[-1] if gap.motion else None)
        if drawn is not None:
            save(_maps(drawn), out / "maps.png")
            if drawn.table[["x", "y"]].notna().all(axis=1).any():  # else nobody knows where it was
                save(_arena(log, drawn), out / "arena.png")
        if (sensors := _sensors(gap)) is not None:
            save(sensors, out / "sensors.png")
        if coevolution is not None:
            draw_coevolution(coevolution, out)


def draw_coevolution(found: CoevolutionGap, out: Path) -> None:
    """Write the figure of the gap in fitness into a directory."""
    with themed():
        save(_coevolution(found), out / "coevolution.png")


def _horizons(gap: Gap) -> Figure:
    """Median error against horizon, a line per robot and run, with what noise alone would give."""
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    for axis, channel in zip(figure.subplots(1, 2), COLUMNS, strict=True):
        draw_horizon(gap.horizons, channel, axis)
    figure.suptitle("How far the point model is off")
    return figure


def draw_horizon(horizons: pd.DataFrame, channel: str, axis: Axes) -> None:
    """The error of position or heading against horizon."""
    who = horizons["run"].astype(str) + horizons["robot"].astype(str)
    single = {"color": "C0", "alpha": 0.3, "lw": 0.8, "units": "who", "estimator": None}
    table = horizons.assign(who=who)
    sns.lineplot(table, x="seconds", y=f"{channel}_median", ax=axis, **single)
    middle = table.groupby("horizon", sort=False).median(numeric_only=True)
    for part, style, colour, label in (
        ("median", "o-", "C0", "median"),
        ("p95", "^:", "C0", "95 %"),
        ("noise", "s--", "0.4", "noise alone"),
    ):
        values = middle[f"{channel}_{part}"]
        axis.plot(middle["seconds"], values, style, color=colour, label=label)
    unit = COLUMNS[channel]
    axis.set(xscale="log", yscale="log", xlabel="horizon (s)", ylabel=f"{channel} error ({unit})")
    axis.legend()


def _shares(gap: Gap) -> Figure:
    """Stacked shares of every channel."""
    rows = gap.shares()
    figure = Figure(figsize=(8, 0.6 + 0.24 * len(rows)), layout="constrained")
    axis = figure.subplots()
    names = [" ".join(filter(None, (channel, horizon))) for _, horizon, channel, _ in rows]
    left = np.zeros(len(rows))
    for part, colour in SHARE_COLOURS.items():
        width = np.array([getattr(share, part) for *_, share in rows])
        axis.barh(np.arange(len(rows)), width, left=left, color=colour, label=part)
        left += width
    axis.set(yticks=range(len(rows)), yticklabels=names, xlim=(0, 1))
    axis.set_xlabel("share of the mean square error")
    axis.invert_yaxis()
    axis.grid(False)
    figure.legend(loc="outside upper center", ncols=3)
    return figure


def _maps(gap: MotionGap) -> Figure:
    """Group means of every channel over every condition, in units of the channel's noise."""
    names = list(dict.fromkeys(m.condition for m in gap.maps if m.condition != "all"))
    by = {(m.condition, m.channel): m for m in gap.maps}
    bands = -(-len(names) // ACROSS)
    figure = Figure(figsize=(2.3 * ACROSS, 5.6 * bands), layout="constrained")
    axes = figure.subplots(bands * len(UNITS), ACROSS, sharey="row", squeeze=False)
    for at, axis in enumerate(axes.flat):
        line, column = divmod(at, ACROSS)
        band, part = divmod(line, len(UNITS))
        if (which := band * ACROSS + column) >= len(names):
            axis.set_axis_off()
            continue
        channel = list(UNITS)[part]
        _map(axis, by[names[which], channel], labelled=part == len(UNITS) - 1)
        axis.set_title(names[which].replace("_", " ") if part == 0 else "")
        axis.set_ylabel(f"{channel} ({UNITS[channel]})" if column == 0 else "")
    figure.suptitle(
        f"Mean error over {gap.horizon} by condition (2 standard errors; red: beyond chance)"
    )
    return figure


def _map(axis: Axes, found: Means, *, labelled: bool) -> None:
    """One map: points with two standard errors."""
    shown = found.number > 0
    at = np.arange(len(found.labels))[shown]
    colour = "C3" if found.p <= LEVEL else "0.4"
    axis.errorbar(at, found.mean[shown], 2 * found.error[shown], fmt="o", color=colour, ms=3)
    axis.axhline(0.0, color="k", lw=0.6)
    labels = [label.removeprefix("robot ").removeprefix("run ") for label in found.labels]
    axis.set_xticks(range(len(labels)) if len(labels) <= MOST_LABELS else [])
    axis.set_xticklabels([])
    if labelled and len(labels) <= MOST_LABELS:
        axis.set_xticklabels(labels, rotation=90, fontsize=6)


def _arena(log: MeasuredLog, gap: MotionGap) -> Figure:
    """Median size of the position error, and mean heading error, by place."""
    known = gap.table[["x", "y"]].notna().all(axis=1).to_numpy()
    x, y = gap.table.loc[known, ["x", "y"]].to_numpy().T
    error = gap.error[known]
    reach = max(float(np.abs([x, y]).max()) * 1.001, LEAST_REACH)
    edges = np.linspace(-reach, reach, CELLS + 1)
    cell = pd.DataFrame({"i": np.digitize(y, edges) - 1, "j": np.digitize(x, edges) - 1})
    cell["position error (mm)"] = 1000 * np.hypot(error[:, 0], error[:, 1])
    cell["heading error (rad)"] = error[:, 2]
    figure = Figure(figsize=(10, 4.6), layout="constrained")
    for axis, name in zip(figure.subplots(1, 2), cell.columns[2:], strict=True):
        signed = name.startswith("heading")
        grid = np.full((CELLS, CELLS), np.nan)
        medians = cell.groupby(["i", "j"])[name].median().reset_index()
        grid[medians["i"], medians["j"]] = medians[name]
        most = float(np.nanquantile(np.abs(grid), 0.98))
        limits = (-most, most) if signed else (0.0, most)
        image = axis.pcolormesh(
            edges,
            edges,
            grid,
            cmap=DIVERGING if signed else "rocket_r",
            vmin=limits[0],
            vmax=limits[1],
        )
        figure.colorbar(image, ax=axis, label=f"median {name}")
        axis.set(aspect="equal", xlabel="x (m)", ylabel="y (m)")
        axis.grid(False)
    figure.suptitle(f"Where the model is off over {gap.horizon} ({len(log.segments)} tracks)")
    return figure


def _mapped(sensor: SensorGap) -> list[list[Means]]:
    """Maps of what sensors read by what they look at, and by nearness to robots; those seen."""
    names = {"ps": ("wall_distance", "near_robot"), "ls": ("lamp_distance", "lamp_bearing")}
    by_name = [[m for m in sensor.maps if m.condition == n] for n in names[sensor.kind]]
    return [maps for maps in by_name if any((m.number > 0).any() for m in maps)]


def _sensors(gap: Gap) -> Figure | None:
    """Mean residual of every sensor; None: no sensor saw anything."""
    shown = [(sensor, maps) for sensor in gap.sensors for maps in _mapped(sensor)]
    if not shown:
        return None
    figure = Figure(figsize=(10, 3.5 * -(-len(shown) // 2)), layout="constrained")
    axes = figure.subplots(-(-len(shown) // 2), 2, squeeze=False).ravel()
    for axis in axes[len(shown) :]:
        axis.set_axis_off()
    for axis, (_, maps) in zip(axes, shown, strict=False):
        grid = np.array([np.where(m.number > 0, m.mean, np.nan) for m in maps])
        most = max(float(np.nanmax(np.abs(grid))), 1.0)
        sns.heatmap(
            grid,
            ax=axis,
            cmap=DIVERGING,
            vmin=-most,
            vmax=most,
            annot=True,
            fmt=".0f",
            xticklabels=list(maps[0].labels),
            yticklabels=[m.channel for m in maps],
            cbar_kws={"label": "measured - predicted (counts)"},
        )
        axis.set_xlabel(maps[0].condition.replace("_", " "))
        axis.tick_params(axis="y", rotation=0)
    figure.suptitle("What the sensors read beyond the prediction")
    return figure


def _coevolution(found: CoevolutionGap) -> Figure:
    """F_S against F_R per generation, by whether S0's third matches the light."""
    figure = Figure(figsize=(10, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    table = found.table.assign(S0=np.where(found.table["matches"], "right third", "wrong third"))
    order = ["right third", "wrong third"]
    sns.scatterplot(
        table, x="fitness_real", y="fitness_sim", hue="S0", hue_order=order, s=14, ax=left
    )
    most = float(table[["fitness_real", "fitness_sim"]].max().max())
    left.plot([0, most], [0, most], "k--", lw=0.8)
    left.set(xlabel="fitness in reality, F_R (s)", ylabel="fitness in the simulator, F_S (s)")
    sns.boxplot(table, x="S0", y="gap", order=order, ax=right, color="0.8", showfliers=False)
    right.axhline(0.0, color="k", lw=0.6)
    right.set(xlabel="", ylabel="F_S - F_R (s)")
    return figure
