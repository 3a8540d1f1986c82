"""What every term would change in the pose windows of a log, per unit of its coordinate.

Rows are errors of the predicted poses in standard deviations of noise (`identify.residual`), three
to a pose. A *column* holds what a term would add to them: by replay for the causes of the
catalogue, by carrying a changed step through the predicted path for flexible terms that follow a
measured quantity. A cause without a small dose, such as a limit, has columns at whole doses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.candidates import candidates, own_starts
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.flexible import (
    BODY,
    OWN_SPEED,
    WHEELS,
    Steps,
    axles,
    quantities,
    standardised,
    wheel_speeds,
)
from realitygap.models.naming.channels.motion.predict import poses
from realitygap.models.naming.channels.motion.recording import recording
from realitygap.models.naming.channels.motion.timing import changes_late
from realitygap.models.naming.channels.motion.tracks import Rows, Tracks
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item

WINDOW_EFFECTS = ("speed", "bend", "turn_rate", "aside")
"""Channels in which every window may differ by itself, beside its clock and its lag."""
CLOCK = 7
"""Which window effect is the window's clock, its lag behind it. No rule: an order."""
FREE = 3
"""Window effects that are free: place (two) and heading of the window. No rule: what they are."""
CLOCKS = ("clock_offset", "command_latency")
LAGS = ("motor_lag",)


@dataclass(frozen=True, eq=False)
class Columns:
    """Errors and columns of one set of tracks at given motions."""

    errors: FloatArray
    """(n, 3)."""
    items: tuple[Item, ...]
    names: tuple[str, ...]
    """(k,) of columns; equal names mean the same in every log."""
    values: FloatArray
    """(n, 3, k)."""
    windows: FloatArray
    """(n, 3, q) columns of every window's own effects; `FREE` first."""

    @property
    def linear(self) -> Rows:
        """Indices of the columns that are per unit of a coordinate."""
        return np.flatnonzero(["@" not in name for name in self.names])

    def of(self, rows: slice) -> Columns:
        """Of some rows."""
        errors, values, windows = self.errors[rows], self.values[rows], self.windows[rows]
        return replace(self, errors=errors, values=values, windows=windows)


def columns(
    tracks: Tracks, motions: Sequence[Motion], commands: FloatArray, *, doses: bool = True
) -> Columns:
    """The columns of every term at the given motions.

    Args:
        tracks: Of some robots.
        motions: One per robot.
        commands: (rows, 2) rad/s of the whole log, from which whole doses are chosen.
        doses: Whether whole doses are wanted beside what is linear.
    """
    problem = Problem(tracks, motions)
    predicted = poses(tracks, motions)
    errors = problem.fitter(predicted)
    seen = _Seen(tracks, predicted[:, 2])
    found: list[FloatArray] = []
    names: list[str] = []
    items: list[Item] = []
    for item, own, called in _of_causes(problem, errors, commands, doses):
        at = len(found)
        found += own
        names += called
        items.append(item._replace(columns=tuple(range(at, at + len(own)))))
    steps = Steps(tracks, predicted)
    term = Term(recording(tracks.step, tracks.rules, filtered=tracks.filtered), ALL)
    for k, parameter in enumerate(term.cause.parameters):
        found.append(-_slope(problem, term, k))
        names.append(f"{term.cause.name}@{parameter.name}")
    for name, change in changes_late(steps, tracks, motions):
        found.append(seen(change))
        names.append(name)
    always = {}
    for channel, change in _always(steps, tracks, motions):
        always[channel] = len(found)
        found.append(seen(change))
        names.append(f"{channel}@always")
    for (quantity, channel), pairs in _flexible(problem, steps, motions).items():
        at = len(found)
        found += [seen(change) for _, change in pairs]
        names += [f"{channel}/{quantity}{part}" for part, _ in pairs]
        items.append(
            Item(None, None, quantity, channel, tuple(range(at, at + len(pairs))), always[channel])
        )
    by_name = dict(zip(names, found, strict=True))
    path = problem.fitter.centred(predicted[:, :2])
    windows = _windows(tracks, seen, steps, path, by_name)
    return Columns(errors, tuple(items), tuple(names), np.stack(found, axis=2), windows)


class _Seen:
    """Changes of poses as rows see them: ahead, to the left, heading, in noise."""

    def __init__(self, tracks: Tracks, heading: FloatArray) -> None:
        self._cos, self._sin = np.cos(heading), np.sin(heading)
        self._sp, self._sy = tracks.noise.position, tracks.noise.heading

    def __call__(self, change: FloatArray) -> FloatArray:
        x, y, yaw = change.T
        return np.column_stack(
            [
                (self._cos * x + self._sin * y) / self._sp,
                (self._cos * y - self._sin * x) / self._sp,
                yaw / self._sy,
            ]
        )


def _of_causes(
    problem: Problem, errors: FloatArray, commands: FloatArray, whole_doses: bool
) -> Iterator[tuple[Item, list[FloatArray], list[str]]]:
    """Every term of the catalogue per unit, where it has one, and at whole doses."""
    for term in candidates():
        cause = term.cause
        linear = cause.smooth and all(np.isfinite(p.null) for p in cause.parameters)
        if linear:
            try:
                own = [-_slope(problem, term, k) for k in range(len(cause.parameters))]
            except Diverged:
                continue
            called = [f"{term.key}.{p.name}" for p in cause.parameters]
            yield Item(term, None, "", "", ()), own, called
        doses = cause.starts(commands) if linear else own_starts(term, commands)
        for dose in doses if whole_doses else ():
            if not np.any(dose):
                continue
            try:
                whole = errors - problem.residual((term,), np.tile(dose, (problem.count, 1)))
            except Diverged:
                continue
            label = ",".join(f"{v:.6g}" for v in dose)
            yield Item(term, tuple(dose.tolist()), "", "", ()), [whole], [f"{term.key}@{label}"]


def _slope(problem: Problem, term: Term, k: int) -> FloatArray:
    """(n, 3) change of the errors per unit of one coordinate."""
    p = term.cause.parameters[k]
    low, high = p.bounds
    up, down = min(p.step, high), max(-p.step, low)
    sides = []
    for value in (up, down):
        dose = np.zeros((problem.count, len(term.cause.parameters)))
        dose[:, k] = value
        sides.append(problem.residual((term,), dose))
    return (sides[0] - sides[1]) / (up - down)


def _flexible(
    problem: Problem, steps: Steps, motions: Sequence[Motion]
) -> dict[tuple[str, str], list[tuple[str, FloatArray]]]:
    """By quantity and channel, its parts with (n, 3) changes of the predicted poses."""
    tracks = problem.tracks
    axle = axles(tracks, motions)
    found: dict[tuple[str, str], list[tuple[str, FloatArray]]] = {}
    for (quantity, part), values in quantities(tracks, motions).items():
        own = values[tracks.rows]
        q = standardised(problem, own)
        q = np.zeros(len(own)) if q is None else q
        for channel in BODY:
            found.setdefault((quantity, channel), []).append((part, steps.change(channel, q)))
        change = steps.of_wheels(np.column_stack([q, q]), axle)
        found.setdefault((quantity, WHEELS), []).append((part, change))
    change = steps.of_wheels(wheel_speeds(problem), axle)
    found[OWN_SPEED, WHEELS] = [("", change)]
    return found


def _always(
    steps: Steps, tracks: Tracks, motions: Sequence[Motion]
) -> Iterator[tuple[str, FloatArray]]:
    """Every channel with (n, 3) changes of the predicted poses where it changes steadily."""
    one = np.ones(len(tracks.rows))
    for channel in BODY:
        yield channel, steps.change(channel, one)
    both = np.ones((len(one), 2))
    yield WHEELS, steps.of_wheels(both, axles(tracks, motions))


def _windows(
    tracks: Tracks,
    seen: _Seen,
    steps: Steps,
    path: FloatArray,
    by_name: dict[str, FloatArray],
) -> FloatArray:
    """(n, 3, q) columns of what each window may have by itself."""
    one, none = np.ones(len(path)), np.zeros(len(path))
    free = [
        np.column_stack([one, none, none]),
        np.column_stack([none, one, none]),
        np.column_stack([-path[:, 1], path[:, 0], one]),
    ]
    own = [seen(change) for change in (*free, *(steps.change(c, one) for c in WINDOW_EFFECTS))]
    for names in (CLOCKS, LAGS):
        timed = next((v for key, v in by_name.items() if key.partition(".")[0] in names), None)
        if timed is not None:
            own.append(timed)
    return np.stack(own, axis=2)
