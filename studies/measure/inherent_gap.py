"""What pybullet does that the point model does not, with nothing hidden: `docs/inherent-gap.md`.

Healthy runs of the nominal world on many seeds, each judged as any measured log is; every figure is
a mean over seeds with its standard error: `realitygap measure inherent-gap`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile, load_model, read_model_file
from realitygap.models.gap.conditions import clear, conditions
from realitygap.models.gap.motion_gap import UNITS, motion_gap
from realitygap.models.gap.replay import replay_log
from realitygap.models.gap.sensor_gap import sensor_gap
from realitygap.models.log.frames import Windows, motion
from realitygap.models.log.measured import MeasuredLog, read_log
from realitygap.models.log.noise import pose_noise
from realitygap.models.log.tracker import NORMAL
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import simulate
from realitygap.studies.run.settings import run_config

CONTROLLERS = ("search", "coevolution", "positive-phototaxis")
"""Taken in turn over the seeds, so that no one behaviour makes the figures."""
STEPS = 5
"""Control steps after a change of command that are looked at."""
STEADY = 0.5
"""rad/s of change within a window that still counts as none."""
CHANGED = 2.0
"""rad/s; smaller changes of a wheel's command say little."""


def measure(seed: int, minutes: float, file: ModelFile) -> dict[str, Any]:
    """One seed's figures, as flat names and numbers."""
    model = load_model()
    config = run_config(
        controller=CONTROLLERS[seed % len(CONTROLLERS)], minutes=minutes, robots=10, seed=seed
    )
    with scratch() as where:
        simulate(config, (), where)
        log = read_log(where, drive=model.drive)
    replayed = replay_log(log, model.drive)
    noise = pose_noise(log, replayed)
    table = conditions(log, file)
    found: dict[str, Any] = {"seed": seed, "noise_mm": 1000 * noise.position}
    found["noise_deg"] = float(np.degrees(noise.heading))
    streams = np.random.SeedSequence(seed).spawn(2)
    for gap in motion_gap(log, replayed, noise, table, streams[0]):
        touching = ~gap.clear if gap.seconds <= 1.0 else ~_free(gap.pairs, table)
        for k, channel in enumerate(UNITS):
            for name, rows in (("clear", ~touching), ("contact", touching)):
                if rows.sum() >= 20:
                    key = f"{gap.horizon} {channel} {name}"
                    found[key] = NORMAL * float(np.median(np.abs(gap.error[rows, k])))
                    found[f"{key} mean"] = float(np.mean(_clipped(gap.error[rows, k])))
        found[f"{gap.horizon} share in contact"] = float(touching.mean())
        if gap.horizon == "0.4 s":
            found |= _anisotropy(gap.error[gap.clear], gap.table[gap.clear])
            found |= _scales(log, replayed, gap.pairs, gap.clear & _steady(gap.table))
    found |= _answers(log, table, model.drive)
    for sensor in sensor_gap(log, model, replayed, noise, table, streams[1], family=7):
        lit = sensor.predicted > 20 if sensor.kind == "ps" else sensor.predicted < 3900
        for name, rows in (("alone", sensor.clear), ("near robots", ~sensor.clear)):
            use = rows[:, None] & np.isfinite(sensor.residual)
            if (use & lit).any():
                found[f"{sensor.kind} {name}"] = float(np.mean(_clipped(sensor.residual[use])))
                shown = sensor.residual[use & lit]
                found[f"{sensor.kind} {name} lit"] = float(np.mean(_clipped(shown)))
                found[f"{sensor.kind} {name} lit share"] = float(
                    np.mean(_clipped(shown))
                    / np.mean(_signal(sensor.kind, sensor.predicted[use & lit]))
                )
    return found


def _signal(kind: str, predicted: FloatArray) -> FloatArray:
    """What a sensor reads beyond nothing: counts, or counts below dark."""
    return predicted if kind == "ps" else 4095.0 - predicted


def _free(pairs: Windows, table: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """(windows,) whether no row of a window is in contact."""
    bad = np.concatenate([[0], np.cumsum(~clear(table))])
    free: npt.NDArray[np.bool_] = bad[pairs.last + 1] == bad[pairs.first]
    return free


def _steady(table: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """(windows,) whether the command hardly changes within a window."""
    steady: npt.NDArray[np.bool_] = table["change"].to_numpy(dtype=float) < STEADY
    return steady


def _clipped(values: FloatArray) -> FloatArray:
    """Values clipped at four robust deviations about their median."""
    middle = np.median(values)
    reach = 4 * NORMAL * np.median(np.abs(values - middle))
    return np.clip(values, middle - reach, middle + reach)


def _anisotropy(error: FloatArray, table: pd.DataFrame) -> dict[str, float]:
    """Amplitude of the errors' dependence on the compass: first and second harmonic of heading."""
    yaw = table["heading"].to_numpy()
    basis = np.column_stack([f(n * yaw) for n in (1, 2, 4) for f in (np.cos, np.sin)])
    found = {}
    for k, channel in enumerate(UNITS):
        weights = np.linalg.lstsq(basis, _clipped(error[:, k]), rcond=None)[0]
        for at, n in enumerate((1, 2, 4)):
            found[f"anisotropy {channel} cos{n}"] = float(weights[2 * at])
            found[f"anisotropy {channel} sin{n}"] = float(weights[2 * at + 1])
    return found


def _scales(
    log: MeasuredLog, replayed: FloatArray, pairs: Windows, use: npt.NDArray[np.bool_]
) -> dict[str, float]:
    """Measured over commanded distance and turn, free of contact and of changes of command."""
    kept = Windows(pairs.first[use], pairs.last[use])
    went, told = motion(log.poses, kept), motion(replayed, kept)
    found = {"steady windows": float(use.sum())}
    for k, name in ((0, "distance"), (2, "turn")):
        ratio = _clipped(went[:, k] - told[:, k]) @ told[:, k] / (told[:, k] @ told[:, k])
        found[f"steady {name} scale"] = 1.0 + float(ratio)
    return found


def _answers(log: MeasuredLog, table: pd.DataFrame, drive: Drive) -> dict[str, float]:
    """How much of a commanded change of speed and turn is there, step by step after it.

    Of changes that then hold for `STEPS` steps, free of contact: the slope of the measured step's
    motion, less the old command's, on the commanded change. 1 is the point model.
    """
    radius, axle = np.array(drive.wheel_radius), drive.axle
    command = log.commands
    rows = np.arange(1, len(command) - STEPS - 1)
    held = np.all(
        [(command[rows + j] == command[rows]).all(axis=1) for j in range(1, STEPS)], axis=0
    )
    change = command[rows] - command[rows - 1]
    ok = held & (np.abs(change).max(axis=1) > CHANGED)
    ok &= (log.stretch[rows - 1] == log.stretch[rows + STEPS]) & log.tracked[rows]
    ok &= _free(Windows(rows - 1, rows + STEPS), table)
    rows, change = rows[ok], change[ok]
    found = {"changes of command": float(len(rows))}
    for j in range(STEPS):
        step = motion(log.poses, Windows(rows + j, rows + j + 1)) / log.step
        old, new = command[rows - 1] * radius, command[rows] * radius
        for name, measured, a, b in (
            ("speed", step[:, 0], old.mean(axis=1), new.mean(axis=1)),
            ("turn", step[:, 2], np.diff(old)[:, 0] / axle, np.diff(new)[:, 0] / axle),
        ):
            asked = b - a
            found[f"{name} after {j + 1}"] = float((measured - a) @ asked / (asked @ asked))
    return found


def inherent_gap(
    out: Path,
    *,
    seeds: int = 24,
    minutes: float = 2.0,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> None:
    """Measure every seed and write the figures.

    Args:
        out: Directory of seeds.csv, inherent-gap.json (mean and standard error by name) and
            inherent-gap.png.
        seeds: How many runs.
        minutes: Simulated, of each.
        force: Replace what is there.
        reach: Called with the share that is done, from 0 to 1.

    Raises:
        InputError: `minutes` cannot be used, or `out` cannot be written.
    """
    with whole_directory(out, force=force, holds=("seeds.csv",)) as part:
        file, rows = read_model_file(), []
        for seed in range(seeds):
            rows.append(measure(seed, minutes, file))
            reach((seed + 1) / seeds)
        table = pd.DataFrame(rows).set_index("seed")
        table.to_csv(part / "seeds.csv")
        errors: pd.Series[float] = table.sem()
        means = table.mean()
        found = {str(n): [float(means[n]), float(errors[n])] for n in means.index}
        text = json.dumps(found, indent=1) + "\n"
        (part / "inherent-gap.json").write_text(text, encoding="utf-8")
        draw(table, part / "inherent-gap.png")


def draw(table: pd.DataFrame, path: Path) -> None:
    """Errors against horizon in and out of contact, and the answer to a change of command."""
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    with sns.axes_style("whitegrid"):
        axes = figure.subplots(1, 3)
    horizons = [h for h in ("step", "0.4 s", "1 s", "5 s", "20 s") if f"{h} along clear" in table]
    seconds = {"step": 0.04, "0.4 s": 0.4, "1 s": 1.0, "5 s": 5.0, "20 s": 20.0}
    for axis, channel, unit in zip(axes[:2], ("along", "heading"), ("m", "rad"), strict=True):
        for name, colour in (("clear", "C0"), ("contact", "C3")):
            there = [h for h in horizons if f"{h} {channel} {name}" in table]
            values = table[[f"{h} {channel} {name}" for h in there]]
            axis.errorbar(
                [seconds[h] for h in there],
                values.mean(),
                2 * values.sem(),
                fmt="o-",
                color=colour,
                label=name,
            )
        axis.set(
            xscale="log", yscale="log", xlabel="horizon (s)", ylabel=f"{channel} error ({unit})"
        )
        axis.legend()
    after = np.arange(1, STEPS + 1)
    for name, colour in (("speed", "C0"), ("turn", "C1")):
        values = table[[f"{name} after {j}" for j in after]]
        axes[2].errorbar(
            40 * after, values.mean(), 2 * values.sem(), fmt="o-", color=colour, label=name
        )
    axes[2].axhline(1.0, color="k", lw=0.6)
    axes[2].set(xlabel="step that ends so long after a change (ms)", ylabel="share of the change")
    axes[2].legend()
    figure.savefig(path, dpi=110, metadata={"Software": None})
