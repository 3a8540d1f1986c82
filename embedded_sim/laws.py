"""Laws: small terms that a simulator adds to what its wheels and its body do.

A law is a channel, an amplitude and one or two *atoms*, dimensionless functions of one quantity
each. What it adds in every step is the amplitude times the product of its atoms. Amplitude 0 adds
nothing, and such laws are not handed on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

Channel = Literal["left", "right", "both", "speed", "turning", "turn", "bend", "aside"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
"""What changes: how fast a wheel turns, or both (a share of it), how fast the body moves ahead (a
share), turns (a share), turns (rad/s), bends (rad/m), slides to the left (m per m driven)."""

Quantity = Literal[
    "wheel_speed",
    "speed",
    "turn",
    "heading",
    "left_angle",
    "right_angle",
    "radius",
    "place",
    "wall",
    "gap",
    "time",
    "since",
]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
"""Of: that wheel's own speed (rad/s), the robot's speed (m/s) and turn rate (rad/s), its heading,
the angle of a wheel (rad), its distance from the arena's middle (m), its place (m), the distance to
the wall, that to the next robot's body (m), time since the run began, time since it was told to
leave rest (s)."""

Form = Literal["power", "sign", "cosine", "slope", "half", "disc", "below", "fade", "curve"]
FORMS: tuple[Form, ...] = get_args(Form)
"""`power` (scale, exponent): (q / scale)^exponent of the quantity's size; `sign`: -1, 0, 1;
`cosine` (k, phase): cos(k q - phase); of places: `slope` (scale, direction), distance along a
direction over the scale, `half` (direction, edge), 1 beyond an edge, `disc` (x, y, radius), 1
inside; `below` (edge): 1 below it; `fade` (scale): exp(-q / scale); `curve` (first, last, values):
straight lines between values evenly spaced, and the end values beyond."""


@dataclass(frozen=True, slots=True)
class Atom:
    """A dimensionless function of one quantity."""

    of: Quantity
    form: Form
    parameters: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Law:
    """One term."""

    channel: Channel
    amplitude: float
    """In the channel's unit: 1, rad/s (`turn`) or rad/m (`bend`)."""
    atoms: tuple[Atom, ...]
