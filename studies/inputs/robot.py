"""A model file of one's own robot."""

from __future__ import annotations

from realitygap.models.belief.new_model import model_text


def new_model(
    *,
    wheel_radius: float,
    axle: float,
    body_radius: float | None = None,
    wheel_speed_max: float | None = None,
    name: str = "my robot",
) -> str:
    """The text of a model file for a robot on two wheels, to be kept as a `.toml`.

    Args:
        wheel_radius: m.
        axle: m between the wheels' ground contacts.
        body_radius: m; if absent, the circle about the middle of the axle that holds the wheels.
        wheel_speed_max: rad/s; if absent, a rim's 1 m/s. It only judges whether commands can be.
        name: Of the robot.

    Raises:
        InputError: a value is no size of a robot.
    """
    return model_text(
        wheel_radius=wheel_radius,
        axle=axle,
        body_radius=body_radius,
        wheel_speed_max=wheel_speed_max,
        name=name,
    )
