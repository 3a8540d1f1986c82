"""A nest that is not where the simulator has it."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y = belief.nest_shift
    return replace(belief, nest_shift=(x + float(values[0]), y + float(values[1])))


CAUSE = SenseCause(
    name="nest_moved",
    meaning="the virtual sensor says nest at another place than believed",
    plain="{Whose} virtual sensor has the nest {x} along x and {y} along y from where the model "
    "has it. Set it anew.",
    parameters=(
        Parameter(name="x", unit="m", null=0.0, low=-2.0, high=2.0, step=0.001),
        Parameter(name="y", unit="m", null=0.0, low=-2.0, high=2.0, step=0.001),
    ),
    sense=_sense,
    kind="nest",
    columns=("nest",),
    confusable_with=("nest_radius",),
    experiment="tour",
)
