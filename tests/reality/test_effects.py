"""The catalogue as a whole: names and keys, nulls that change nothing, robots that are spared."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.reality.effects import catalogue, parse_effects
from realitygap.reality.effects.effect import Effect
from tests.reality.hidden import world_of

SPECS = {
    "wheel_radius_mismatch": ("ratio",),
    "wheel_radius_scale": ("scale",),
    "wheel_separation": ("scale",),
    "command_latency": ("seconds",),
    "motor_lag": ("time_constant",),
    "weak_motor": ("torque",),
    "low_friction": ("friction",),
    "motor_saturation": ("limit", "wheel"),
    "motor_dead_zone": ("threshold", "wheel"),
    "speed_droop": ("rate",),
    "tracker_yaw_offset": ("angle",),
    "tracker_offset": ("x", "y"),
    "clock_offset": ("seconds",),
    "floor_tilt": ("slope", "direction"),
    "ir_gain": ("scale", "sensor"),
    "wall_albedo": ("scale",),
    "ir_dead_sensor": ("sensor",),
    "ir_rotation": ("angle",),
    "ir_offset": ("counts",),
    "ir_noise": ("scale",),
    "lamp_intensity": ("scale",),
    "lamp_height": ("height",),
    "light_falloff": ("exponent",),
    "lamp_moved": ("x", "y"),
    "ambient_light": ("level",),
    "second_lamp": ("x", "y", "intensity"),
    "lamp_decay": ("rate",),
    "light_gamma": ("exponent",),
    "ls_dead_sensor": ("sensor",),
    "nest_moved": ("x", "y"),
    "nest_radius": ("scale",),
}
OF_THE_PLACE = {
    "floor_tilt", "wall_albedo", "lamp_intensity", "lamp_height", "light_falloff", "lamp_moved",
    "ambient_light", "second_lamp", "lamp_decay",
}  # fmt: skip


def null_spec(effect: Effect) -> str | None:
    """The SPEC of an effect that changes nothing, if there is one."""
    numbers = {n: p for n, p in effect.parameters.items() if not p.words}
    if all(p.null is None for p in numbers.values()):
        return None
    values = ((name, 0.3 if p.null is None else p.null) for name, p in numbers.items())
    return f"{effect.name}:" + ",".join(f"{name}={value}" for name, value in values)


def numbers_after(steps: int, *specs: str) -> tuple[np.ndarray, ...]:
    """Everything a run can show after some steps of three robots in a lit arena."""
    world = world_of(3, *specs, seed=7)
    world.light.set_scenario(2)
    commands = np.array([[5.0, 3.0], [-4.0, 4.0], [6.0, 6.0]])
    for step in range(steps):
        world.sense()
        world.read_encoders()
        world.tracker.locate(np.zeros(3, dtype=np.uint8))
        world.act(commands * (1.0 if step < steps // 2 else -0.7))
    world.close()
    tracker = world.tracker
    return (
        world.poses, tracker.poses, tracker.on_nest, tracker.on_food, world.infrared.counts,
        world.light.counts, world.encoders.speeds,
    )  # fmt: skip


def test_the_catalogue_has_these_effects_with_these_keys() -> None:
    assert {name: tuple(e.parameters) for name, e in catalogue().items()} == SPECS
    assert {name for name, e in catalogue().items() if not e.per_robot} == OF_THE_PLACE


@pytest.mark.usefixtures("engine")
@pytest.mark.parametrize("name", sorted(SPECS))
def test_a_null_value_changes_no_bit(name: str) -> None:
    spec = null_spec(catalogue()[name])
    if spec is None:
        assert name in ("motor_saturation", "ir_dead_sensor", "ls_dead_sensor")
        return
    for found, nominal in zip(numbers_after(30, spec), numbers_after(30), strict=True):
        assert (found == nominal).all()


@pytest.mark.usefixtures("engine")
@pytest.mark.parametrize(
    "spec",
    [
        "command_latency:seconds=0.1",
        "motor_lag:time_constant=0.1",
        "motor_saturation:limit=2",
        "tracker_offset:x=0.01",
        "clock_offset:seconds=0.1",
        "ir_noise:scale=5",
        "light_gamma:exponent=1.5",
        "nest_moved:x=-0.3",
    ],
)
def test_robots_without_the_effect_keep_every_bit(spec: str) -> None:
    spared = [0, 2]
    for found, nominal in zip(numbers_after(30, f"{spec},robot=1"), numbers_after(30), strict=True):
        assert (found[spared] == nominal[spared]).all()


@pytest.mark.parametrize("name", sorted(OF_THE_PLACE))
def test_an_effect_of_the_place_belongs_to_no_robot(name: str) -> None:
    spec = (null_spec(catalogue()[name]) or "") + ",robot=1"
    with pytest.raises(InputError, match="belongs to the place"):
        parse_effects((spec,), 3)


@pytest.mark.parametrize(
    "spec",
    [
        "wheel_radius_scale",
        "wheel_radius_scale:scale=9",
        "wheel_radius_scale:scale=nan",
        "wheel_radius_scale:scale=1.1,scale=1.2",
        "wheel_radius_scale:size=1.1",
        "wheel_radius:scale=1.1",
        "wheel_radius_scale:scale=1.1,robot=3",
        "motor_saturation:limit=4,wheel=front",
        "ir_gain:scale=2,sensor=8",
        "command_latency:seconds=-0.1",
        "clock_offset:0.1",
    ],
)
def test_a_spec_that_cannot_be_used_is_refused(spec: str) -> None:
    with pytest.raises(InputError, match="--effect"):
        parse_effects((spec,), 3)
