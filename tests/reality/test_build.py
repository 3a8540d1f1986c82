"""Robots of one make differ by what is asked, and by nothing where nothing is asked."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.log.table_files import RECORDER
from realitygap.reality import constants as k
from realitygap.reality.arena import ForagingArena
from realitygap.reality.effects import parse_effects
from realitygap.reality.hardware import Build, Hardware
from realitygap.reality.world import World
from realitygap.studies.run.experiment import RunConfig, simulate
from realitygap.studies.run.settings import run_config

MANY = 4000


def drawn(robots: int = MANY, spread: float = 0.01, seed: int = 5) -> Build:
    return Build.drawn(robots, spread, np.random.SeedSequence(seed))


FACTORS = ("wheel_radius", "axle", "motor_torque", "ir_gain", "light_gain")


@pytest.mark.parametrize("part", FACTORS)
def test_factors_are_normal_about_one_with_the_spread_asked_for(part: str) -> None:
    values = getattr(drawn(), part).ravel()
    z = (values - 1.0) / 0.01
    assert abs(z.mean()) < 5.0 / np.sqrt(len(z))
    assert z.std() == pytest.approx(1.0, abs=5.0 / np.sqrt(2.0 * len(z)))
    assert np.mean(np.abs(z) < 1.0) == pytest.approx(0.683, abs=5.0 * 0.47 / np.sqrt(len(z)))


def test_markers_sit_off_by_the_spread_times_the_axle() -> None:
    marker = drawn().marker / (0.01 * k.AXLE)
    assert abs(marker.mean()) < 5.0 / np.sqrt(marker.size)
    assert marker.std() == pytest.approx(1.0, abs=5.0 / np.sqrt(2.0 * marker.size))


def test_no_two_parts_share_their_draws() -> None:
    build = drawn()
    columns = np.column_stack(
        [getattr(build, part).reshape(MANY, -1) for part in (*FACTORS, "marker")]
    )
    off = np.corrcoef(columns.T) - np.eye(columns.shape[1])
    assert np.abs(off).max() < 6.0 / np.sqrt(MANY)


def test_the_same_seed_builds_the_same_robots_and_twice_the_spread_twice_as_far_off() -> None:
    once, wide = drawn(10), drawn(10, 0.02)
    assert once.truth() == drawn(10).truth()
    assert wide.axle - 1.0 == pytest.approx(2.0 * (once.axle - 1.0))
    assert not np.array_equal(once.axle, drawn(10, seed=6).axle)


def test_without_a_spread_every_bit_stays() -> None:
    hardware, build = Hardware.nominal(5), drawn(5, 0.0)
    build.apply(hardware)
    nominal = Hardware.nominal(5)
    for name in ("wheel_radius", "axle", "motor_torque", "ir_amplitude", "light_gain", "markers"):
        assert getattr(hardware, name).tobytes() == getattr(nominal, name).tobytes()
    assert build.truth() == {}


def test_a_build_multiplies_what_is_there_also_what_is_hidden() -> None:
    hardware, build = Hardware.nominal(3), drawn(3)
    for spec in ("wheel_radius_scale:scale=1.1,robot=1", "tracker_offset:x=0.01,robot=2"):
        parse_effects((spec,), 3)[0].hide(hardware)
    build.apply(hardware)
    scale = np.array([[1.0], [1.1], [1.0]])
    assert hardware.wheel_radius == pytest.approx(k.WHEEL_RADIUS * scale * build.wheel_radius)
    assert hardware.axle == pytest.approx(k.AXLE * build.axle)
    assert hardware.motor_torque == pytest.approx(k.MOTOR_TORQUE * build.motor_torque)
    counts = np.array(k.IR_CONTACT_COUNTS) * k.IR_OFFSET**2
    assert hardware.ir_amplitude == pytest.approx(counts * build.ir_gain)
    assert hardware.light_gain == pytest.approx(build.light_gain)
    there = np.array([[0.0, 0.0], [0.0, 0.0], [0.01, 0.0]])
    assert hardware.markers[:, :2] == pytest.approx(there + build.marker)
    assert not hardware.markers[:, 2].any()


def test_a_robot_turns_as_its_own_wheels_and_axle_say() -> None:
    """Spins at equal and opposite wheel speeds: the turn rate is w (r_left + r_right) / axle."""
    build = drawn(3, 0.03, seed=2)
    start = np.array([[-0.3, 0.0, 0.0], [0.0, 0.0, 0.0], [0.3, 0.0, 0.0]])
    world = World(3, np.random.SeedSequence(1), poses=start, build=build)
    speed, seconds = 2.0, 1.0
    turned, before = np.zeros(3), start[:, 2].copy()
    for _ in range(round(seconds / k.CONTROL_STEP)):
        world.sense()
        turned += np.remainder(world.poses[:, 2] - before + np.pi, 2.0 * np.pi) - np.pi
        before = world.poses[:, 2].copy()
        world.act(np.array([[-speed, speed]] * 3))
    world.close()
    rate = speed * k.WHEEL_RADIUS * build.wheel_radius.sum(axis=1) / (k.AXLE * build.axle)
    assert turned / turned[0] == pytest.approx(rate / rate[0], rel=3e-3)
    assert np.ptp(rate) > 0.03 * rate[0]


def run(out: Path, **config: object) -> Path:
    out.mkdir()
    simulate(RunConfig(**{"minutes": 0.05, "robots": 3, "seed": 3, **config}), (), out)
    return out


TABLES = ("samples.parquet", "generations.parquet", "deposits.parquet", "truth.json")


def test_without_a_spread_a_run_is_what_it_was_byte_for_byte(tmp_path: Path) -> None:
    plain, zero = run(tmp_path / "a"), run(tmp_path / "b", build_spread=0.0)
    for name in TABLES:
        assert (plain / name).read_bytes() == (zero / name).read_bytes()
    assert json.loads((zero / "truth.json").read_text()) == {"effects": []}


def test_how_robots_are_built_is_in_the_truth_and_nowhere_else(tmp_path: Path) -> None:
    plain, built = run(tmp_path / "a"), run(tmp_path / "b", build_spread=0.01234)
    truth = json.loads((built / "truth.json").read_text())
    assert truth["effects"] == []
    assert truth["build"]["spread"] == 0.01234
    assert [one["robot"] for one in truth["build"]["robots"]] == [0, 1, 2]
    first = truth["build"]["robots"][0]
    assert {name: np.size(first[name]) for name in (*FACTORS, "marker")} == {
        "wheel_radius": 2, "axle": 1, "motor_torque": 1, "ir_gain": 8, "light_gain": 8, "marker": 2,
    }  # fmt: skip
    before, after = (pd.read_parquet(one / "samples.parquet") for one in (plain, built))
    assert not after["x"].equals(before["x"])
    assert list(after.columns) == list(before.columns)
    schema = pq.read_schema(built / "samples.parquet")
    assert schema.metadata == {RECORDER: b"reality pybullet"}
    assert schema.equals(pq.read_schema(plain / "samples.parquet"), check_metadata=True)
    assert b"0.01234" not in (built / "samples.parquet").read_bytes()


@pytest.mark.parametrize("spread", [-0.01, 0.2, float("nan")])
def test_a_spread_that_cannot_be_is_refused(spread: float) -> None:
    with pytest.raises(InputError, match="--build-spread: got"):
        run_config(build_spread=spread)


def test_robots_stay_within_the_wall_of_the_arena_that_is_asked_for(tmp_path: Path) -> None:
    for radius in (0.5, 0.8):
        out = run(tmp_path / str(radius), arena_radius=radius, minutes=1.0, controller="search")
        samples = pd.read_parquet(out / "samples.parquet")
        furthest = np.hypot(samples["x"], samples["y"]).max()
        assert radius - k.BODY_RADIUS - 0.05 < furthest < radius - k.BODY_RADIUS + 0.005


def seen_from_near_the_wall(radius: float) -> float:
    """Median counts of a front sensor 3 cm from the wall, whose head is towards it."""
    pose = np.array([[radius - k.BODY_RADIUS - 0.03, 0.0, 0.0]])
    world = World(1, np.random.SeedSequence(1), poses=pose, arena=ForagingArena(radius))
    counts = []
    for _ in range(200):
        world.sense()
        counts.append(world.infrared.counts[0, 0])
    world.close()
    return float(np.median(counts))


def test_the_wall_is_seen_where_it_stands() -> None:
    nominal = seen_from_near_the_wall(k.ARENA_RADIUS)
    assert nominal > 100.0
    for radius in (0.5, 0.8):
        assert seen_from_near_the_wall(radius) == pytest.approx(nominal, rel=0.05)
