"""A model file for a robot of one's own."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import tomli_w

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.files import checked

RIM_SPEED = 1.0
"""m/s of a wheel's rim, where nobody says how fast it turns. Our choice: it only tells commands in
millimetres from those in metres, by a factor of ten more than this."""
LARGEST = {"wheel_radius": 2.0, "axle": 20.0}
"""m, of any machine on wheels: a mining lorry's are smaller. More is millimetres."""
NEW = Path("new model")
"""What it is called in a refusal."""


def new_model(
    *,
    wheel_radius: float,
    axle: float,
    body_radius: float | None = None,
    wheel_speed_max: float | None = None,
    name: str = "my robot",
) -> str:
    """The text of a model file (TOML) of a robot on two wheels.

    Args:
        wheel_radius: m.
        axle: m between the wheels' ground contacts.
        body_radius: m; if absent, a circle about the middle of the axle that holds the wheels.
        wheel_speed_max: rad/s; if absent, for `RIM_SPEED`.
        name: Of the robot.

    Raises:
        InputError: a value is no size of a robot.
    """
    for key, value in {"wheel_radius": wheel_radius, "axle": axle}.items():
        if LARGEST[key] < value < math.inf:
            expected = f"metres, at most {LARGEST[key]:g}: {value:g} mm are {value / 1e3:g} m"
            raise InputError(f"--{key.replace('_', '-')}", f"{value:g}", expected)
    given = "as given"
    body, about = (body_radius, given)
    if body is None:
        body, about = (axle**2 / 4 + wheel_radius**2) ** 0.5, "the circle that holds the wheels"
    fastest, why = (wheel_speed_max, given)
    if fastest is None and wheel_radius:
        fastest, why = RIM_SPEED / wheel_radius, f"for {RIM_SPEED:g} m/s; only judges commands"
    values = {
        "wheel_radius": (wheel_radius, f"m; {given}"),
        "axle": (axle, f"m between the wheels' ground contacts; {given}"),
        "body_radius": (round(body, 4), f"m; {about}"),
        "wheel_speed_max": (round(fastest or 0.0, 2), f"rad/s; {why}"),
    }
    lines = [f"{key} = {value}  # {remark}" for key, (value, remark) in values.items()]
    text = f"{tomli_w.dumps({'name': name})}\n[robot]\n" + "\n".join(lines) + "\n"
    checked(ModelFile, tomllib.loads(text), NEW, "a model file")
    return text
