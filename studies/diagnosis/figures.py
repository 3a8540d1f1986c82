"""The pictures of a diagnosis: error before and after, rivals, profiles, what is left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.ticker import LogLocator, StrMethodFormatter

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import SenseCause
from realitygap.models.naming.channels.motion.examination import KINDS, Examination
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.findings import Named
from realitygap.studies.pages.drawing import HALF, canvas, save

PROFILE_POINTS = 21
MOST_RIVALS = 8
"""Bars of a chart; our choice."""
OWN, OTHER = "#1f77b4", "#b9c4cf"
"""Colours of the named cause's bar and of its rivals'."""


def draw_errors(table: pd.DataFrame, concerned: set[int], path: Path) -> None:
    """Error by how far ahead, of the robots concerned; of all where nothing concerns any."""
    figure = canvas(HALF, 3.4)
    axes = figure.subplots()
    table = table.assign(error=1e3 * table["error"])
    mine = table[table["robot"].isin(concerned)] if concerned else table
    options = {"hue": "kind", "hue_order": [k for k in KINDS if (table["kind"] == k).any()]}
    drawn = {"style": "kind", "markers": True, "errorbar": None, "ax": axes}
    sns.lineplot(mine, x="seconds", y="error", **drawn, **options)
    axes.set(xscale="log", yscale="log", xlabel="ahead (s)", ylabel="mean position error (mm)")
    axes.set_xticks(ticks := sorted(table["seconds"].unique()), [f"{t:g}" for t in ticks])
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.minorticks_off()
    axes.legend(title=None, fontsize=8)
    save(figure, path)


def rival_bars(one: Named) -> dict[str, float]:
    """By term, the deviance that it takes off in the named one's place: that one first.

    Terms that act exactly alike on what the log holds take off as much.
    """
    own = one.term.key
    tried = dict(one.evidence.gains)
    alike = {twin.key: one.evidence.gain for twin in one.twins}
    others = {name: gain for name, gain in {**tried, **alike}.items() if name != own}
    ranked = sorted(others.items(), key=lambda pair: -pair[1])[: MOST_RIVALS - 1]
    return {own: tried.get(own, one.evidence.gain), **dict(ranked)}


def draw_rivals(one: Named, path: Path) -> None:
    """What a named cause takes off the errors, and what others take off in its place."""
    bars = rival_bars(one)
    figure = canvas(HALF, 1.0 + 0.3 * len(bars))
    axes = figure.subplots()
    names = [name.replace("_", " ") for name in bars]
    colours = [OWN] + [OTHER] * (len(bars) - 1)
    axes.barh(names, [max(gain, 0.0) for gain in bars.values()], color=colours)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.set(xlabel="deviance taken off the errors (no unit)")
    save(figure, path)


def draw_curves(curves: Sequence[tuple[str, str, FloatArray, FloatArray]], path: Path) -> None:
    """What follows a quantity without a law: channel, quantity, its values, amplitudes."""
    figure = canvas(10, 3.0)
    for axis, (channel, of, at, size) in zip(
        np.atleast_1d(figure.subplots(1, len(curves))), curves, strict=True
    ):
        axis.plot(at, size, color="#4878a8")
        axis.axhline(0.0, color="#222222", linewidth=1)
        axis.set(xlabel=of.replace("_", " "), ylabel=f"change of {channel}")
    save(figure, path)


def draw_profiles(examined: Examination, path: Path) -> None:
    """Deviance against the first parameter of each cause in motion, all else as found."""
    shown = profiled(examined)
    figure = canvas(10, 3.0)
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
    save(figure, path)


def profiled(examined: Examination) -> list[Named]:
    """Those that have a profile: smooth causes that move a robot."""
    moving = [o for o in examined.diagnosis.named if not isinstance(o.term.cause, SenseCause)]
    return [one for one in moving if one.term.cause.smooth][:3]


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
    figure = canvas(10, 5.0)
    axis = figure.subplots()
    sns.heatmap(grid, vmin=0.0, vmax=10.0, cmap="rocket_r", ax=axis, linewidths=0.5)
    axis.set(ylabel="", xlabel="robot")
    axis.set_title("standard deviations from health of what follows each quantity", fontsize=10)
    save(figure, path)


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
