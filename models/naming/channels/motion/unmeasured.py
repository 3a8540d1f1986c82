"""What no healthy reference has measured, in words: it is neither named nor called unexplained."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.candidates import candidates, own_starts
from realitygap.models.naming.channels.motion.flexible import CHANNELS, QUANTITIES
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.health.reference import Reference

MEASURE = "`realitygap reference LOG... --out FILE` of sound robots' logs"
"""The command that measures it."""


def unmeasured(
    tracks: Tracks, base: Sequence[Motion], reference: Reference, flexible: Iterable[str]
) -> tuple[str, ...]:
    """Causes and flexible terms that this log could show and the reference says nothing of.

    Args:
        tracks: The log's.
        base: (robots,) healthy motion of each robot.
        reference: What healthy robots do.
        flexible: Keys of the log's flexible terms.
    """
    shown = [term for term in candidates() if own_starts(term, tracks.commands)]
    said = []
    shares = {name: given for term in shown for name, given in _of_nothing(term.cause, base)}
    for given in sorted(set(shares.values())):
        names = ", ".join(sorted(name for name, of in shares.items() if of == given))
        said.append(
            f"{names}: not told, for neither the model nor a healthy reference says the "
            f"{given} that they are shares of; {MEASURE} does"
        )
    causes = [term.key for term in shown if not reference.knows_term(term)]
    unknown = [key for key in flexible if not reference.knows_flexible(key)]
    words = set()
    for key in unknown:
        channel, _, quantity = key.partition("/")
        words.add(f"{CHANNELS[channel]} depending on {QUANTITIES[quantity]}")
    said += [not_named(causes)] if causes else []
    if unknown and len(unknown) == len(list(flexible)):
        said.append(not_judged({"anything follows a measured quantity"}))
    elif words:
        said.append(not_judged(words))
    return tuple(said)


def _of_nothing(cause: Cause, base: Sequence[Motion]) -> list[tuple[str, str]]:
    """A cause and its twins, each with what they are told against, where that is not known."""
    if cause.told_against is None or all(
        np.isfinite(cause.told_against(motion)).all() for motion in base
    ):
        return []
    given = " and ".join(p.name for p in cause.given)
    return [(name, given) for name in (cause.name, *cause.twins)]


def not_named(keys: Iterable[str]) -> str:
    """Of causes."""
    return (
        f"{', '.join(sorted(keys))}: not named, for the healthy reference does not say what sound "
        f"robots get for it; {MEASURE} does"
    )


def not_judged(words: Iterable[str]) -> str:
    """Of what may follow what."""
    return (
        f"whether {'; '.join(sorted(words))}: not judged, for the healthy reference does not say "
        f"how much sound robots do; {MEASURE} does"
    )
