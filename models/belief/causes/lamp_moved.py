"""A lamp that does not stand where it should."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause

FAR = 1.3
"""m that a lamp is looked for from where it should stand: across the arena."""
APART = 0.13
"""m between the places tried."""
DOUBT = 0.001
"""Of how far it was moved, error of its place: other parts of the captured table tell of it, each
wrong by a little of its own."""


def _leaps() -> list[FloatArray]:
    steps = np.arange(-FAR, FAR + 0.5 * APART, APART)
    return [np.array([x, y]) for x in steps for y in steps if np.hypot(x, y) > 1.5 * APART]


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y = belief.senses.lamp_shift
    shift = (x + float(values[0]), y + float(values[1]))
    return replace(belief, senses=replace(belief.senses, lamp_shift=shift))


CAUSE = SenseCause(
    name="lamp_moved",
    meaning="the lamp stands elsewhere than believed",
    plain="The lamp stands {x} along x and {y} along y from where the model has it. Put it back, "
    "or measure its place.",
    parameters=(
        Parameter(name="x", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002, doubt=DOUBT),
        Parameter(name="y", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002, doubt=DOUBT),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("second_lamp",),
    experiment="tour",
    leaps=_leaps,
)
