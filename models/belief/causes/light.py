"""Light sensors, and how light falls."""

from __future__ import annotations

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, ONE_SENSOR, Belief, SenseCause, chosen


def _ambient_light(belief: Belief, values: FloatArray, variant: str) -> Belief:
    level = belief.senses.ambient_light + float(values[0])
    return belief.sensing(ambient_light=level)


AMBIENT_LIGHT = SenseCause(
    name="ambient_light",
    meaning="the room is brighter or darker than when the sensors were captured",
    plain="The room is {level:brighter/darker} than when the light sensors were captured. Shade "
    "its windows and lamps.",
    parameters=(
        Parameter(
            name="level",
            unit="share of the reading at 0.5 m",
            null=0.0,
            low=-0.6,
            high=10.0,
            step=0.005,
            doubt=0.08,
        ),
    ),
    sense=_ambient_light,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("second_lamp",),
    experiment="dark-tour",
)


SQUARE = 2.0
"""Exponent of the captured law."""


def _light_falloff(belief: Belief, values: FloatArray, variant: str) -> Belief:
    exponent = belief.senses.light_exponent * float(values[0]) / SQUARE
    return belief.sensing(light_exponent=exponent)


LIGHT_FALLOFF = SenseCause(
    name="light_falloff",
    meaning="the light falls off with another power of distance",
    plain="The light falls off with distance to the power {exponent}. Look for reflections and "
    "for other lamps.",
    parameters=(Parameter(name="exponent", unit="1", null=SQUARE, low=0.0, high=6.0, step=0.01),),
    sense=_light_falloff,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_height", "lamp_intensity", "light_gamma"),
    experiment="tour",
)


def _light_gamma(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gamma = belief.senses.light_gamma * float(values[0])
    return belief.sensing(light_gamma=gamma)


LIGHT_GAMMA = SenseCause(
    name="light_gamma",
    meaning="the light sensors answer to light with another response curve",
    plain="{Whose} light sensors answer with the power {exponent} of what they were captured "
    "with. Capture them again.",
    parameters=(Parameter(name="exponent", unit="1", null=1.0, low=0.2, high=5.0, step=0.005),),
    sense=_light_gamma,
    kind="ls",
    columns=(*LS, "case"),
    confusable_with=("light_falloff", "lamp_height", "ambient_light"),
    experiment="tour",
)


def _ls_dead_sensor(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain = list(belief.senses.ls_gain)
    for k in chosen(variant):
        gain[k] = 0.0
    return belief.sensing(ls_gain=tuple(gain))


LS_DEAD_SENSOR = SenseCause(
    name="ls_dead_sensor",
    meaning="a light sensor is covered or dead: it reads dark whatever light falls on it",
    plain="{Whose} light {which} reads dark, whatever light falls on it. Uncover it, or replace "
    "it.",
    parameters=(),
    sense=_ls_dead_sensor,
    kind="ls",
    smooth=False,
    variants=ONE_SENSOR,
    word="sensor",
    columns=LS,
    experiment="tour",
)
