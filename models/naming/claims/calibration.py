"""What has no name may still be predicted: values that fit best, which are no diagnosis.

Where something stays unexplained, or nobody knows what a healthy robot of this kind does, the
numbers of the point model are fitted to the robot's own paths, 1, 5 and 20 s ahead, all at once
and beside the causes that were named. They are kept by the rule for causes (`claims.harm`): each
half of the log is predicted with the values of the other, better somewhere and worse nowhere.
What such a value means is not said: a radius of 0.9 may be a worn tyre, a slipping one or a motor.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.extended import as_written
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import replay_segments
from realitygap.models.gap.replay import errors
from realitygap.models.log.blocks import BLOCK_SECONDS, better
from realitygap.models.log.frames import Windows
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.wheels.chosen import widest
from realitygap.models.naming.claims.ahead import KEYS, SECONDS, Ahead
from realitygap.models.naming.claims.harm import helps, worse
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Calibrated, Diagnosis
from realitygap.models.naming.engine.hypothesis import Terms
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.laws.found import law_table
from realitygap.models.naming.rules import Rules

GEOMETRY = ("wheel_radius_scale", "wheel_radius_mismatch", "wheel_separation")
"""Terms behind the encoders. No rule: they are what a point on two wheels has."""
MOTORS = ("command_latency", "motor_lag", "motor_saturation")
"""Terms before them. No rule: what changes with time holds for no other day, and a threshold has no
slope to follow."""
MOST_WINDOWS = 1500
"""Windows of each horizon that a fit looks at, evenly over the log. No rule: it bounds work."""
EVALUATIONS = 25
"""Most steps of one fit. No rule: it bounds work."""
WIDE = 500.0
"""Steps of a parameter that are one standard deviation of what is believed of a robot beforehand:
half a second, half of a length. No rule: it keeps values from running away where paths are mute."""
DOUBT = 0.5
"""Of the squared errors that there are, most that what was never driven may be unsure by.
No rule: half of what is to be mended."""
SCALED = 20.0
"""Steps of a parameter that are one unit of the fit. No rule: of numerics."""
LEAST = (1e-4, 1e-4, 1e-3)
"""m, m, rad: errors are never taken to be smaller. No rule: below any tracker."""


def terms_of(names: Iterable[str]) -> Terms:
    """Terms of causes, of both wheels where there is a word for that."""
    return tuple(widest(causes()[name]) for name in names)


class Paths:
    """One robot's paths in one part of the log, or in both (None), and terms to predict them."""

    def __init__(
        self, ahead: Ahead, robot: int, base: Motion, part: int | None, terms: Terms | None = None
    ) -> None:
        """Choose the windows; `terms` are all where not given."""
        self.log, self.base = ahead.log, base
        self.terms = terms_of((*MOTORS, *GEOMETRY)) if terms is None else terms
        self.segments = np.flatnonzero(ahead.segment_robot == robot).tolist()
        self.pairs = []
        for horizon in SECONDS:
            pairs = ahead.windows(horizon, robot)
            if part is not None:
                mine = ahead.part[pairs.first] == part
                pairs = Windows(pairs.first[mine], pairs.last[mine])
            every = max(1, len(pairs.first) // MOST_WINDOWS)
            if len(pairs.first):
                self.pairs.append(Windows(pairs.first[::every], pairs.last[::every]))
        self._measured = ahead.log.poses
        self._parameters = [p for term in self.terms for p in term.cause.parameters]
        fastest = float(np.abs(ahead.log.commands).max(initial=1.0))
        finite = [np.isfinite(p.null) for p in self._parameters]
        self._null = np.where(finite, 0.0, fastest)
        self._steps = np.array([p.step for p in self._parameters])
        low, self._high = np.array([p.bounds for p in self._parameters]).T
        self._low = np.where(self._idle(), 0.0, low)
        self.scales = [np.maximum(_spread(e), LEAST) for e in self._errors(self.base)]

    def _errors(self, motion: Motion) -> list[FloatArray]:
        path = self._path(self.log, motion)
        return [errors(self._measured, path, pairs) for pairs in self.pairs]

    def _path(self, log: MeasuredLog, motion: Motion) -> FloatArray:
        """(rows, 3) poses of a log's commands; NaN in the rows of others."""
        path = np.full((len(log.t), 3), np.nan)
        rows, seen = replay_segments(log, self.segments, motion)
        path[rows] = seen
        return path

    def motion(self, flat: FloatArray) -> Motion:
        """The motion with all terms at coordinates."""
        motion, begin = self.base, 0
        for term in self.terms:
            end = begin + len(term.cause.parameters)
            motion = term.cause.applied(motion, flat[begin:end], term.variant)
            begin = end
        return motion

    def _off(self, flat: FloatArray) -> FloatArray:
        """(n + p,) errors in their spread, every horizon with the same weight, and the prior's."""
        found = zip(self._errors(self.motion(flat)), self.scales, strict=True)
        off = [(e / s / np.sqrt(len(e))).ravel() for e, s in found]
        return np.concatenate([*off, (flat - self._null) / (WIDE * self._steps)])

    def _jacobian(self, flat: FloatArray) -> FloatArray:
        here = self._off(flat)
        steps = [self._stepped(flat, k) for k in range(len(flat))]
        return np.column_stack([(self._off(there) - here) / step for there, step in steps])

    def _stepped(self, flat: FloatArray, k: int) -> tuple[FloatArray, float]:
        """The coordinates with one a step away, within bounds, and the step."""
        own = self._parameters[k].step
        step = -own if flat[k] + own > self._high[k] else own
        there = flat.copy()
        there[k] += step
        return there, step

    def _idle(self) -> list[bool]:
        """(p,) whether nothing changes any more below the null, as with an early command."""
        found = []
        for k, p in enumerate(self._parameters):
            less = self._null.copy()
            less[k] -= p.step
            here, there = self.motion(self._null), self.motion(less)
            found.append(p.sign > 0 or (bool(np.isfinite(p.null)) and here == there))
        return found

    def _far(self) -> FloatArray:
        """(p,) the last start of every cause that has some, the null of the others."""
        found, begin = self._null.copy(), 0
        for term in self.terms:
            end = begin + len(term.cause.parameters)
            own = term.cause.starts(self.log.commands)
            found[begin:end] = own[-1] if own else found[begin:end]
            begin = end
        return found

    def doubt(self, flat: FloatArray) -> float:
        """How unsure is what is predicted of the mirror image of the log's commands.

        A log that turns to one side cannot tell wheels from the axle, and would be wrong of the
        other side. Told as a variance over that of the present errors.
        """
        p, log = len(flat), self.log
        data = self._jacobian(flat)[:-p]
        seconds = sum(float(np.ptp(log.t[log.start[k] : log.start[k + 1]])) for k in self.segments)
        information = max(seconds / BLOCK_SECONDS, 1.0) * data.T @ data
        covariance = np.linalg.inv(information + np.diag((WIDE * self._steps) ** -2.0))
        image = replace(log, commands=np.ascontiguousarray(log.commands[:, ::-1]))
        path, columns = self._path(image, self.motion(flat)), []
        for k in range(p):
            there, step = self._stepped(flat, k)
            moved = self._path(image, self.motion(there))
            off = [errors(path, moved, pairs) for pairs in self.pairs]
            each = [
                (e / s / np.sqrt(len(e))).ravel() for e, s in zip(off, self.scales, strict=True)
            ]
            columns.append(np.concatenate(each) / step)
        slopes = np.column_stack(columns)
        return float(np.trace(covariance @ (slopes.T @ slopes))) / (3.0 * len(self.pairs))

    def run(self) -> FloatArray | None:
        """The coordinates that predict best; None: there is no window to fit."""
        if not self.pairs:
            return None
        best, cost = None, np.inf
        for side in (0, 1):
            begin = self._null.copy() if side == 0 else self._far()
            found = least_squares(
                self._off,
                np.clip(begin, self._low + 1e-9, self._high - 1e-9),
                jac=self._jacobian,
                bounds=(self._low, self._high),
                loss="soft_l1",
                x_scale=SCALED * self._steps,
                max_nfev=EVALUATIONS,
            )
            if found.cost < cost:
                best, cost = found.x, found.cost
        return best


def _spread(error: FloatArray) -> FloatArray:
    """(3,) robust standard deviation about nought."""
    return np.asarray(NORMAL * np.median(np.abs(error), axis=0))


@one_thread
def with_calibration(examined: Examination, log: MeasuredLog, table: pd.DataFrame) -> Examination:
    """The examination with values that predict better what its diagnosis leaves open.

    Args:
        examined: With what it claims of causes and laws.
        log: Of which.
        table: The log's conditions.
    """
    said = examined.diagnosis
    robots = _open(said)
    if not robots:
        return examined
    named = [written(one, one.values) for one in said.named if one.exported]
    laws = [law_table(one) for one in said.laws if one.exported]
    file = as_written(examined.model, named, laws) if named or laws else examined.model
    ahead = Ahead(log, table)
    found = [_calibrated(ahead, file, robot, said.rules) for robot in robots]
    kept = tuple(one for one in found if one is not None)
    return replace(examined, diagnosis=replace(said, calibration=kept))


def _open(said: Diagnosis) -> list[int]:
    """Robots of which not all is told by names."""
    if not said.reference or any(one.robots == "all" for one in said.unexplained):
        return list(said.robots)
    left = {robot for one in said.unexplained if one.robots != "all" for robot in one.robots}
    return sorted(left | {robot for one in said.named if not one.exported for robot in one.robots})


def _calibrated(ahead: Ahead, file: ModelFile, robot: int, rules: Rules) -> Calibrated | None:
    """One robot's values; None: they would not help, or would do harm."""
    base = file.motion(robot)
    try:
        fits = [Paths(ahead, robot, base, part) for part in (0, 1)]
        halves = [fit.run() for fit in fits]
        if any(half is None for half in halves):
            return None
        first, second = (
            fit.motion(h) for fit, h in zip(fits, halves, strict=True) if h is not None
        )
        before = ahead.sizes(robot, ahead.replay(robot, lambda r, part: base))
        after = ahead.sizes(robot, ahead.replay(robot, lambda r, part: (second, first)[part]))
    except Diverged:
        return None
    won, told = {}, {}
    for name in KEYS:
        one = better(before[name], after[name], ahead.block(name, [robot]))
        if one is not None:
            won[name] = one
            told[name] = (float(before[name].mean()), float(after[name].mean()))
    if not helps(won, rules) or worse(won, rules):
        return None
    whole = Paths(ahead, robot, base, None)
    at = whole.run()
    if at is None or whole.doubt(at) > DOUBT:
        return None
    return Calibrated(robot=robot, terms=_terms(whole, at), errors=told)


def _terms(fit: Paths, flat: FloatArray) -> tuple[NamedCause, ...]:
    """What was fitted as terms of a model file, without those that change nothing."""
    found, begin = [], 0
    fastest = float(np.abs(fit.log.commands).max(initial=0.0))
    for term in fit.terms:
        at = flat[begin : (begin := begin + len(term.cause.parameters))]
        idle = all(
            abs(u) < 1e-9 if np.isfinite(p.null) else u >= fastest
            for p, u in zip(term.cause.parameters, at, strict=True)
        )
        if not idle:
            told = zip(term.cause.parameters, term.cause.values(at).tolist(), strict=True)
            values = {p.name: ParameterValue(value=v, unit=p.unit) for p, v in told}
            found.append(
                NamedCause(name=term.cause.name, robots="all", word=term.variant, parameters=values)
            )
    return tuple(found)
