"""Sealed laws: physical terms of wheels' speeds, half of them inside the grammar, half outside.

They are known to this battery alone and are written independently of the grammar's own atoms. A
size of 1 is a bar: about 1 mm/s or 0.03 rad/s where the term is largest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from realitygap.reality import constants as k
from realitygap.reality.effects import Effect, Key
from realitygap.reality.effects.effect import Robots, Value, number
from realitygap.reality.hardware import FloatArray, Hardware

SHARE, RATE = 0.02, 0.03
"""A bar: share of a wheel's speed; rad/s."""
Strength = Callable[[FloatArray, FloatArray, FloatArray, float], FloatArray]
"""(speeds (n, 2), angles (n, 2), poses (n, 3), s) -> (n,) strength, or (n, 2) of each wheel."""


@dataclass(frozen=True)
class Sealed:
    """One law."""

    name: str
    acts: str
    """`left`, `right`, `both` (share of the wheels' speeds), `turn` (rad/s)."""
    strength: Strength | None
    """None: a listed cause, which the diagnosis is to do without."""
    channels: frozenset[str]
    """That are right; what acts on both wheels alike shows in what they have in common."""
    quantities: frozenset[str]
    forms: frozenset[str]
    """That are right; empty: the grammar has none."""

    @property
    def inside(self) -> bool:
        return bool(self.forms)


def _gap(poses: FloatArray) -> FloatArray:
    apart = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return np.asarray(apart.min(axis=1) - 2.0 * k.BODY_RADIUS)


def _saw(angle: FloatArray) -> FloatArray:
    return np.mod(angle, 2.0 * np.pi) / np.pi - 1.0


def _law(name: str, acts: str, strength: Strength, of: str, forms: str = "") -> Sealed:
    channels = {"both": "both speed", "turn": "turn turning bend"}.get(acts, acts)
    return Sealed(
        name,
        acts,
        strength,
        frozenset(channels.split()),
        frozenset(of.split()),
        frozenset(forms.split()),
    )


def _radius(p: FloatArray) -> FloatArray:
    return np.hypot(p[:, 0], p[:, 1])


LAWS = (
    _law("compass", "turn", lambda w, a, p, t: np.sin(p[:, 2] - 0.9), "heading", "cosine"),
    _law("axis", "turn", lambda w, a, p, t: np.cos(2.0 * p[:, 2]), "heading", "cosine"),
    _law("eccentric", "left", lambda w, a, p, t: np.cos(a[:, 0]), "left_angle", "cosine"),
    _law("ripple", "right", lambda w, a, p, t: np.cos(4.0 * a[:, 1]), "right_angle", "cosine"),
    _law(
        "pond",
        "both",
        lambda w, a, p, t: -1.0 * (np.hypot(p[:, 0] - 0.2, p[:, 1] - 0.1) < 0.15),
        "place",
        "disc",
    ),
    _law("carpet", "both", lambda w, a, p, t: -1.0 * (p[:, 0] + p[:, 1] > 0.1), "place", "half"),
    _law("near", "both", lambda w, a, p, t: -1.0 * (_gap(p) < 0.05), "gap", "below"),
    _law("shy", "both", lambda w, a, p, t: -np.exp(-_gap(p) / 0.06), "gap", "fade"),
    _law(
        "bowl",
        "both",
        lambda w, a, p, t: (_radius(p) / 0.5) ** 2,
        "radius wall place",
        "power fade",
    ),
    _law(
        "hum",
        "both",
        lambda w, a, p, t: np.full(len(p), np.sin(2.0 * np.pi * t / 20.0)),
        "time",
        "cosine",
    ),
    _law(
        "slip", "both", lambda w, a, p, t: -((np.abs(w) / 6.0) ** 2), "wheel_speed speed", "power"
    ),
    _law("warm", "both", lambda w, a, p, t: np.full(len(p), -np.exp(-t / 25.0)), "time", "fade"),
    # from here on the grammar has no form
    _law("triangle", "turn", lambda w, a, p, t: _saw(p[:, 2]), "heading"),
    _law(
        "quadrant", "turn", lambda w, a, p, t: 1.0 * (np.mod(p[:, 2], 2 * np.pi) < 1.2), "heading"
    ),
    _law("notch", "left", lambda w, a, p, t: 1.0 * (np.cos(a[:, 0]) > 0.7), "left_angle"),
    _law(
        "ring",
        "both",
        lambda w, a, p, t: -1.0 * (np.abs(_radius(p) - 0.3) < 0.08),
        "radius place wall",
    ),
    _law("stripe", "both", lambda w, a, p, t: -1.0 * (np.abs(p[:, 0]) < 0.1), "place"),
    _law(
        "stairs",
        "both",
        lambda w, a, p, t: 1.0 * (np.floor(4.0 * p[:, 0]) + np.floor(4.0 * p[:, 1]) % 2),
        "place",
    ),
    _law("polite", "both", lambda w, a, p, t: -1.0 * (np.abs(_gap(p) - 0.12) < 0.04), "gap"),
    _law(
        "pulse",
        "both",
        lambda w, a, p, t: np.full(len(p), 1.0 * (t % 30.0 < 8.0)),
        "time",
    ),
    _law("late", "both", lambda w, a, p, t: np.full(len(p), -1.0 * (t > 70.0)), "time"),
    _law("gear", "both", lambda w, a, p, t: -1.0 * (np.abs(w) > 4.0), "wheel_speed speed"),
    _law(
        "twist",
        "turn",
        lambda w, a, p, t: _radius(p) / 0.5 * np.cos(p[:, 2]),
        "heading place radius",
    ),
    _law("rim", "both", lambda w, a, p, t: np.sin(12.0 * _radius(p)), "radius wall place"),
)
"""Twelve inside the grammar, twelve outside."""


def _listed(name: str, channels: str, of: str, forms: str) -> Sealed:
    return Sealed(name, "", None, *(frozenset(some.split()) for some in (channels, of, forms)))


SPEEDS = "speed wheel_speed"
LISTED = (
    _listed("wheel_radius_scale", "both speed", SPEEDS, "always"),
    _listed("wheel_radius_mismatch", "left right bend", SPEEDS, "always sign"),
    _listed("wheel_separation", "turning", SPEEDS, "always"),
    _listed("motor_saturation", "left right both", "wheel_speed", "over"),
    _listed("motor_dead_zone", "left right both", "wheel_speed", "below"),
    _listed("speed_droop", "both speed", "time", "power"),
    _listed("tracker_yaw_offset", "aside", SPEEDS, "always"),
)
"""Causes that come back as laws if the catalogue lacks them; of the others the grammar has none."""


def effect_of(law: Sealed) -> Effect:
    """A law as something that can be hidden: `NAME:bars=2,robot=3`."""
    strength = law.strength
    assert strength is not None

    def apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
        has: FloatArray = np.zeros((hardware.robots, 1))
        has[robots] = number(values, "bars")
        before = hardware.laws.wheels or (lambda speeds, angles, poses, time: speeds)
        lever = hardware.axle[:, None] / (2.0 * hardware.wheel_radius)

        def obey(w: FloatArray, a: FloatArray, p: FloatArray, t: float) -> FloatArray:
            speeds = before(w, a, p, t)
            size = strength(speeds, a, p, t)
            wide = size if size.ndim == 2 else size[:, None]
            if law.acts == "turn":
                moving = np.any(speeds != 0.0, axis=1, keepdims=True)
                return np.asarray(speeds + has * RATE * wide * moving * lever * [-1.0, 1.0])
            on = {"left": [1.0, 0.0], "right": [0.0, 1.0], "both": [1.0, 1.0]}[law.acts]
            return np.asarray(speeds * (1.0 + has * SHARE * wide * on))

        hardware.laws.wheels = obey

    return Effect(
        name=law.name,
        kind="motion",
        physics="a sealed law",
        parameters={"bars": Key(unit="bars", low=-10.0, high=10.0, null=0.0)},
        apply=apply,
    )


EFFECTS = {law.name: effect_of(law) for law in LAWS}
