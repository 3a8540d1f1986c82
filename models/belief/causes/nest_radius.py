"""A nest larger or smaller than the simulator has it."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return replace(belief, nest_scale=belief.nest_scale * float(values[0]))


CAUSE = SenseCause(
    name="nest_radius",
    meaning="the virtual sensor says nest within another radius than believed",
    plain="{Whose} virtual sensor has a nest whose radius is {scale:larger/smaller} than the "
    "model's. Set it anew.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.05, high=5.0, step=0.01, link="factor"),
    ),
    sense=_sense,
    kind="nest",
    columns=("nest",),
    confusable_with=("nest_moved",),
    experiment="tour",
)
