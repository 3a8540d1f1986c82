"""The pictures of a diagnosis: error before and after, rivals, profiles, what is left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.examination import KINDS, Examination
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.findings import Named

PROFILE_POINTS = 21
DPI = 100


def draw_errors(table: pd.DataFrame, concerned: set[int], path: Path) -> None:
    """Error by how far ahead, of the robots concerned, and per robot after the longest time."""
    figure = _figure(10, 3.6)
    by_time, by_robot = figure.subplots(1, 2, width_ratios=(1, 1.5))
    table = table.assign(error=1e3 * table["error"])
    mine = table[table["robot"].isin(concerned)] if concerned else table
    options = {"hue": "kind", "hue_order": [k for k in KINDS if (table["kind"] == k).any()]}
    sns.lineplot(mine, x="seconds", y="error", style="kind", markers=True, ax=by_time, **options)
    by_time.set(xscale="log", yscale="log", xlabel="s ahead", ylabel="mean position error (mm)")
    by_time.set_xticks(ticks := sorted(table["seconds"].unique()), [f"{t:g}" for t in ticks])
    by_time.legend(title=None, fontsize=8)
    last = table[table["seconds"] == table["seconds"].max()]
    sns.barplot(last, x="robot", y="error", ax=by_robot, legend=False, **options)
    by_robot.set(xlabel="robot", ylabel=f"mm, {last['seconds'].max():g} s ahead")
    _save(figure, path)


def draw_rivals(named: tuple[Named, ...], path: Path) -> None:
    """What every term took off the held-out error at each named cause's turn."""
    figure = _figure(10, 0.6 + 2.6 * len(named))
    for axis, one in zip(np.atleast_1d(figure.subplots(len(named), 1)), named, strict=True):
        gains = [(name, max(gain, 0.0)) for name, gain in one.evidence.gains][:8]
        names, values = [n for n, _ in gains], [v for _, v in gains]
        sns.barplot(x=values, y=names, ax=axis, color="#4878a8")
        axis.set(xlabel="deviance taken off held-out blocks", ylabel="")
        axis.set_title(f"{one.term.cause.name}: against its rivals", fontsize=10)
    _save(figure, path)


def draw_curves(curves: Sequence[tuple[str, str, FloatArray, FloatArray]], path: Path) -> None:
    """What follows a quantity without a law: channel, quantity, its values, amplitudes."""
    figure = _figure(10, 3.0)
    for axis, (channel, of, at, size) in zip(
        np.atleast_1d(figure.subplots(1, len(curves))), curves, strict=True
    ):
        axis.plot(at, size, color="#4878a8")
        axis.axhline(0.0, color="#222222", linewidth=1)
        axis.set(xlabel=of.replace("_", " "), ylabel=f"change of {channel}")
    _save(figure, path)


def draw_profiles(examined: Examination, path: Path) -> None:
    """Deviance against each named parameter, the robot's other terms as found."""
    shown = [one for one in examined.diagnosis.named if one.term.cause.smooth][:3]
    figure = _figure(10, 3.0)
    for axis, one in zip(np.atleast_1d(figure.subplots(1, len(shown))), shown, strict=True):
        value = one.values[0]
        reach = max(value.high - value.value, value.value - value.low, 1e-12)
        parameter = one.term.cause.parameters[0]
        low, high = max(parameter.low, value.value - 3 * reach), value.value + 3 * reach
        tried = np.linspace(low, min(high, parameter.high), PROFILE_POINTS)
        loss = _profile(examined, one, tried)
        axis.plot(tried, loss - loss.min(), color="#4878a8")
        axis.axvspan(value.low, value.high, alpha=0.2, color="#4878a8")
        axis.axvline(value.value, color="#222222", linewidth=1)
        axis.set(xlabel=f"{one.term.cause.name}: {value.name} ({value.unit})", ylabel="deviance")
    _save(figure, path)


def draw_left(examined: Examination, path: Path) -> None:
    """How far from health each flexible term is, per robot, after everything found."""
    rows = []
    for key, far in examined.identified.away.items():
        rows += [
            (key.partition("/")[2].replace("_", " "), robot, float(z))
            for robot, z in zip(examined.tracks.robots, far, strict=True)
        ]
    table = pd.DataFrame(rows, columns=["quantity", "robot", "z"])
    grid = table.pivot_table(index="quantity", columns="robot", values="z", aggfunc="max")
    figure = _figure(10, 5.0)
    axis = figure.subplots()
    sns.heatmap(grid, vmin=0.0, vmax=10.0, cmap="rocket_r", ax=axis, linewidths=0.5)
    axis.set(ylabel="", xlabel="robot")
    axis.set_title("standard deviations from health of what follows each quantity", fontsize=10)
    _save(figure, path)


def _profile(examined: Examination, one: Named, tried: FloatArray) -> FloatArray:
    """(n,) deviance of the cause's robots with its first parameter at each value."""
    tracks, found = examined.tracks, examined.identified
    chosen = [k for k, robot in enumerate(tracks.robots) if robot in one.robots]
    some = tracks.only(chosen)
    losses = []
    for value in tried:
        motions = [
            _as_named(found.base[k], examined.diagnosis.named, tracks.robots[k], one, float(value))
            for k in chosen
        ]
        problem = Problem(some, motions)
        residual = problem.residual((), np.zeros((len(chosen), 0)))
        losses.append(float(problem.losses(residual).sum()))
    return np.array(losses)


def _as_named(
    motion: Motion, named: tuple[Named, ...], robot: int, varied: Named, value: float
) -> Motion:
    """A robot's healthy motion with everything named for it, one value replaced."""
    for one in named:
        if robot in one.robots:
            values = np.array([v.value for v in one.values])
            if one is varied:
                values[0] = value
            motion = one.term.cause.change(motion, values, one.term.variant)
    return motion


def _figure(width: float, height: float) -> Figure:
    sns.set_theme(style="whitegrid", font_scale=0.85)
    return Figure(figsize=(width, height), layout="constrained")


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})
