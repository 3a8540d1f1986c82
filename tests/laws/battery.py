"""Hide sealed laws in fresh runs, diagnose the logs, and count what was said of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import realitygap as rg
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import ANONYMOUS, RunConfig, simulate
from tests.laws.sealed import EFFECTS, LAWS, LISTED, RATE, SHARE, Sealed

LARGEST = 4.0
"""Bars; sizes are drawn from 1 on, evenly in their logarithm."""
SWARM = 0.3
"""Of the trials, those in which all robots have the law."""


@dataclass(frozen=True)
class LawTrial:
    """What is hidden in one run."""

    law: Sealed | None
    bars: float
    robot: int | None
    """None: all of them."""
    run: RunConfig
    specs: tuple[str, ...]

    @property
    def withheld(self) -> tuple[str, ...]:
        """Causes that the diagnosis is to do without."""
        return () if self.law is None or self.law.strength else (self.law.name,)

    @property
    def amplitude(self) -> float:
        """Of the term, in its channel's unit."""
        assert self.law is not None
        return self.bars * (RATE if self.law.acts == "turn" else SHARE)


def _specs(
    law: Sealed | None, bars: float, robot: int | None, random: np.random.Generator
) -> tuple[str, ...]:
    if law is None:
        return ()
    values: Mapping[str, float | str] = {"bars": round(bars, 3)}
    if law.strength is None:
        entry = MENU[law.name]
        values = entry.values(min(bars * entry.bar, entry.largest), random)
    whose = {} if robot is None else {"robot": robot}
    told = ",".join(f"{key}={value}" for key, value in {**values, **whose}.items())
    return (f"{law.name}:{told}",)


def plan(
    seed: int, *, healthy: int, robots: int, seconds: float, engine: EngineName = DEFAULT
) -> list[LawTrial]:
    """Every sealed law and every listed cause once, and some runs with nothing, in any order."""
    random = np.random.default_rng(seed)
    trials = []
    every = [*LAWS, *LISTED, *[None] * healthy]
    for number in random.permutation(len(every)):
        law = every[int(number)]
        bars = float(LARGEST ** random.random())
        swarm = random.random() < SWARM
        run = RunConfig(
            controller="search",
            case="no-light",
            robots=robots,
            minutes=seconds / 60.0,
            seed=int(random.integers(2**31)),
            engine=engine,
        )
        robot = None if swarm else int(random.integers(robots))
        trials.append(LawTrial(law, bars, robot, run, _specs(law, bars, robot, random)))
    return trials


def answered(trial: LawTrial) -> dict[str, Any]:
    """Record one run and say what its diagnosis says."""
    with scratch() as room:
        run = Path(room) / "run"
        run.mkdir()
        simulate(trial.run, trial.specs, run, unlisted=EFFECTS, name=ANONYMOUS)
        return dict(rg.diagnose(run / "samples.parquet", without=trial.withheld).content)


def _kind(law: Sealed | None) -> str:
    if law is None:
        return "healthy"
    if law.strength is None:
        return "listed"
    return "inside" if law.inside else "outside"


def scored(trial: LawTrial, content: dict[str, Any]) -> dict[str, Any]:
    """What was said of a sealed law."""
    laws, law = content.get("laws", []), trial.law
    said: dict[str, Any] = {
        "law": None if law is None else law.name,
        "kind": _kind(law),
        "bars": round(trial.bars, 2),
        "robot": "all" if trial.robot is None else trial.robot,
        "verdict": content["verdict"],
        "said": [
            f"{one['equation']}{'' if one['shape'] else ' (shape not found)'}" for one in laws
        ],
        "laws": len(laws),
    }
    if law is None or not laws:
        return said
    first = laws[0]
    form = first["atoms"][0]["form"] if first["atoms"] else ""
    said["quantity"] = first["channel"] in law.channels and first["of"] in law.quantities
    said["shaped"] = first["shape"]
    said["form"] = bool(said["quantity"] and first["shape"] and form in law.forms)
    said["wrong"] = bool(first["shape"] and not said["quantity"])
    if said["form"] and first["channel"] == law.acts:  # told in the same unit
        said["holds"] = [
            min(abs(one["low"]), abs(one["high"]))
            <= trial.amplitude
            <= max(abs(one["low"]), abs(one["high"]))
            for one in first["coefficients"]
        ]
    at = {name: (e["before"], e["after"]) for name, e in first["errors"].items()}
    said["errors_mm"] = {
        name: [round(1e3 * v, 1) for v in both] for name, both in at.items() if "position" in name
    }
    said["exported"] = first["exported"]
    return said


def rates(answers: Sequence[dict[str, Any]]) -> Iterator[str]:
    """In words."""
    hidden = [one for one in answers if one["kind"] in ("inside", "outside")]
    inside = [one for one in hidden if one["kind"] == "inside"]
    outside = [one for one in hidden if one["kind"] == "outside"]
    listed = [one for one in answers if one["kind"] == "listed"]
    holds = [held for one in hidden for held in one.get("holds", [])]
    healthy = [one for one in answers if one["law"] is None]

    def share(some: Sequence[dict[str, Any]], key: str) -> str:
        return f"{sum(bool(one.get(key)) for one in some)} of {len(some)}"

    yield f"channel and quantity right: {share(hidden, 'quantity')}"
    yield f"form right, inside the grammar: {share(inside, 'form')}"
    shapeless = sum(one.get("shaped") is False and one["quantity"] for one in outside)
    yield f"outside: shape not found, quantity right: {shapeless} of {len(outside)}"
    yield f"a law of a wrong channel or quantity: {share(hidden, 'wrong')}"
    yield f"withheld causes: channel and quantity right: {share(listed, 'quantity')}"
    yield f"withheld causes: form right: {share(listed, 'form')}"
    yield f"withheld causes: a law of a wrong channel or quantity: {share(listed, 'wrong')}"
    yield f"nothing said: {sum(not one['laws'] for one in hidden)} of {len(hidden)}"
    yield f"amplitudes' 95 % intervals that hold: {sum(holds)} of {len(holds)}"
    yield f"laws in healthy runs: {share(healthy, 'laws')}"
