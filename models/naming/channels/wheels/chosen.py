"""Which terms one robot's wheels need.

Delay, lag, limits and dead zone of real motors are large, and each hides the others. So all are
fitted together first; one after the other is then taken away as long as nothing is clearly lost
over blocks of time.

The chain from a command to a pose is cut where the encoders are. Before the cut stand motors and
their controller. Behind it stand wheels, floor and tracker, whose poses are then predicted from
what the encoders counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.driven import with_changes
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.channels.wheels.fit import Coordinates, EncodedWheels, WheelFit
from realitygap.models.naming.engine.hypothesis import Term, Terms
from realitygap.models.naming.engine.threshold import bracket


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


STRONG = 0.2
"""Of the most seconds that the catalogue believes, where a fit begins as well: a delay of many
commands looks like none from nearby. No rule: of numerics."""
BOTH = "both"
"""Word for the left and the right wheel."""


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


def chosen(wheels: EncodedWheels) -> WheelFit:
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


def left_out(fit: WheelFit, k: int) -> tuple[Terms, Coordinates]:
    """All but one term."""
    return fit.terms[:k] + fit.terms[k + 1 :], fit.at[:k] + fit.at[k + 1 :]


def _without_least(wheels: EncodedWheels, fit: WheelFit) -> WheelFit | None:
    """The fit without the term that is missed least; None: all are clearly missed."""
    alone = [wheels.off(*left_out(fit, k)) for k in range(len(fit.terms))]
    order = np.argsort([float(wheels.deviance(off).sum()) for off in alone])
    for k in order.tolist():
        without = wheels.fit(*left_out(fit, k))
        if not wheels.clearly(without.loss - fit.loss):
            return without
    return None


def _deviance_of(
    wheels: EncodedWheels, terms: Terms, beside: Coordinates, threshold: float
) -> float:
    """With a threshold as the last term."""
    off = wheels.off(terms, (*beside, np.array([threshold])))
    return float(wheels.deviance(off).sum())


def _with_threshold(wheels: EncodedWheels, fit: WheelFit, cause: Cause) -> WheelFit:
    """The fit with a threshold that jumps beside it, in the wheels where it helps."""
    commands = wheels.tracks.commands
    tried = cause.starts(commands)
    for word in cause.variants:
        if word == BOTH or not tried:
            continue
        terms = (*fit.terms, Term(cause, word))
        deviance = partial(_deviance_of, wheels, terms, fit.at)
        here = float(tried[int(np.argmin([deviance(float(at[0])) for at in tried]))][0])
        here = bracket(commands, here, deviance, wheels.rules.odds).best
        found = wheels.fit(terms, (*fit.at, np.array([here])))
        if wheels.clearly(fit.loss - found.loss):
            fit = found
    return fit


def _of_both(wheels: EncodedWheels, fit: WheelFit) -> WheelFit:
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
