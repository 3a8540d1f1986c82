"""Lamps, and where they stand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim import PointModel
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


def _lamp_moved_leaps() -> list[FloatArray]:
    steps = np.arange(-FAR, FAR + 0.5 * APART, APART)
    return [np.array([x, y]) for x in steps for y in steps if np.hypot(x, y) > 1.5 * APART]


def _lamp_moved(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y = belief.senses.lamp_shift
    shift = (x + float(values[0]), y + float(values[1]))
    return belief.sensing(lamp_shift=shift)


LAMP_MOVED = SenseCause(
    name="lamp_moved",
    meaning="the lamp stands elsewhere than believed",
    plain="The lamp stands {x} along x and {y} along y from where the model has it. Put it back, "
    "or measure its place.",
    parameters=(
        Parameter(name="x", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002, doubt=DOUBT),
        Parameter(name="y", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002, doubt=DOUBT),
    ),
    sense=_lamp_moved,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("second_lamp",),
    experiment="tour",
    leaps=_lamp_moved_leaps,
)


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


def _second_lamp_starts(commands: FloatArray) -> list[FloatArray]:
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [np.array([r * np.cos(a), r * np.sin(a), DIM]) for r in REACH for a in angles]


def _second_lamp_leaps() -> list[FloatArray]:
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [np.array([RIM * np.cos(a), RIM * np.sin(a), i]) for i in BRIGHT for a in angles]


def _second_lamp(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y, intensity = (float(value) for value in values)
    if intensity <= 0.0:
        return belief
    return belief.sensing(second_lamp=(x, y, intensity))


SECOND_LAMP = SenseCause(
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
    sense=_second_lamp,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("ambient_light", "lamp_moved"),
    experiment="dark-tour",
    starts=_second_lamp_starts,
    leaps=_second_lamp_leaps,
)


CAPTURED_HEIGHT = PointModel().lamp_height
"""m, of the captured lamp."""


def _lamp_height(belief: Belief, values: FloatArray, variant: str) -> Belief:
    believed = belief.senses.lamp_height
    moved = 0.0 if believed is None else believed - CAPTURED_HEIGHT
    return belief.sensing(lamp_height=float(values[0]) + moved)


LAMP_HEIGHT = SenseCause(
    name="lamp_height",
    meaning="the lamp is higher or lower than the captured one",
    plain="The lamp hangs {height:higher/lower} than when the sensors were captured. Measure its "
    "height.",
    parameters=(
        Parameter(name="height", unit="m", null=CAPTURED_HEIGHT, low=0.0, high=5.0, step=0.001),
    ),
    sense=_lamp_height,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_intensity", "light_falloff"),
    experiment="tour",
)


def _lamp_intensity(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return belief.sensing(lamp_intensity=belief.senses.lamp_intensity * float(values[0]))


LAMP_INTENSITY = SenseCause(
    name="lamp_intensity",
    meaning="the lamp is brighter or dimmer than the captured one",
    plain="The lamp is {scale:brighter/dimmer} than when the sensors were captured. Check its "
    "supply and its bulb.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.01, high=100.0, step=0.01, link="factor"),
    ),
    sense=_lamp_intensity,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_height", "light_falloff", "lamp_decay"),
    experiment="tour",
)


def _lamp_decay(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return belief.sensing(lamp_decay=belief.senses.lamp_decay + float(values[0]))


LAMP_DECAY = SenseCause(
    name="lamp_decay",
    meaning="the lamp dims as time goes by",
    plain="The lamp dims: it loses {rate}. Check its supply, or replace it.",
    parameters=(Parameter(name="rate", unit="1/s", null=0.0, low=-1e-4, high=0.1, step=0.0002),),
    sense=_lamp_decay,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_intensity",),
    experiment="tour",
)
