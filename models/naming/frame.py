"""The tracker's frame against the model's arena: one turn and shift that wall, lamp and nest share.

A lab puts its origin and its axes where its cameras want them. Where a log was recorded otherwise
than the reference's, the placement is fitted to what all robots' sensors read, before anything is
asked of one robot. It is believed where at least one of four witnesses (infrared, which sees the
wall; light; the nest; poses, which the wall holds in) says so and none speaks against it: a lamp
that was moved alone leaves nest and wall where they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from realitygap.embedded_sim import SENSORS, PointModel, Tables, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.gap.sensing import measured, scenarios
from realitygap.models.log.blocks import nth
from realitygap.models.log.frames import Rows, wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.log.schema import POSE
from realitygap.models.naming.channels.senses.neighbours import Bools, around
from realitygap.models.naming.rules import Rules

MOST_ROWS = 3000
"""Rows used, evenly in time. No rule: it bounds the work; three numbers need no more."""
TURNS = 24
"""Turns tried first: 15 degrees apart, within which the lamp's bearing is smooth. No rule: of the
search."""
STARTS = 3
"""Best of them that are refined. No rule: of the search."""
TABLE_SHARE = 0.1
"""Of a reading, by which a robot that another one shades or a rough table may be off. No rule: it
weighs sensors, and errors beyond it count as their logarithm."""
EDGE = 0.003
"""m by which an answer about the nest may be off before it counts fully: half of what a robot
drives between two rows. No rule: as above."""
LEAST = 0.002
"""m by which a frame must move something in the arena: nobody places a lamp by less.
No rule: below it healthy robots differ by more."""
BLOCK = 5.0
"""s that are resampled together. No rule: blocks are of five seconds everywhere."""
BEFOREHAND = np.array([2.0, 10.0, 10.0])
"""rad, m, m about 0 that a frame may be before anything was seen: what nothing shows stays 0.
No rule: as good as anything."""
ALONE: dict[tuple[str, ...], tuple[str, ...]] = {
    ("light",): ("lamp_moved",),
    ("nest",): ("nest_moved",),
}
"""What cannot be told from a frame that only one witness shows."""
SPEAKS = 0.25
"""Of its loss, that some witness must lose: a sensor's gain or a table's error takes off less.
No rule: a frame turned by ten degrees takes off more than half."""
NORMAL = 1.96
"""Standard deviations on each side of a 95 % interval. No rule: of statistics."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Where the model's arena lies in a log's frame."""

    turn: float
    """rad, counter-clockwise, of the arena's axes."""
    x: float
    y: float
    """m, of the arena's middle."""
    sd: tuple[float, float, float]
    """rad, m, m."""
    witnesses: tuple[str, ...]
    """That say so; none of the others speaks against it."""


def in_arena(poses: FloatArray, place: FloatArray) -> FloatArray:
    """(rows, 3) poses in the frame of an arena that lies at `place`: turn (rad), x, y (m)."""
    turn, middle_x, middle_y = place
    c, s = np.cos(turn), np.sin(turn)
    x, y = poses[:, 0] - middle_x, poses[:, 1] - middle_y
    return np.column_stack([c * x + s * y, c * y - s * x, poses[:, 2] - turn])


@dataclass(frozen=True, eq=False, kw_only=True)
class Witnessed:
    """What sensors and poses say of the frame."""

    model: PointModel
    reach: float
    """m from the middle that the wall lets a robot's middle be."""
    poses: FloatArray
    """(rows, 3) as measured."""
    block: Rows
    """(rows,) of time, counted through."""
    inside: FloatArray
    """(rows,) 1 in the nest, 0 not; NaN where unknown."""
    some: Rows
    """(sensed,) rows whose readings are used."""
    scenario: npt.NDArray[np.int32]
    """(sensed,)"""
    time: FloatArray
    """(sensed,) s since the run began."""
    read: FloatArray
    """(sensed, 16) counts; NaN where nothing is said of wall or lamp."""

    @cached_property
    def told(self) -> dict[str, Bools]:
        """By witness, (rows or sensed, columns) what it says anything of."""
        whole = np.isfinite(self.read)
        parts = {
            "infrared": whole[:, :SENSORS],
            "light": whole[:, SENSORS:],
            "nest": np.isfinite(self.inside)[:, None],
            "poses": np.full((len(self.poses), 1), np.isfinite(self.reach)),
        }
        return {name: part for name, part in parts.items() if part.any()}

    def errors(self, place: FloatArray) -> dict[str, FloatArray]:
        """By witness, (rows or sensed, columns) errors; 0 where it says nothing.

        Args:
            place: turn (rad), x, y (m) of the arena in the log's frame.
        """
        poses = np.ascontiguousarray(in_arena(self.poses, place))
        nest_x, nest_y, radius = self.model.nest
        depth = radius - np.hypot(poses[:, 0] - nest_x, poses[:, 1] - nest_y)
        wrong = np.where(self.inside > 0.5, np.minimum(depth, 0.0), np.maximum(depth, 0.0))
        beyond = np.maximum(np.hypot(poses[:, 0], poses[:, 1]) - self.reach, 0.0)
        found = {"nest": wrong[:, None] / EDGE, "poses": beyond[:, None] / EDGE}
        if {"infrared", "light"} & set(self.told):
            off = self._readings(poses[self.some])
            found |= {"infrared": off[:, :SENSORS], "light": off[:, SENSORS:]}
        return {name: np.where(said, found[name], 0.0) for name, said in self.told.items()}

    def _readings(self, poses: FloatArray) -> FloatArray:
        """(sensed, 16) errors of readings."""
        tables = self.model.tables
        assert tables is not None
        both = readings(poses, np.maximum(self.scenario, 0), self.time, model=self.model)
        floor = np.repeat([tables.ps_noise_floor, tables.ls_noise], SENSORS)
        dark = np.repeat([0.0, tables.ls_dark], SENSORS)
        width = floor + TABLE_SHARE * np.abs(self.read - dark)
        return np.asarray((self.read - np.hstack([both.ps, both.ls])) / width)

    def loss(self, place: FloatArray) -> dict[str, FloatArray]:
        """By witness, (blocks,) twice the negative logarithm of a Cauchy likelihood."""
        found = {}
        for name, error in self.errors(place).items():
            block = self.block[self.some] if name in ("infrared", "light") else self.block
            loss = np.log1p(error**2).sum(axis=1)
            found[name] = np.bincount(block, loss).astype(np.float64)
        return found

    def whole(self, place: FloatArray) -> float:
        """The loss of all, and of what is believed beforehand."""
        beforehand = np.log1p((place / BEFOREHAND) ** 2).sum()
        return float(beforehand + sum(one.sum() for one in self.loss(place).values()))

    def flat(self, place: FloatArray) -> FloatArray:
        """(errors,) of all, and of what is believed beforehand."""
        told = [one.ravel() for one in self.errors(place).values()]
        return np.concatenate([*told, place / BEFOREHAND])


def seen_in(log: MeasuredLog, model: PointModel, *, arena: bool = True) -> Witnessed:
    """What a log says of the frame.

    Args:
        log: Measured.
        model: What the simulator believes.
        arena: Whether it believes in a wall.
    """
    rows = np.flatnonzero(log.tracked)
    some = np.arange(0, len(rows), max(1, -(-len(rows) // MOST_ROWS)))
    sensed = rows[some]
    read, scenario = measured(log, sensed), scenarios(log)[sensed]
    if model.tables is None or not arena:
        read = np.full_like(read, np.nan)
    else:
        read[:, :SENSORS][around(log, sensed).in_ray(log.poses[sensed], model)] = np.nan
        unlit = np.array([lamp is None for lamp in model.lamps])
        read[(scenario < 0) | unlit[scenario], SENSORS:] = np.nan
    inside = np.full(len(rows), np.nan)
    if "nest" in log.frame and arena:
        inside = log.frame["nest"].astype("Float64").to_numpy(float, na_value=np.nan)[rows]
    time = (log.t - log.t[log.start[:-1]][log.segment])[rows]
    key = log.segment[rows] * 10**6 + nth(time, BLOCK)
    return Witnessed(
        model=model,
        reach=model.arena_radius - model.body_radius if arena else np.inf,
        poses=log.poses[rows],
        block=np.unique(key, return_inverse=True)[1],
        inside=inside,
        some=some,
        scenario=scenario,
        time=time[some],
        read=read,
    )


def frame_of(seen: Witnessed, rules: Rules = Rules()) -> Frame | None:
    """Where the model's arena lies in a log's frame; None: where the model has it, or unknown."""
    if not seen.told:
        return None
    starts = sorted(_starts(seen), key=seen.whole)[:STARTS]
    fits = [least_squares(seen.flat, start, loss="cauchy") for start in starts]
    best = min(fits, key=lambda fit: float(fit.cost))
    before, after = seen.loss(np.zeros(3)), seen.loss(best.x)
    score = {name: _score(before[name] - after[name]) for name in before}
    less = {name: after[name].sum() < (1.0 - SPEAKS) * before[name].sum() for name in before}
    speaking = tuple(name for name, z in score.items() if z > rules.errors)
    if not any(less[name] for name in speaking) or min(score.values()) < -rules.errors:
        return None
    turn = float(wrapped(best.x[:1])[0])
    x, y = best.x[1:].tolist()
    if np.hypot(x, y) + np.abs(turn) * seen.model.arena_radius < LEAST:
        return None
    slopes = np.asarray(best.jac)
    sd = tuple(np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes))).tolist())
    return Frame(turn=turn, x=x, y=y, sd=sd, witnesses=speaking)


def _starts(seen: Witnessed) -> Iterator[FloatArray]:
    """Turns about where the log has its middle, and about the middle of all poses."""
    low, high = np.quantile(seen.poses[:, :2], (0.01, 0.99), axis=0)
    middles = np.zeros(2), (low + high) / 2.0
    for middle, k in product(middles, range(TURNS)):
        yield np.array([2.0 * np.pi * k / TURNS, *middle])


def _score(gains: FloatArray) -> float:
    """Standard errors of a sum over blocks from 0; blocks of no gain, of all, say nothing."""
    spread = float(np.sqrt((gains**2).sum()))
    return float(gains.sum()) / spread if spread else 0.0


def in_the_models_frame(
    log: MeasuredLog,
    file: ModelFile,
    tables: Tables | None,
    *,
    alike: bool,
    rules: Rules = Rules(),
) -> tuple[MeasuredLog, tuple[PreflightEntry, ...]]:
    """A log in the frame of the model's arena, and what the pre-flight says of its own frame.

    Args:
        log: Measured.
        file: What the simulator believes.
        tables: Captured, of the model; None: its sensors are not modelled.
        alike: Whether the log was recorded as those of the healthy reference were.
        rules: What naming is tuned to.
    """
    if alike:
        return log, tuple(_entries(None, "as the reference's logs"))
    arena = file.arena is not None
    frame = frame_of(seen_in(log, file.point_model(tables), arena=arena), rules)
    if frame is None:
        return log, tuple(_entries(None, "no wall, light or nest shows another than the model's"))
    note = (
        f"the arena lies turned by {np.degrees(frame.turn):.3g} degrees about ({frame.x:.4g}, "
        f"{frame.y:.4g}) m in the log's frame, as {' and '.join(frame.witnesses)} "
        "show: poses are read in the arena's"
    )
    poses = in_arena(log.poses, np.array([frame.turn, frame.x, frame.y]))
    there = log.frame.assign(**dict(zip(POSE, poses.T, strict=True)))
    return replace(log, frame=there, notes=(*log.notes, note)), tuple(_entries(frame, ""))


def _entries(frame: Frame | None, why: str) -> Iterator[PreflightEntry]:
    """What the pre-flight says; without a frame, why there is none."""
    told = {
        "frame_turn": ("rad", "of the arena's axes in the log's frame"),
        "frame_x": ("m", "of the arena's middle in the log's frame"),
        "frame_y": ("m", "of the arena's middle in the log's frame"),
    }
    for k, (name, (unit, meaning)) in enumerate(told.items()):
        if frame is None:
            yield PreflightEntry(name=name, meaning=meaning, value=None, unit=unit, why=why)
            continue
        value, sd = (frame.turn, frame.x, frame.y)[k], frame.sd[k]
        alone = ALONE.get(frame.witnesses, ())
        yield PreflightEntry(
            name=name,
            meaning=meaning,
            value=value,
            unit=unit,
            low=value - NORMAL * sd,
            high=value + NORMAL * sd,
            follows="silences" if alone else "repaired",
            why="poses are read in the arena's frame"
            + ("; what was moved by as much looks the same" if alone else ""),
            causes=alone,
        )
