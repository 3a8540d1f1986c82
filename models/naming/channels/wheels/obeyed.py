"""What is the matter with motors, by the wheels' own encoders.

Nobody measured healthy motors: every number is told beside the minimal model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.fitted import Key, Values
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.channels.wheels.chosen import chosen, left_out
from realitygap.models.naming.channels.wheels.fit import EncodedWheels, WheelFit
from realitygap.models.naming.engine.threshold import bracket
from realitygap.models.naming.engine.value import Value, told, values
from realitygap.models.naming.findings import SURE, Evidence, Named


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
        if not (np.diff(own.start) > 1).any():  # encoders count from row to row
            continue
        wheels = EncodedWheels(own, believed[k])
        fit = chosen(wheels)
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


def _shares(each: Sequence[EncodedWheels | None], fits: Sequence[WheelFit | None]) -> list[float]:
    """(terms,) of the squared errors without each term, what it takes off the other part."""
    told = [one for one in fits if one is not None]
    left, kept = np.zeros(len(told[0].terms)), 0.0
    for part, wheels in enumerate(each):
        other = fits[1 - part]
        if wheels is None or other is None:
            continue
        kept += float(np.sum(wheels.off(other.terms, other.at) ** 2))
        for k in range(len(left)):
            left[k] += float(np.sum(wheels.off(*left_out(other, k)) ** 2))
    return [1.0 - kept / one if one > 0.0 else 0.0 for one in left.tolist()]


def _values(wheels: EncodedWheels, fit: WheelFit) -> list[tuple[Value, ...]]:
    """Parameters of every term with intervals."""
    covariance, begin, found = wheels.covariance(fit), 0, []
    for k, (term, at) in enumerate(zip(fit.terms, fit.at, strict=True)):
        mine = slice(begin, begin := begin + len(at))
        if term.cause.smooth:
            found.append(values(term, at, covariance[mine, mine]))
        else:
            found.append((_threshold(wheels, fit, k),))
    return found


def _threshold(wheels: EncodedWheels, fit: WheelFit, k: int) -> Value:
    """A threshold between the commanded speeds that it may lie between."""

    def deviance(threshold: float) -> float:
        at = (*fit.at[:k], np.array([threshold]), *fit.at[k + 1 :])
        return float(wheels.deviance(wheels.off(fit.terms, at)).sum())

    here = float(fit.at[k][0])
    edges = bracket(wheels.tracks.commands, here, deviance, wheels.rules.odds)
    return told(fit.terms[k].cause.parameters[0], edges.mean, edges.low, edges.high)


def _named(
    wheels: EncodedWheels, fit: WheelFit, robot: int, shares: Sequence[float]
) -> list[Named]:
    """The terms as names."""
    covariance, begin, found = wheels.covariance(fit), 0, []
    numbers = _values(wheels, fit)
    for k, (term, at) in enumerate(zip(fit.terms, fit.at, strict=True)):
        mine = slice(begin, begin := begin + len(at))
        own = covariance[mine, mine]
        without = wheels.fit(*left_out(fit, k))
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
