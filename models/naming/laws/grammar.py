"""Which laws are tried: channels, and of every quantity the forms that it may have.

A *family* is a channel, a quantity and a form. It is tried on a grid of inner constants; the best
are refined. What swings (a cosine, a slope) is tried with both its phases at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.laws import CHANNELS, Atom, Channel, Form, Quantity
from realitygap.models.belief.catalogue import any_withheld

SPEED = 0.1
"""m/s that speeds are told in. No rule, as all numbers here: units and grids, which refinement
leaves."""
RADIUS = 0.5
"""m that distances from the middle are told in."""
MINUTE = 60.0
"""s that times are told in."""
TURN = 6.0
"""rad/s that wheels' speeds are told in: the cruise of the e-puck's search."""
HARMONICS = (1.0, 2.0, 3.0, 4.0)
QUARTER = 0.5 * np.pi
LIMITS = (1.0, 2.0, 3.0, 4.0, 5.0)
"""rad/s of wheels."""
LIMITED: tuple[Form, ...] = ("below", "over")
EDGES = (0.03, 0.05, 0.08, 0.12)
"""m of gaps and of distances to the wall."""
SCALES = (0.02, 0.05, 0.1)
"""m."""
FADES = {"time": (10.0, 30.0, 60.0), "since": (0.3, 1.0, 3.0)}
"""s."""
RADII = (0.1, 0.15, 0.22, 0.3)
"""m, of discs."""
SLOWEST, FASTEST = 0.75, 0.25
"""Periods in a log at least, and Hz at most, of what swings with time."""
WIDE: tuple[Channel, ...] = ("both", "speed", "turn", "aside")
"""Channels that may differ from region to region."""


MOST = 1e3
"""m, s or rad/s of inner constants: beyond it nothing fades in a log."""


class Candidate(NamedTuple):
    """One law of a family at inner constants, without an amplitude."""

    channel: Channel
    atoms: tuple[Atom, ...]
    """One; two of what swings, a quarter apart."""

    @property
    def family(self) -> tuple[Channel, Quantity, Form]:
        atom = self.atoms[0]
        return self.channel, atom.of, atom.form


def candidates(names: Sequence[str], places: np.ndarray, seconds: float) -> Iterator[Candidate]:
    """Every law that is tried.

    Args:
        names: Quantities that the log holds.
        places: (n, 2) m where its robots were.
        seconds: How long it lasts.
    """
    for channel in CHANNELS:
        for atoms in _atoms(channel, names, places, seconds):
            if atoms[0].of in names:
                yield Candidate(channel, atoms)


def _atoms(
    channel: Channel, names: Sequence[str], places: np.ndarray, seconds: float
) -> Iterator[tuple[Atom, ...]]:
    wheel = channel in ("left", "right", "both")
    for exponent in (1.0, 2.0, 3.0):
        if wheel:
            yield (Atom("wheel_speed", "power", (TURN, exponent)),)
        else:
            yield (Atom("speed", "power", (SPEED, exponent)),)
    yield (Atom("turn", "sign"),)
    if channel != "turn" and any_withheld():  # a constant is a listed cause by another name
        yield (Atom("wheel_speed" if wheel else "speed", "always"),)
    if wheel:
        yield from ((Atom("wheel_speed", form, (edge,)),) for edge in LIMITS for form in LIMITED)
    yield (Atom("wheel_speed" if wheel else "speed", "sign"),)
    for k in HARMONICS:
        yield swinging(Atom("heading", "cosine", (k, 0.0)))
        if channel == "left" or not wheel:
            yield swinging(Atom("left_angle", "cosine", (k, 0.0)))
        if channel == "right" or not wheel:
            yield swinging(Atom("right_angle", "cosine", (k, 0.0)))
    yield swinging(Atom("place", "slope", (RADIUS, 0.0)))
    for exponent in (1.0, 2.0, 4.0):
        yield (Atom("radius", "power", (RADIUS, exponent)),)
    for of in ("wall", "gap"):
        yield from ((Atom(of, "below", (edge,)),) for edge in EDGES)
        yield from ((Atom(of, "fade", (scale,)),) for scale in SCALES)
    yield (Atom("time", "power", (MINUTE, 1.0)),)
    for scale in FADES["time"]:
        yield (Atom("time", "fade", (scale,)),)
    for scale in FADES["since"]:
        yield (Atom("since", "fade", (scale,)),)
    if channel in WIDE and "place" in names:
        yield from _regions(places)
    if channel in WIDE:
        least = SLOWEST / seconds
        for rate in np.arange(least, FASTEST, 0.5 / seconds):
            yield swinging(Atom("time", "cosine", (2.0 * np.pi * float(rate), 0.0)))


def _regions(places: np.ndarray) -> Iterator[tuple[Atom, ...]]:
    """Halves and discs of the floor where robots were."""
    for direction in np.arange(0.0, 2.0 * np.pi, np.pi / 6.0):
        along = places[:, 0] * np.cos(direction) + places[:, 1] * np.sin(direction)
        for edge in np.quantile(along, (0.3, 0.4, 0.5, 0.6, 0.7)):
            yield (Atom("place", "half", (float(direction), float(edge))),)
    low, high = np.quantile(places, (0.05, 0.95), axis=0)
    for x, y in product(np.linspace(low[0], high[0], 6), np.linspace(low[1], high[1], 6)):
        for radius in RADII:
            yield (Atom("place", "disc", (float(x), float(y), radius)),)


def swinging(atom: Atom) -> tuple[Atom, Atom]:
    """A swing and what leads it by a quarter: their sum has any phase."""
    first, _ = atom.parameters
    return atom, Atom(atom.of, atom.form, (first, QUARTER))


def swings(atom: Atom) -> bool:
    """Whether a form has a phase."""
    return atom.form in ("cosine", "slope")


def at_phase(atom: Atom, phase: float) -> Atom:
    """A swing with another phase."""
    return Atom(atom.of, atom.form, (atom.parameters[0], phase))


def inner(atom: Atom) -> tuple[int, ...]:
    """Which of an atom's parameters are fitted beside amplitude and phase."""
    match atom.form:
        case "power":
            return (1,)
        case "cosine":
            return () if atom.of == "heading" else (0,)
        case "half":
            return (0, 1)
        case "disc":
            return (0, 1, 2)
        case "below" | "fade" | "over":
            return (0,)
        case _:
            return ()


def step_of(atom: Atom, seconds: float) -> tuple[float, ...]:
    """First steps of refinement, by inner parameter."""
    match atom.form:
        case "power":
            return (0.5,)
        case "cosine":
            return (0.2 / seconds,) if atom.of == "time" else (0.003 * atom.parameters[0],)
        case "half":
            return (0.2, 0.04)
        case "disc":
            return (0.04, 0.04, 0.04)
        case "below" | "over":
            return (0.25 * atom.parameters[0],)
        case "fade":
            return (0.4 * atom.parameters[0],)
        case _:
            return ()


def possible(atom: Atom) -> bool:
    """Whether inner constants mean something."""
    p = atom.parameters
    match atom.form:
        case "power":
            return 0.3 <= p[1] <= 8.0
        case "disc":
            return p[2] > 0.02
        case "below" | "fade" | "over":
            return 1e-3 < p[0] < MOST
        case _:
            return True
