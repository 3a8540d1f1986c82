"""The wheels by their encoders: what lies between a command and a wheel, fitted on its own errors.

The chain from a command to a pose is cut where the encoders are. Before the cut stand motors and
their controller (`before_the_encoders`); behind it wheels, floor and tracker, whose poses are then
predicted from what the encoders counted (`driven_by_encoders`).

Delay, lag, limits and dead zone of real motors are large, and each hides the others. So all are
fitted together first, by replay in C; one after the other is then taken away as long as nothing is
clearly lost over blocks of time. Nothing is linear here, and nobody measured healthy motors: every
number is told beside the minimal model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy.optimize import least_squares

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.withheld import withheld
from realitygap.models.gap.driven import AROUND, with_changes
from realitygap.models.log.blocks import nth
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.motion.fitted import Key, Values
from realitygap.models.naming.channels.motion.predict import wheel_angles
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.engine.hypothesis import Term, Terms
from realitygap.models.naming.engine.threshold import bracket
from realitygap.models.naming.engine.value import Value, told, values
from realitygap.models.naming.findings import Evidence, Named

BLOCK_SECONDS = 5.0
"""No rule: blocks are of five seconds everywhere."""
TICK = 2.0 * np.pi / 1000.0
"""rad; encoders are never taken to be finer than an e-puck's 1000 steps a turn.
No rule: of its data sheet."""
EVALUATIONS = 30
"""Most steps of one fit. No rule: it bounds work."""
STRONG = 0.2
"""Of the most seconds that the catalogue believes, where a fit begins as well: a delay of many
commands looks like none from nearby. No rule: of numerics."""
BOTH = "both"
"""Word for the left and the right wheel."""
SCALED = 20.0
"""Steps of a parameter that are one unit of the fit. No rule: of numerics."""
SURE = 99.0
"""Standard deviations beyond which a distance says no more. No rule: what is told."""

Bools = npt.NDArray[np.bool_]
Coordinates = tuple[FloatArray, ...]
"""(p,) of each term."""


def before_the_encoders(cause: Cause) -> bool:
    """Whether a cause of motion acts between a command and the wheel: encoders show it."""
    plain = Motion()
    some = np.array([p.step if np.isfinite(p.null) else 1.0 for p in cause.parameters])
    given = np.ones(len(cause.given))
    changed = cause.change(plain, np.r_[cause.values(some), given], cause.variants[-1])
    actuated = replace(changed, drive=changed.wheels, encoder_drive=None)
    return _actuators(actuated) != _actuators(plain)


def _actuators(motion: Motion) -> tuple[Drive, float, tuple[float, float]]:
    """What acts before the encoders."""
    nominal = Drive()
    drive = with_changes(
        motion.drive, wheel_radius=nominal.wheel_radius, axle=nominal.axle, laws=()
    )
    return drive, motion.motor_delay, motion.wheel_gain


def driven_by_encoders(
    tracks: Tracks, believed: Sequence[Motion]
) -> tuple[Tracks, tuple[Motion, ...]]:
    """The tracks as if the encoders were the commands, and motions whose motors obey at once."""
    assert tracks.encoders is not None
    counted = pd.DataFrame(tracks.encoders).ffill().fillna(0.0).to_numpy()
    ahead = np.vstack([counted[1:], counted[-1:]])  # they give the mean speed since the row before
    ahead[tracks.start[1:] - 1] = counted[tracks.start[1:] - 1]
    free = []
    for motion in believed:
        d = motion.drive
        obeying = with_changes(
            Drive(),
            wheel_radius=d.wheel_radius,
            axle=d.axle,
            laws=d.laws,
            reach=d.reach,
            body=d.body,
        )
        free.append(replace(motion, drive=obeying, encoder_drive=None, motor_delay=0.0))
    told = replace(tracks, commands=np.ascontiguousarray(ahead), encoders=None, rolling=None)
    return told, tuple(free)


def wheel_errors(
    tracks: Tracks, motions: Sequence[Motion]
) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """Encoders less what they should read (rad/s), and which rows these are.

    Returns:
        (n, 2) errors of the mean speed since the row before, and (n,) rows.
    """
    assert tracks.encoders is not None
    angle = wheel_angles(tracks, motions)
    took = np.diff(tracks.t, prepend=tracks.t[0] - 1.0)
    inside = took < AROUND  # rows were left out where more time has passed
    inside[tracks.start[:-1]] = False
    speed = np.diff(angle, axis=0, prepend=angle[:1]) / np.where(inside, took, 1.0)[:, None]
    off = tracks.encoders - speed
    rows = np.flatnonzero(inside & np.isfinite(off).all(axis=1))
    return off[rows], rows


def coarse(step: float) -> float:
    """rad/s: what a tick leaves of a speed over a step (s)."""
    return float(TICK / step / np.sqrt(6.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fit:
    """Terms fitted to one robot's wheels."""

    terms: Terms
    at: Coordinates
    loss: FloatArray
    """(n,) deviance of each row."""


class _Wheels:
    """One robot's encoders beside what motors should have made of its commands."""

    def __init__(self, tracks: Tracks, base: Motion) -> None:
        self.tracks, self.base, self.rules = tracks, base, tracks.rules
        off, self._rows = wheel_errors(tracks, [base])
        label = nth(tracks.t - tracks.t.min(), BLOCK_SECONDS)[self._rows]
        run = tracks.row_segment[self._rows]
        self.block = np.unique(np.column_stack([run, label]), axis=0, return_inverse=True)[
            1
        ].ravel()
        self.part = tracks.part[self._rows]
        self.judged = np.ones(len(off), dtype=bool)
        self._least = coarse(tracks.step)
        self.scale = max(float(np.sqrt(np.mean(off**2))), self._least)

    def of_part(self, part: int) -> _Wheels | None:
        """The same judged in one part of the log alone; None: there is nothing of it."""
        if not (self.part == part).any():
            return None
        one = object.__new__(_Wheels)
        one.__dict__ = dict(self.__dict__, judged=self.part == part)
        return one

    def motion(self, terms: Terms, at: Coordinates) -> Motion:
        """The motion with terms at coordinates."""
        motion = self.base
        for term, here in zip(terms, at, strict=True):
            motion = term.cause.applied(motion, here, term.variant)
        return motion

    def off(self, terms: Terms, at: Coordinates) -> FloatArray:
        """(n, 2) errors of the rows judged, in their scale."""
        return wheel_errors(self.tracks, [self.motion(terms, at)])[0][self.judged] / self.scale

    def _loss(self, squared: FloatArray) -> FloatArray:
        """Student's t of squared errors and its two derivatives, as `least_squares` asks."""
        freedom = self.rules.row_freedom
        below = 1.0 + squared / freedom
        slope = (freedom + 1.0) / freedom / below
        return np.array([(freedom + 1.0) * np.log(below), slope, -slope / (freedom * below)])

    def jacobian(self, terms: Terms, at: Coordinates) -> FloatArray:
        """(2 n, p) of the errors by the terms' coordinates."""
        flat, columns = np.concatenate(at), []
        here = self.off(terms, at).ravel()
        parameters = [p for term in terms for p in term.cause.parameters]
        for k, p in enumerate(parameters):
            step = -p.step if flat[k] + p.step > p.bounds[1] else p.step
            there = flat.copy()
            there[k] += step
            columns.append((self.off(terms, _cut(terms, there)).ravel() - here) / step)
        return np.column_stack(columns)

    def _bounds(self, term: Term, k: int) -> tuple[float, float]:
        """Of a parameter, without the side on which nothing changes any more."""
        parameter = term.cause.parameters[k]
        low, high = parameter.bounds
        less = np.zeros(len(term.cause.parameters))
        less[k] = -parameter.step
        idle = np.isfinite(parameter.null) and self.motion((term,), (less,)) == self.base
        return (0.0 if idle else low), high

    def fit(self, terms: Terms, start: Coordinates) -> _Fit:
        """The terms where the errors are least, from a start."""
        smooth = tuple(k for k, term in enumerate(terms) if term.cause.smooth)
        at = list(start)
        if smooth:
            free = tuple(terms[k] for k in smooth)
            fixed = [(terms[k], start[k]) for k in range(len(terms)) if k not in smooth]

            def whole(flat: FloatArray) -> tuple[Terms, Coordinates]:
                own = list(zip(free, _cut(free, flat), strict=True)) + fixed
                return tuple(t for t, _ in own), tuple(c for _, c in own)

            parameters = [p for term in free for p in term.cause.parameters]
            low, high = np.array(
                [self._bounds(term, k) for term in free for k in range(len(term.cause.parameters))]
            ).T
            begin = np.clip(np.concatenate([start[k] for k in smooth]), low + 1e-9, high - 1e-9)

            def errors(flat: FloatArray) -> FloatArray:
                return self.off(*whole(flat)).ravel()

            def slopes(flat: FloatArray) -> FloatArray:
                return self.jacobian(*whole(flat))[:, : len(flat)]

            found = least_squares(
                errors,
                begin,
                jac=slopes,
                bounds=(low, high),
                loss=self._loss,  # type: ignore[arg-type]  # a union of callables in its stubs
                x_scale=SCALED * np.array([p.step for p in parameters]),
                max_nfev=EVALUATIONS,
            )
            for k, here in zip(smooth, _cut(free, found.x), strict=True):
                at[k] = here
        loss = self.deviance(self.off(terms, tuple(at)))
        return _Fit(terms=terms, at=tuple(at), loss=loss)

    def deviance(self, off: FloatArray) -> FloatArray:
        """(n,) of errors (n, 2)."""
        return np.asarray(self._loss(off**2)[0].sum(axis=1))

    def rescaled(self, fit: _Fit) -> None:
        """Take the errors' scale from a fit, robustly."""
        off = self.off(fit.terms, fit.at) * self.scale
        self.scale = max(NORMAL * float(np.median(np.abs(off))), self._least)

    def clearly(self, lost: FloatArray) -> bool:
        """Whether a loss (n,) is clearly above zero over blocks."""
        each = np.bincount(self.block[self.judged], lost)
        error = float(np.sqrt(np.sum((each - each.mean()) ** 2)))
        return float(each.sum()) > max(self.rules.cause_gate, self.rules.errors * error)

    def covariance(self, fit: _Fit) -> FloatArray:
        """(p, p) of the smooth coordinates, by blocks."""
        jacobian, off = self.jacobian(fit.terms, fit.at), self.off(fit.terms, fit.at).ravel()
        weight = self._loss(off**2)[1]
        stiff = jacobian.T @ (weight[:, None] * jacobian)
        block = np.repeat(self.block[self.judged], 2)
        slope = np.array([np.bincount(block, c) for c in (jacobian * (weight * off)[:, None]).T])
        inverse = np.linalg.pinv(stiff)
        number = slope.shape[1]
        return np.asarray(inverse @ (slope @ slope.T) @ inverse * number / max(number - 1, 1))


def _cut(terms: Terms, flat: FloatArray) -> Coordinates:
    """Flat coordinates by term."""
    edge = np.cumsum([len(term.cause.parameters) for term in terms])[:-1]
    return tuple(np.split(flat, edge))


@dataclass(frozen=True, eq=False, kw_only=True)
class Obeyed:
    """What the encoders tell of motors."""

    named: tuple[Named, ...] = ()
    by_part: tuple[Values, Values] = ({}, {})
    """Of each part of the log, the values that it gives by itself."""


def obeyed(tracks: Tracks, believed: Sequence[Motion]) -> Obeyed:
    """What motors make of commands, robot by robot.

    Args:
        tracks: With encoders.
        believed: (robots,) the model's motion of each.
    """
    named: list[Named] = []
    parts: tuple[dict[Key, tuple[Value, ...]], ...] = ({}, {})
    for k, robot in enumerate(tracks.robots):
        own = tracks.only([k])
        if not len(own.t):
            continue
        wheels = _Wheels(own, believed[k])
        fit = _chosen(wheels)
        if not fit.terms:
            continue
        each = [wheels.of_part(part) for part in (0, 1)]
        fits = [None if one is None else one.fit(fit.terms, fit.at) for one in each]
        found = _named(wheels, fit, robot, _shares(each, fits))
        named += found
        for values_of, one, own_fit in zip(parts, each, fits, strict=True):
            if one is not None and own_fit is not None:
                each_value = zip(found, _values(one, own_fit), strict=True)
                values_of.update({name.key: value for name, value in each_value})
    return Obeyed(named=tuple(named), by_part=(parts[0], parts[1]))


def widest(cause: Cause) -> Term:
    """The cause in both wheels, where it has a word for that."""
    return Term(cause, BOTH if BOTH in cause.variants else cause.variants[0])


def _menu() -> Terms:
    """What motors may do, of each wheel by itself where a cause has words for them."""
    return tuple(
        Term(cause, word)
        for cause in causes().values()
        if not withheld(cause.name) and not cause.given and before_the_encoders(cause)
        for word in cause.variants
        if word != BOTH
    )


def _starts(term: Term, commands: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coordinates to begin at: next to the null, and far from it where seconds are told."""
    null = np.array([0.0 if np.isfinite(p.null) else p.high for p in term.cause.parameters])
    near = (term.cause.starts(commands) or [null])[0]
    seconds = [p.unit == "s" for p in term.cause.parameters]
    most = [STRONG * p.bounds[1] for p in term.cause.parameters]
    return near, np.where(seconds, most, near)


def _chosen(wheels: _Wheels) -> _Fit:
    """The terms without which the wheels are clearly told worse."""
    menu = _menu()
    smooth = tuple(term for term in menu if term.cause.smooth)
    pairs = [_starts(term, wheels.tracks.commands) for term in smooth]
    slow = [k for k, (near, far) in enumerate(pairs) if (near != far).any()]
    begin = [
        tuple(pair[k in strong] for k, pair in enumerate(pairs))
        for strong in [(), *((k,) for k in slow), tuple(slow)]
    ]
    for _ in range(2):
        fit = min((wheels.fit(smooth, at) for at in begin), key=lambda one: float(one.loss.sum()))
        wheels.rescaled(fit)
        begin = [fit.at]
    fit = wheels.fit(smooth, fit.at)
    for cause in {term.cause.name: term.cause for term in menu if not term.cause.smooth}.values():
        fit = _with_threshold(wheels, fit, cause)
    while fit.terms:
        without = _without_least(wheels, fit)
        if without is None:
            break
        fit = without
    return _of_both(wheels, fit)


def _left_out(fit: _Fit, k: int) -> tuple[Terms, Coordinates]:
    """All but one term."""
    return fit.terms[:k] + fit.terms[k + 1 :], fit.at[:k] + fit.at[k + 1 :]


def _without_least(wheels: _Wheels, fit: _Fit) -> _Fit | None:
    """The fit without the term that is missed least; None: all are clearly missed."""
    alone = [wheels.off(*_left_out(fit, k)) for k in range(len(fit.terms))]
    order = np.argsort([float(wheels.deviance(off).sum()) for off in alone])
    for k in order.tolist():
        without = wheels.fit(*_left_out(fit, k))
        if not wheels.clearly(without.loss - fit.loss):
            return without
    return None


def _with_threshold(wheels: _Wheels, fit: _Fit, cause: Cause) -> _Fit:
    """The fit with a threshold that jumps beside it, in the wheels where it helps."""
    commands = wheels.tracks.commands
    tried = cause.starts(commands)
    for word in cause.variants:
        if word == BOTH or not tried:
            continue
        terms = (*fit.terms, Term(cause, word))
        beside = fit.at

        def deviance(threshold: float) -> float:
            off = wheels.off(terms, (*beside, np.array([threshold])))  # noqa: B023
            return float(wheels.deviance(off).sum())

        here = float(min(tried, key=lambda at: deviance(float(at[0])))[0])
        here = bracket(commands, here, deviance, wheels.rules.odds).best
        found = wheels.fit(terms, (*beside, np.array([here])))
        if wheels.clearly(fit.loss - found.loss):
            fit = found
    return fit


def _of_both(wheels: _Wheels, fit: _Fit) -> _Fit:
    """The fit with one value for both wheels where two are hardly better."""
    for cause in [term.cause for term in fit.terms if BOTH in term.cause.variants]:
        mine = [k for k, term in enumerate(fit.terms) if term.cause == cause]
        if len(mine) < 2:
            continue
        rest = [k for k in range(len(fit.terms)) if k not in mine]
        terms = (*(fit.terms[k] for k in rest), Term(cause, BOTH))
        mean = np.mean([fit.at[k] for k in mine], axis=0)
        one = wheels.fit(terms, (*(fit.at[k] for k in rest), mean))
        if not wheels.clearly(one.loss - fit.loss):
            fit = one
    return fit


def _shares(each: Sequence[_Wheels | None], fits: Sequence[_Fit | None]) -> list[float]:
    """(terms,) of the squared errors without each term, what it takes off the other part."""
    told = [one for one in fits if one is not None]
    left, kept = np.zeros(len(told[0].terms)), 0.0
    for part, wheels in enumerate(each):
        other = fits[1 - part]
        if wheels is None or other is None:
            continue
        kept += float(np.sum(wheels.off(other.terms, other.at) ** 2))
        for k in range(len(left)):
            left[k] += float(np.sum(wheels.off(*_left_out(other, k)) ** 2))
    return [1.0 - kept / one if one > 0.0 else 0.0 for one in left.tolist()]


def _values(wheels: _Wheels, fit: _Fit) -> list[tuple[Value, ...]]:
    """Parameters of every term with intervals."""
    covariance, begin, found = wheels.covariance(fit), 0, []
    for k, (term, at) in enumerate(zip(fit.terms, fit.at, strict=True)):
        mine = slice(begin, begin := begin + len(at))
        if term.cause.smooth:
            found.append(values(term, at, covariance[mine, mine]))
        else:
            found.append((_threshold(wheels, fit, k),))
    return found


def _threshold(wheels: _Wheels, fit: _Fit, k: int) -> Value:
    """A threshold between the commanded speeds that it may lie between."""

    def deviance(threshold: float) -> float:
        at = (*fit.at[:k], np.array([threshold]), *fit.at[k + 1 :])
        return float(wheels.deviance(wheels.off(fit.terms, at)).sum())

    here = float(fit.at[k][0])
    edges = bracket(wheels.tracks.commands, here, deviance, wheels.rules.odds)
    return told(fit.terms[k].cause.parameters[0], edges.mean, edges.low, edges.high)


def _named(wheels: _Wheels, fit: _Fit, robot: int, shares: Sequence[float]) -> list[Named]:
    """The terms as names."""
    covariance, begin, found = wheels.covariance(fit), 0, []
    numbers = _values(wheels, fit)
    for k, (term, at) in enumerate(zip(fit.terms, fit.at, strict=True)):
        mine = slice(begin, begin := begin + len(at))
        own = covariance[mine, mine]
        without = wheels.fit(*_left_out(fit, k))
        gain = float((without.loss - fit.loss).sum())
        found.append(
            Named(
                term=term,
                robots=(robot,),
                whole_swarm=False,
                values=numbers[k],
                evidence=Evidence(
                    term=term,
                    coordinates=at,
                    covariance=own,
                    gain=gain,
                    share=shares[k],
                    distance=min(float(np.sqrt(max(gain, 0.0))), SURE),
                ),
                twins=(),
            )
        )
    return found
