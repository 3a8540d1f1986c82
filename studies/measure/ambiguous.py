"""Ambiguous pairs: does the proposed manoeuvre settle what a log left open?

`realitygap measure ambiguous`: a trial hides one of
two rivals, records a log that cannot tell them apart, diagnoses it, lets the same robots perform
what was proposed, and diagnoses both logs together. The diagnosis gets the logs and nothing else.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.probes import PREFIX
from realitygap.models.log.schema import ENCODERS, LS, PS
from realitygap.studies.diagnosis.diagnose import diagnose
from realitygap.studies.plumbing.execution import Workers, processes
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import RunConfig, simulate

Hide = Callable[[np.random.Generator], str]


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two causes, and a log that cannot tell them apart."""

    why: str
    """What the log lacks."""
    hide: Mapping[str, Hide]
    """By name of the cause: how it is hidden."""
    controller: str = "search"
    case: str = "light-at-nest"
    minutes: float = 2.0
    robots: int = 3
    lacks: tuple[str, ...] = ()
    """Columns that the first log is without."""


def _even(name: str, key: str, low: float, high: float, robot: int | None = 1) -> Hide:
    """A value between two bounds, in one robot or in all."""
    who = "" if robot is None else f",robot={robot}"

    def spec(random: np.random.Generator) -> str:
        return f"{name}:{key}={random.uniform(low, high):.6g}{who}"

    return spec


PAIRS: Mapping[str, Pair] = {
    "torque or friction": Pair(
        why="no encoders",
        hide={
            "weak_motor": _even("weak_motor", "torque", 0.0015, 0.003),
            "low_friction": _even("low_friction", "friction", 0.08, 0.2),
        },
        minutes=1.0,
        lacks=ENCODERS,
    ),
    "latency or clock": Pair(
        why="neither encoders nor sensors",
        hide={
            "command_latency": _even("command_latency", "seconds", 0.03, 0.08),
            "clock_offset": _even("clock_offset", "seconds", 0.03, 0.08),
        },
        minutes=1.0,
        lacks=(*ENCODERS, *PS, *LS),
    ),
    "droop or radius": Pair(
        why="twelve seconds: a loss of speed does not show as one that grows",
        hide={
            "speed_droop": _even("speed_droop", "rate", 7e-4, 11e-4),
            "wheel_radius_scale": _even("wheel_radius_scale", "scale", 0.984, 0.989),
        },
        minutes=0.2,
    ),
    "wall or sensors": Pair(
        why="three robots for twenty seconds: none meets another",
        hide={
            "ir_gain": _even("ir_gain", "scale", 1.2, 1.4, None),
            "wall_albedo": _even("wall_albedo", "scale", 1.2, 1.4, None),
        },
        minutes=1.0 / 3.0,
    ),
}
"""By name."""


def trial(name: str, truth: str, seed: int) -> dict[str, Any]:
    """One trial: what was hidden, what the first log said, and what both together say."""
    pair = PAIRS[name]
    first, second, values = np.random.SeedSequence([seed, *name.encode()]).spawn(3)
    spec = pair.hide[truth](np.random.default_rng(values))
    with scratch() as room:
        alone = room / "first.parquet"
        _record(pair, pair.controller, pair.case, pair.minutes, spec, first, alone)
        if pair.lacks:
            pd.read_parquet(alone).drop(columns=list(pair.lacks)).to_parquet(alone, index=False)
        before = _answer(alone)
        result = {
            "pair": name,
            "truth": truth,
            "seed": seed,
            "hidden": spec,
            "first": _said(before),
            "ambiguous": before["verdict"] == "ambiguous",
            "proposed": "",
            "both": "",
            "right": False,
        }
        following = before["next_experiment"]
        if following is None or not set(pair.hide) <= set(following["separates"]):
            result["ambiguous"] = False
            return result
        case = "no-light" if following["lamp"] == "off" else pair.case
        also = room / "second.parquet"
        _record(pair, PREFIX + following["name"], case, 2.0, spec, second, also)
        after = _answer(alone, also)
        right = (
            after["verdict"] == "named"
            and [cause["name"] for cause in after["causes"]] == [truth]
            and after["causes"][0]["robots"] == _concerned(spec)
        )
        return {
            **result,
            "proposed": following["name"],
            "separation": round(following["separation"], 1),
            "both": _said(after),
            "right": right,
        }


def _record(
    pair: Pair,
    controller: str,
    case: str,
    minutes: float,
    spec: str,
    seed: np.random.SeedSequence,
    log: Path,
) -> None:
    """Simulate, and keep the log alone."""
    config = RunConfig.model_validate(
        {
            "controller": controller,
            "case": case,
            "minutes": minutes,
            "robots": pair.robots,
            "seed": int(seed.generate_state(1)[0]),
        }
    )
    run = log.with_suffix("")
    run.mkdir()
    simulate(config, (spec,), run)
    shutil.move(run / "samples.parquet", log)
    shutil.rmtree(run)


def _answer(*logs: Path) -> Mapping[str, Any]:
    """What `diagnosis.json` would hold."""
    return diagnose(logs).content


def _concerned(spec: str) -> list[int] | str:
    """Robots that have an effect, as `diagnosis.json` has them."""
    robots = [int(part.removeprefix("robot=")) for part in spec.split(",") if "robot=" in part]
    return robots or "all"


def _said(answer: Mapping[str, Any]) -> str:
    """Verdict and names in a line."""
    names = [
        " or ".join((cause["name"], *cause["alternatives"])) + f" of {cause['robots']}"
        for cause in answer["causes"]
    ]
    return f"{answer['verdict']}: {'; '.join(names)}"


def _numbered(task: tuple[str, str, int]) -> dict[str, Any]:
    return trial(*task)


def ambiguous(
    out: Path,
    *,
    trials: int = 6,
    seed: int = 1,
    only: Sequence[str] = (),
    jobs: int | None = None,
    force: bool = False,
    say: Callable[[str], None] = lambda line: None,
) -> pd.DataFrame:
    """Run trials of every pair, the two rivals by turns.

    Args:
        out: The file (CSV), a row per trial.
        trials: Of each pair.
        seed: Of the first; the others follow it.
        only: Pairs, of `PAIRS`; all if absent.
        jobs: Processes; all cores if absent.
        force: Replace a table that is there.
        say: Told of every trial in a line of JSON.

    Raises:
        InputError: there is no such pair, or `out` cannot be written.
    """
    for name in only:
        if name not in PAIRS:
            raise InputError("--only", repr(name), nearest(name, PAIRS))
    tasks = [
        (name, list(PAIRS[name].hide)[k % 2], seed + k)
        for k in range(trials)
        for name in only or PAIRS
    ]
    rows: list[dict[str, Any]] = []
    with whole_file(out, force=force) as part:
        with processes(Workers.chosen(jobs, None).jobs) as pool:
            for row in pool.map(_numbered, tasks):
                rows.append(row)
                say(json.dumps(row))
        table = pd.DataFrame(rows)
        table.to_csv(part, index=False)
    return table
