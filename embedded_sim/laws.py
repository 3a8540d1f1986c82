"""Laws: small terms that a simulator adds to what its wheels and its body do.

A law is a channel, an amplitude and one or two *atoms*, dimensionless functions of one quantity
each. What it adds in every step is the amplitude times the product of its atoms. Amplitude 0 adds
nothing, and such laws are not handed on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

from realitygap.embedded_sim.errors import InputError

Channel = Literal["left", "right", "both", "speed", "turning", "turn", "bend", "aside"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
"""What changes: how fast a wheel turns, or both (a share of it), how fast the body moves ahead (a
share), turns (a share), turns (rad/s, while a wheel turns: a robot that stands is held by its
tyres), bends (rad/m), slides to the left (m per m driven)."""
STANDS = 0.01
"""rad/s of the faster wheel, below which a robot stands; as in C."""

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

Form = Literal[
    "power",
    "sign",
    "cosine",
    "slope",
    "half",
    "disc",
    "below",
    "fade",
    "curve",
    "always",
    "over",
]
FORMS: tuple[Form, ...] = get_args(Form)
"""`power` (scale, exponent): (q / scale)^exponent of the quantity's size; `sign`: -1, 0, 1;
`cosine` (k, phase): cos(k q - phase); of places: `slope` (scale, direction), distance along a
direction over the scale, `half` (direction, edge), 1 beyond an edge, `disc` (x, y, radius), 1
inside; `below` (edge): 1 below it, in size where q is a speed; `fade` (scale): exp(-q / scale);
`curve` (first, last, values): straight lines between values evenly spaced, and the end values
beyond; `always`: 1; `over` (limit): the share of the quantity's size that is beyond a limit."""


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


SIMULATED = frozenset(QUANTITIES) - {"left_angle", "right_angle", "since"}
"""Quantities that the simulator knows: a wheel's angle has another phase in every run."""
MOST_LAWS = 8
"""Of a drive."""
MOST_NUMBERS = 20
"""Of an atom in C."""
_OF = ("wheel_speed", "speed", "turn", "heading", "radius", "place", "wall", "gap", "time")
"""In C's order."""


def law_struct(law: Law) -> dict[str, Any]:
    """What a C struct `rg_law` is made of.

    Raises:
        InputError: a quantity that the simulator does not know, or too many atoms or numbers.
    """
    if not 1 <= len(law.atoms) <= 2:
        raise InputError("drive.laws", f"{len(law.atoms)} atoms", "one or two")
    return {
        "channel": CHANNELS.index(law.channel),
        "atoms": len(law.atoms),
        "amplitude": law.amplitude,
        "atom": [_atom_struct(atom) for atom in law.atoms],
    }


def _atom_struct(atom: Atom) -> dict[str, Any]:
    if atom.of not in _OF:
        raise InputError("drive.laws", repr(atom.of), f"one of {', '.join(_OF)}")
    values = list(atom.parameters)
    angle = {"cosine": 1, "slope": 1, "half": 0}.get(atom.form)
    if angle is not None and len(values) == 2:
        values += [math.cos(values[angle]), math.sin(values[angle])]
    sound = bool(values) and values[0] > 0.0  # of a scale; C refuses it otherwise
    if atom.form == "power" and len(values) == 2:
        values.append(values[0] ** -values[1] if sound else 0.0)
    if atom.form == "fade" and len(values) == 1:
        values.append(-1.0 / (math.log(2.0) * values[0]) if sound else 0.0)
    if len(values) > MOST_NUMBERS or len(values) < _LEAST[atom.form]:
        raise InputError("drive.laws", f"{len(atom.parameters)} numbers", f"those of {atom.form}")
    form = FORMS.index(atom.form)
    return {"of": _OF.index(atom.of), "form": form, "numbers": len(values), "number": values}


_LEAST: dict[Form, int] = {
    "power": 3,
    "sign": 0,
    "cosine": 4,
    "slope": 4,
    "half": 4,
    "disc": 3,
    "below": 1,
    "fade": 2,
    "curve": 4,
    "always": 0,
    "over": 1,
}
"""Numbers of a form in C."""
