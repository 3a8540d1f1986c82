"""Healthy motion as the rows of a log show it: how they were recorded, fitted to all robots."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.models.belief.cause import ALL
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.recording import recording, unsure
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.engine.differing import nearest
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.state import SWARM, State
from realitygap.models.naming.engine.value import Value, values
from realitygap.models.naming.engine.weighed import Weighed

ROUNDS = 2
"""Times the noise is learned anew at the recording found. No rule: a limit of iterations."""


class AsRecorded(NamedTuple):
    """How a log was recorded."""

    base: tuple[Motion, ...]
    """(robots,) motions as its rows show them."""
    values: tuple[Value, ...]
    """Delay (s), clock's rate, smear (s^2), scale, a filter's lag (s), with 95 % intervals; empty:
    no fit."""


def recorded(tracks: Tracks, base: tuple[Motion, ...], health: Health) -> AsRecorded:
    """How a log was recorded, from most of its robots together.

    Those that are unlike the rest do not say it: a robot that is late is no log that is late.

    Args:
        tracks: The log's.
        base: (robots,) healthy.
        health: How robots and swarms differ.
    """
    term = Term(recording(tracks.step, tracks.rules, filtered=tracks.filtered), ALL)
    found = np.zeros(len(term.cause.parameters))
    if tracks.filtered:
        found[-1] = tracks.step  # from its null, a bound, a fit may not move
    said: tuple[Value, ...] = ()
    for _ in range(ROUNDS):
        here = [term.cause.applied(motion, found, ALL) for motion in base]
        there = tuple(robots_of(tracks, here, doses=False))
        unsure_of = unsure(tracks.step, there[0].names, tracks.rules)
        near = nearest(Weighed(State(tracks, base, there, health, unsure=unsure_of)))
        some = State(
            tracks.only(near), tuple(base[k] for k in near), tuple(there[k] for k in near), health
        )
        fit = Fitter(Weighed(some), SWARM).fit([term], [found])
        if fit is None:
            break
        (found,) = fit.coordinates
        said = values(term, found, fit.covariance)
    return AsRecorded(tuple(term.cause.applied(motion, found, ALL) for motion in base), said)
