"""The catalogue as a whole: nulls that change nothing, robots that are spared."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.reality.effects import catalogue, parse_effects
from realitygap.reality.effects.effect import Effect
from realitygap.studies.hidden.menu import MENU
from tests.reality.hidden import world_of

EFFECTS = catalogue()
OF_THE_PLACE = sorted(name for name, effect in EFFECTS.items() if not effect.per_robot)


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


def large_spec(name: str) -> str:
    """The SPEC of an effect at four times what the battery must find, in robot 1."""
    entry = MENU[name]
    values = entry.values(min(4.0 * entry.bar, entry.largest), np.random.default_rng(1))
    return f"{name}:" + ",".join(f"{key}={value}" for key, value in values.items()) + ",robot=1"


@pytest.mark.usefixtures("engine")
@pytest.mark.parametrize("spec", [s for s in map(null_spec, EFFECTS.values()) if s])
def test_a_null_value_changes_no_bit(spec: str) -> None:
    for found, nominal in zip(numbers_after(30, spec), numbers_after(30), strict=True):
        assert (found == nominal).all()


@pytest.mark.usefixtures("engine")
@pytest.mark.parametrize("name", [n for n in MENU if n in EFFECTS and n not in OF_THE_PLACE])
def test_robots_without_the_effect_keep_every_bit(name: str) -> None:
    spared = [0, 2]
    found, nominal = numbers_after(30, large_spec(name)), numbers_after(30)
    for one, other in zip(found, nominal, strict=True):
        assert (one[spared] == other[spared]).all()


@pytest.mark.parametrize("name", OF_THE_PLACE)
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
