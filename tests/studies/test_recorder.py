"""What is written of each control step, and when the world answers a swarm."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim.genome import PAPER
from realitygap.reality import constants as k
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.run.experiment import _forage
from realitygap.studies.run.recorder import Recorder

ROBOTS = 3


def world() -> Any:
    """Numbers that are all different, in place of a world."""
    number = iter(range(1, 1000))

    def filled(*shape: int) -> np.ndarray:
        return np.array([next(number) for _ in range(int(np.prod(shape)))], float).reshape(shape)

    flags = np.zeros((2, ROBOTS), dtype=np.uint8)
    flags[0, 0] = flags[1, 1] = 1
    return SimpleNamespace(
        read_encoders=lambda: None,
        tracker=SimpleNamespace(
            poses=filled(ROBOTS, 3),
            on_food=flags[0],
            on_nest=flags[1],
            locate=lambda carrying: None,
        ),
        encoders=SimpleNamespace(speeds=filled(ROBOTS, 2)),
        infrared=SimpleNamespace(counts=filled(ROBOTS, 8)),
        light=SimpleNamespace(counts=filled(ROBOTS, 8)),
        poses=filled(ROBOTS, 3),
    )


def test_every_column_of_a_sample_is_what_its_name_says(tmp_path: Path) -> None:
    seen = world()
    swarm: Any = SimpleNamespace(
        commands=np.array([[1.5, 2.5], [3.5, 4.5], [5.5, 6.5]]), generations=[], deposits=[]
    )
    with Recorder(tmp_path, "light-at-nest", "run", ROBOTS, True, engine="pybullet") as recorder:
        recorder.sample(2, seen, swarm, 2)
        recorder.finish(swarm, PAPER)
    found = pd.read_parquet(tmp_path / "samples.parquet")
    assert found["t"].tolist() == pytest.approx([0.08] * ROBOTS)
    for names, numbers in (
        (["x", "y", "yaw"], seen.tracker.poses),
        (["cmd_left", "cmd_right"], swarm.commands),
        (["wheel_left", "wheel_right"], seen.encoders.speeds),
        ([f"ps{i}" for i in range(8)], seen.infrared.counts),
        ([f"ls{i}" for i in range(8)], seen.light.counts),
    ):
        np.testing.assert_array_equal(found[names].to_numpy(float), numbers)
    assert found["food"].tolist() == [True, False, False]
    assert found["nest"].tolist() == [False, True, False]
    assert set(found["case"]) == {"light-at-nest"}


def test_taken_food_is_replaced_and_messages_are_sent_five_times_a_second() -> None:
    seen = world()
    replaced: list[int] = []
    sent: list[int] = []
    heard: list[int] = []
    seen.replace_food = replaced.append
    seen.radio = SimpleNamespace(heard=None, exchange=lambda poses, active: sent.append(1))
    swarm: Any = SimpleNamespace(
        carrying=None,
        active=None,
        picked=np.zeros(ROBOTS, dtype=np.uint8),
        step=lambda *_: None,
        hear=lambda _, now: heard.append(now),
    )
    for step in range(50):
        swarm.picked[:] = step == 7, 0, step in (7, 9)
        _forage(step, seen, swarm)
    assert replaced == [0, 2, 2]
    assert len(sent) == round(50 * 0.04 / k.RADIO_PERIOD)
    assert heard[:3] == [0, 5, 10]


def test_what_fails_leaves_nothing_behind_and_what_was_there_as_it_was(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with whole_directory(out) as part:
        (part / "run.json").write_text("first")
    holds = ("run.json",)
    with (  # noqa: PT012
        pytest.raises(RuntimeError),
        whole_directory(out, force=True, holds=holds) as part,
    ):
        (part / "run.json").write_text("second")
        raise RuntimeError
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (out / "run.json").read_text() == "first"


def test_a_run_without_samples_keeps_measured_positions_once_a_second(tmp_path: Path) -> None:
    seen = world()
    swarm: Any = SimpleNamespace(commands=np.zeros((ROBOTS, 2)), generations=[], deposits=[])
    with Recorder(tmp_path, "light-at-nest", "run", ROBOTS, False, engine="pybullet") as recorder:
        for step in range(51):
            seen.tracker.poses[0, 0] = 0.0123456 + step
            recorder.sample(step, seen, swarm, 2)
        recorder.finish(swarm, PAPER)
    found = pd.read_parquet(tmp_path / "positions.parquet")
    assert found["t"].tolist() == np.repeat([0.0, 1.0, 2.0], ROBOTS).tolist()
    assert found["robot"].tolist() == list(range(ROBOTS)) * 3
    first = found[found["robot"] == 0]
    np.testing.assert_allclose(first["x"], [0.012, 25.012, 50.012], atol=1e-5)
    np.testing.assert_allclose(found["y"], np.tile(seen.tracker.poses[:, 1], 3), atol=1e-5)
    assert not (tmp_path / "samples.parquet").exists()
