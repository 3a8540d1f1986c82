"""Three laws in pictures: what was hidden, what was written, what it brings on a later run.

python -m tests.laws.stories [OUT.png]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from typer import echo

import realitygap as rg
from realitygap.embedded_sim.laws import Atom
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.law_values import value
from realitygap.studies.pages.drawing import HALF, canvas, save, themed
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import ANONYMOUS, RunConfig, simulate
from tests.laws.sealed import EFFECTS, LAWS, RATE, SHARE

TURN = np.linspace(0.0, 2.0 * np.pi, 200)
ALONG = np.linspace(-0.5, 0.5, 201)
STORIES: dict[str, tuple[str, float, FloatArray, Callable[[FloatArray], FloatArray]]] = {
    "eccentric": ("angle of the left wheel (rad)", 2.5, TURN, lambda q: q),
    "carpet": ("(x + y) / 1.41 (m)", 3.0, ALONG, lambda q: np.outer(q, [0.5**0.5, 0.5**0.5])),
    "compass": ("heading (rad)", 2.7, TURN, lambda q: q),
}
"""By law: its quantity, bars, where it is drawn, and the quantity there."""
SECONDS = {"1 s": 1.0, "5 s": 5.0, "20 s": 20.0}


def recorded(name: str, bars: float, seed: int, out: Path) -> Path:
    """Two minutes of five robots; robot 2 has the law."""
    out.mkdir()
    run = RunConfig(controller="search", case="no-light", robots=5, minutes=2.0, seed=seed)
    simulate(run, (f"{name}:bars={bars},robot=2",), out, unlisted=EFFECTS, name=ANONYMOUS)
    return out / "samples.parquet"


def hidden(name: str, bars: float, q: FloatArray) -> FloatArray:
    """(n,) of what was hidden, in its channel's unit, where its quantity is q."""
    law = next(one for one in LAWS if one.name == name)
    angles, poses = np.zeros((len(q), 2)), np.zeros((len(q), 3))
    if name == "eccentric":
        angles[:, 0] = q
    elif name == "compass":
        poses[:, 2] = q
    else:
        poses[:, :2] = q
    assert law.strength is not None
    share = RATE if law.acts == "turn" else SHARE
    return np.asarray(bars * share * law.strength(np.full_like(angles, 6.0), angles, poses, 0.0))


def drawn(axes: Axes, name: str, law: dict[str, Any]) -> None:
    """What was hidden and what was found, with the interval of its amplitude."""
    label, bars, along, of = STORIES[name]
    q = of(along)
    (one,) = law["atoms"]
    atom = Atom(one["of"], one["form"], tuple(one["parameters"]))
    shape = value(atom, {atom.of: q})
    (amount,) = law["coefficients"]
    if name == "eccentric":  # a phase of its own in every run
        shape = np.cos(atom.parameters[0] * q)
    axes.plot(along, hidden(name, bars, q), "k--", label="hidden")
    axes.plot(along, amount["value"] * shape, label="found")
    axes.fill_between(along, amount["low"] * shape, amount["high"] * shape, alpha=0.3)
    axes.set(xlabel=label, ylabel=f"{law['channel']} ({amount['unit']})", title=law["equation"])
    axes.title.set_fontsize(8)


def brought(axes: Axes, later: Path, extended: Any) -> None:
    """Position errors of the robot on a fresh run, before and after."""
    table = rg.gain(later, extended, jobs=1).table
    ahead = table[(table["channel"] == "position") & (table["robot"] == 2)]
    for model in ("before", "extended"):
        mine = ahead[ahead["model"] == model].groupby("horizon")[["total", "number"]].sum()
        errors = (1e3 * mine["total"] / mine["number"]).loc[list(SECONDS)]
        axes.plot(list(SECONDS.values()), errors, "o-", label=model)
        echo(f"{model}: {errors.round(1).to_dict()} mm")
    axes.set(xscale="log", yscale="log", xlabel="ahead, later run (s)", ylabel="position (mm)")


def told(out: Path) -> None:
    """Record, diagnose and draw all of them."""
    with scratch() as room, themed():
        figure = canvas(2.0 * HALF, 6.0)
        rows = figure.subplots(2, len(STORIES))
        for k, (name, (_, bars, _, _)) in enumerate(STORIES.items()):
            log = recorded(name, bars, 61 + k, Path(room) / name)
            found = rg.diagnose(log)
            law = found.content["laws"][0]
            echo(
                f"{name}: {law['equation']}; {law['reading']}; {law['coefficients']}; {law['why']}"
            )
            drawn(rows[0, k], name, law)
            if law["exported"]:
                later = recorded(name, bars, 1061 + k, Path(room) / f"{name}-later")
                brought(rows[1, k], later, found.extended)
            else:
                rows[1, k].text(0.5, 0.5, law["why"].replace(": ", ":\n"), ha="center", fontsize=8)
                rows[1, k].set_axis_off()
        rows[0, 0].legend(fontsize=8)
        rows[1, 1].legend(fontsize=8)
        save(figure, out)


if __name__ == "__main__":  # workers import this module, too
    told(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/laws.png"))
