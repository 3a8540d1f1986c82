"""The world as a whole, its capture protocol, and the grammar of what is hidden in it."""

from __future__ import annotations

import filecmp
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import Diverged
from realitygap.models import load_tables, save_tables
from realitygap.reality import constants as k
from realitygap.reality.capture import capture
from realitygap.reality.effects import catalogue, parse_effects
from realitygap.reality.engine import engine_class
from realitygap.reality.hardware import Hardware
from realitygap.reality.pybullet_engine import PybulletEngine, bullet
from realitygap.reality.world import World, scatter
from tests.reality.hidden import world_of

SHIPPED = Path(__file__).parents[2] / "models" / "belief" / "captured" / "epuck.npz"


def walls(world: World) -> float:
    return float(np.hypot(world.poses[:, 0], world.poses[:, 1]).max())


def upright(world: World) -> float:
    """Cosine of the largest tilt of a robot."""
    match world.engine:
        case PybulletEngine() as engine:
            bodies = [
                bullet.getBasePositionAndOrientation(body, engine._client)[1]
                for body in engine._bodies
            ]
            x, y = np.array(bodies)[:, :2].T
        case engine:
            x, y = engine._place[:, 4:6].T
    return float((1.0 - 2.0 * (x**2 + y**2)).min())


@pytest.mark.usefixtures("engine")
def test_robots_stay_in_the_arena_and_apart_when_driven_into_everything() -> None:
    world = world_of(10)
    random = np.random.default_rng(2)
    for step in range(400):
        world.sense()
        if step % 20 == 0:
            commands = random.uniform(-6.0, 6.0, (10, 2))
        world.act(commands)
    world.sense()
    assert walls(world) < k.ARENA_RADIUS - k.BODY_RADIUS + 2e-3
    apart = np.hypot(*(world.poses[:, None, :2] - world.poses[None, :, :2]).transpose(2, 0, 1))
    assert apart[~np.eye(10, dtype=bool)].min() > 2 * k.BODY_RADIUS - 2e-3
    assert upright(world) > math.cos(0.04)
    world.close()


@pytest.mark.usefixtures("engine")
def test_a_robot_pushes_another_along() -> None:
    start = np.array([[-0.2, 0.0, 0.0], [-0.1, 0.0, 0.0]])
    world = world_of(2, poses=start)
    for _ in range(50):
        world.sense()
        world.act(np.array([[5.0, 5.0], [2.0, 2.0]]))
    world.sense()
    moved, alone = world.poses[1, 0] - start[1, 0], 50 * k.CONTROL_STEP * 2.0 * k.WHEEL_RADIUS
    apart = np.hypot(*(world.poses[1, :2] - world.poses[0, :2]))
    world.close()
    assert moved > alone + 0.01
    assert apart == pytest.approx(2.0 * k.BODY_RADIUS, abs=2e-3)  # two steps of approach


def test_seven_items_are_always_present() -> None:
    world = World(3, np.random.SeedSequence(4))
    before = world.tracker.food.copy()
    world.tracker.item[:] = [2, -1, -1]
    world.replace_food(0)
    changed = (world.tracker.food != before).any(axis=1)
    world.close()
    assert changed.tolist() == [False, False, True, False, False, False, False]


@pytest.mark.usefixtures("engine")
def test_the_same_seed_gives_the_same_world_and_another_does_not() -> None:
    def trace(seed: int) -> list[float]:
        world = world_of(4, seed=seed)
        seen: list[float] = []
        for _ in range(20):
            world.sense()
            seen += [*world.infrared.counts.ravel(), *world.light.counts.ravel()]
            seen += [*world.tracker.poses.ravel()]
            world.act(np.full((4, 2), 5.0))
        world.close()
        return seen

    assert trace(1) == trace(1)
    assert trace(1) != trace(2)


@pytest.mark.usefixtures("engine")
def test_physics_that_leave_the_finite_numbers_are_reported_and_not_begun_anew() -> None:
    world = world_of(2, poses=np.array([[-0.2, 0.0, 0.0], [0.2, 0.0, 0.0]]))
    world.sense()
    world.act(np.array([[np.nan, np.nan], [1.0, 1.0]]))
    with pytest.raises(Diverged, match="step 1"):
        world.sense()
    world.close()


def test_an_engine_that_is_not_there_is_refused_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(InputError, match=r"--engine: got 'mujuco'.*mujoco"):
        engine_class("mujuco")
    monkeypatch.setattr("realitygap.reality.engine.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"--engine: got 'mujoco'.*\[mujoco\] to be installed"):
        engine_class("mujoco")


def test_more_robots_than_fit_are_refused() -> None:
    with pytest.raises(InputError, match="--robots: got 200"):
        scatter(200, np.random.default_rng(0))


def test_capturing_again_gives_the_shipped_tables_byte_for_byte(tmp_path: Path) -> None:
    again = tmp_path / "epuck.npz"
    save_tables(capture(np.random.SeedSequence(0)), again)
    assert filecmp.cmp(again, SHIPPED, shallow=False)


def test_the_captured_tables_follow_the_laws_they_were_captured_from() -> None:
    tables = load_tables(SHIPPED)
    distance = tables.ps_range * np.linspace(0.0, 1.0, tables.ps_counts.shape[1]) ** 2
    for sensor, contact in enumerate(k.IR_CONTACT_COUNTS):
        law = contact * (k.IR_OFFSET / (distance + k.IR_OFFSET)) ** 2
        # medians of 128 readings err by 2 %
        near = (law > 60.0) & (distance > 1e-3)
        relative = tables.ps_counts[sensor, near, -1] / law[near] - 1.0
        assert abs(relative.mean()) < 0.03
        assert np.abs(relative).max() < 0.08


@pytest.mark.parametrize(
    "spec",
    [
        "nothing_known:x=1",
        "wheel_radius_mismatch",
        "wheel_radius_mismatch:ratio=fast",
        "wheel_radius_mismatch:ratio=nan",
        "wheel_radius_mismatch:ratio=9",
        "wheel_radius_mismatch:ratio=1.1,ratio=1.2",
        "wheel_radius_mismatch:ratio=1.1,robot=10",
        "wheel_radius_mismatch:ratio=1.1,robot=-1",
        "wheel_radius_mismatch:ratio",
        "ir_dead_sensor:sensor=8",
        "",
    ],
)
def test_a_spec_that_means_nothing_is_refused(spec: str) -> None:
    with pytest.raises(InputError, match="--effect"):
        parse_effects([spec], 10)


def test_effects_change_only_the_robots_they_name() -> None:
    hardware = Hardware.nominal(4)
    for hidden in parse_effects(
        ["wheel_radius_mismatch:ratio=1.1,robot=2", "ir_dead_sensor:sensor=3,robot=0,robot=1"], 4
    ):
        hidden.hide(hardware)
    ratio = hardware.wheel_radius[:, 1] / hardware.wheel_radius[:, 0]
    assert ratio == pytest.approx([1.0, 1.0, 1.1, 1.0])
    assert hardware.wheel_radius.mean(axis=1) == pytest.approx(k.WHEEL_RADIUS)
    assert np.argwhere(hardware.ir_alive == 0.0).tolist() == [[0, 3], [1, 3]]


def test_every_effect_is_found_in_its_module_under_its_own_name() -> None:
    assert {"wheel_radius_mismatch", "ir_dead_sensor"} <= set(catalogue())
    for name, effect in catalogue().items():
        assert effect.apply.__module__.startswith("realitygap.reality.effects.")
        assert getattr(sys.modules[effect.apply.__module__], name) is effect
