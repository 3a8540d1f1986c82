"""Another lamp, as a window in the room."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause

DIRECTIONS = 12
REACH = (0.7, 0.35)
"""m from the arena's centre where a lamp is first looked for."""
DIM = 0.02
"""Share of the lamp that it is first taken to have."""

RIM = 0.65
"""m from the arena's centre where a bright one is tried."""
BRIGHT = (0.3, 1.0, 3.0)
"""Shares of the lamp that a bright one is tried to have."""

PLACE = Parameter(
    name="", unit="m", null=0.0, low=-3.0, high=3.0, step=0.005, doubt=0.02, unsure=2e-4
)
"""Where it is; the captured table's interpolation leaves some tenths of a millimetre."""


def _starts(commands: FloatArray) -> list[FloatArray]:
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [np.array([r * np.cos(a), r * np.sin(a), DIM]) for r in REACH for a in angles]


def _leaps() -> list[FloatArray]:
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [np.array([RIM * np.cos(a), RIM * np.sin(a), i]) for i in BRIGHT for a in angles]


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y, intensity = (float(value) for value in values)
    if intensity <= 0.0:
        return belief
    return replace(belief, senses=replace(belief.senses, second_lamp=(x, y, intensity)))


CAUSE = SenseCause(
    name="second_lamp",
    meaning="there is another source of light, as a window",
    plain="Another light shines at x = {x}, y = {y}, with {intensity:%} of the lamp's. Look "
    "there for a window or a lamp.",
    parameters=(
        replace(PLACE, name="x"),
        replace(PLACE, name="y"),
        Parameter(
            name="intensity",
            unit="share of the lamp",
            null=0.0,
            low=0.0,
            high=100.0,
            step=0.005,
            doubt=0.1,
        ),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("ambient_light", "lamp_moved"),
    experiment="dark-tour",
    starts=_starts,
    leaps=_leaps,
)
