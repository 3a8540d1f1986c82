"""The whole gap of one log against one model: motion at every horizon, sensors, and odd robots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import motions, own_models, replay_believed
from realitygap.models.gap.conditions import Bins, conditions
from realitygap.models.gap.flips import Means
from realitygap.models.gap.motion_gap import MotionGap, condition_bins, motion_gap
from realitygap.models.gap.odd import Odd, odd_robots
from realitygap.models.gap.replay import CHANNELS, HORIZONS, errors, windows
from realitygap.models.gap.sensing import scenarios
from realitygap.models.gap.sensor_gap import SensorGap, sensor_gap, sensors_to_judge
from realitygap.models.gap.shares import Share
from realitygap.models.gap.spread import Excess
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, pose_noise, window_noise
from realitygap.models.log.schema import LS, PS

QUANTILES = {"median": 0.5, "p95": 0.95}
COLUMNS = {"position": "m", "heading": "rad"}


def horizon_errors(log: MeasuredLog, replayed: FloatArray, noise: PoseNoise) -> pd.DataFrame:
    """One row per horizon, run and robot: windows, and quantiles of position and heading error.

    All windows are taken, one from every row. Columns: horizon, seconds (median length), windows,
    for `position` (m) and `heading` (rad) the median and the 95 % quantile of the absolute error
    and the median that tracker noise alone would give (`_noise`), run, robot. Medians, because one
    to four per cent of a tracker's samples are gross failures. Horizons longer than the log are
    absent.

    Args:
        log: The measured log.
        replayed: (rows, 3) its commands through the model.
        noise: The tracker's.
    """
    measured = log.poses
    rng = np.random.default_rng(np.random.SeedSequence(0))
    parts = []
    for name, length in HORIZONS.items():
        pairs = windows(log, length)
        if not len(pairs.first):
            continue
        error = errors(measured, replayed, pairs)
        noisy = window_noise(measured, pairs, noise) * rng.normal(size=error.shape)
        table = pd.DataFrame(
            {
                "segment": log.segment[pairs.first],
                "seconds": log.t[pairs.last] - log.t[pairs.first],
                "position": np.hypot(error[:, 0], error[:, 1]),
                "heading": np.abs(error[:, 2]),
                "position_noise": np.hypot(noisy[:, 0], noisy[:, 1]),
                "heading_noise": np.abs(noisy[:, 2]),
            }
        )
        by = table.groupby("segment")
        quantiles = {
            f"{channel}_{label}": by[channel].quantile(q)
            for channel in COLUMNS
            for label, q in QUANTILES.items()
        }
        noises = {f"{channel}_noise": by[f"{channel}_noise"].median() for channel in COLUMNS}
        part = pd.DataFrame({"seconds": by["seconds"].median(), "windows": by.size()})
        parts.append(part.assign(horizon=name, **quantiles, **noises).join(log.segments))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


LEVEL = 0.04
"""Chance that any mean depends on anything in a log that the model explains up to noise."""
EXCESS_LEVEL = 0.01
"""The same for errors that only spread too much: far stricter, for it leans on the noise estimated
from the log itself. Our choice."""
TOTAL_LEVEL = LEVEL + EXCESS_LEVEL
"""Chance of flagging anything at all in such a log."""
ROBOT_HORIZON = "1 s"
"""Windows that robots are compared by: long against noise, short against contacts."""
DEAL_SECONDS = 10.0
"""s dealt to robots at once: longer than a turn, an avoidance or a contact lasts."""


@dataclass(frozen=True, eq=False)
class Gap:
    """What a model gets wrong about a log."""

    noise: PoseNoise
    horizons: pd.DataFrame
    """As `horizon_errors`."""
    motion: list[MotionGap]
    sensors: list[SensorGap]
    robots: list[Odd]
    silent: tuple[str, ...]
    """What could not be judged, and why."""

    def maps(self) -> list[tuple[str, str, Means]]:
        """Every map with its kind (motion, ps, ls) and horizon (empty for sensors)."""
        motion = [("motion", g.horizon, m) for g in self.motion for m in g.maps]
        return motion + [(g.kind, "", m) for g in self.sensors for m in g.maps]

    def shares(self) -> list[tuple[str, str, str, Share]]:
        """Every channel's shares with its kind, horizon and name."""
        motion = [
            ("motion", g.horizon, channel, share)
            for g in self.motion
            for channel, share in g.shares.items()
        ]
        return motion + [
            (g.kind, "", c, share) for g in self.sensors for c, share in g.shares.items()
        ]

    @property
    def flagged(self) -> bool:
        """Whether anything beyond noise was found: means at `LEVEL`, spread at `EXCESS_LEVEL`."""
        return any(m.p <= LEVEL for _, _, m in self.maps()) or bool(self.larger())

    def larger(self) -> list[tuple[str, str, Excess]]:
        """Horizon, channel and excess of every error that spreads more than noise allows."""
        return [
            (gap.horizon, channel, found)
            for gap in self.motion
            for channel, found in gap.excess.items()
            if found.p <= EXCESS_LEVEL
        ]


def measure_gap(
    log: MeasuredLog, file: ModelFile, model: PointModel, *, seed: int = 0, name: str = "model"
) -> Gap:
    """Replay a log through a model, each robot through its own, and judge what is left.

    Args:
        log: The measured log.
        file: The model file.
        model: The point model that all robots have; without sensor tables only motion is judged.
        seed: Of the random turns and deals of the tests.
        name: What to call the file in an error.

    Raises:
        InputError: no step of the log can be replayed, or the file's extension concerns a robot
            that the log does not have.
    """
    believed = motions(log, file, name)
    replayed = replay_believed(log, believed)
    noise = pose_noise(log, replayed)
    horizons = horizon_errors(log, replayed, noise)
    if horizons.empty:
        raise InputError("log", "no two tracked rows in succession", "at least one replayable step")
    table = conditions(log, file)
    for_motion, for_sensors, for_robots = np.random.SeedSequence(seed).spawn(3)
    kinds = sensors_to_judge(log, model)
    family = len(HORIZONS) + len(kinds)
    motion = motion_gap(log, replayed, noise, table, for_motion, family=family)
    true = Motion(drive=file.nominal_drive)
    sensors = sensor_gap(
        log,
        model,
        replayed,
        noise,
        table,
        for_sensors,
        family=family,
        own=own_models(log, file, model.tables),
        seen={robot: (true, motion) for robot, motion in believed.items()},
    )
    return Gap(
        noise=noise,
        horizons=horizons,
        motion=motion,
        sensors=sensors,
        robots=_odd(log, motion, np.random.default_rng(for_robots)),
        silent=tuple(_silent(log, model)),
    )


def _odd(log: MeasuredLog, motion: list[MotionGap], rng: np.random.Generator) -> list[Odd]:
    """Robots against the swarm, by the windows of `ROBOT_HORIZON`."""
    for gap in motion:
        if gap.horizon == ROBOT_HORIZON:
            break
    else:
        return []
    cuts = condition_bins(log, gap.table)
    if "robot" not in cuts:
        return []
    kept: dict[str, Bins] = {
        name: cuts[name]._replace(group=cuts[name].group[gap.clear])
        for name in ("robot", "all", "speed", "turn")
        if name in cuts
    }
    first = gap.pairs.first[gap.clear]
    since = log.t[first] - log.t[log.start[:-1]][log.segment[first]]
    part = np.floor(since / DEAL_SECONDS).astype(np.int64)
    stretch = log.segment[first] * (part.max(initial=0) + 1) + part
    return odd_robots(gap.error[gap.clear], kept.pop("robot"), stretch, kept, CHANNELS, rng)


def _silent(log: MeasuredLog, model: PointModel) -> list[str]:
    """What the log or the model does not allow to be judged."""
    found = []
    have = {"infrared": PS, "light": LS}
    for kind, names in have.items():
        missing = [name for name in names if name not in log.frame]
        if len(missing) == len(names):
            found.append(f"{kind}: the log has no columns {names[0]} to {names[-1]}")
        elif missing:
            found.append(f"{kind}: the log has no {', '.join(missing)}")
    if model.tables is None and len(found) < len(have):
        found.append("sensors: the model has no sensor tables")
    elif any(name in log.frame for name in LS) and (scenarios(log) < 0).any():
        found.append("light: rows whose case does not say where the lamp stands")
    span = float((log.t[log.start[1:] - 1] - log.t[log.start[:-1]]).max())
    if span < max(HORIZONS.values()):
        found.append(f"horizons beyond {span:.3g} s: no run is longer")
    return found
