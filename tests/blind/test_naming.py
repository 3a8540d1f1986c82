"""Effects are hidden in reality; a process that has the log and nothing else must name them.

The short tests hide several effects at once, each in a robot of its own: what a robot has must be
named for it and for no other.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from realitygap.reality.effects import catalogue
from realitygap.studies.blind.examiner import LOG, ask
from realitygap.studies.blind.record import record
from realitygap.studies.blind.scoring import Score, named, score
from realitygap.studies.blind.trials import Hidden, Trial
from realitygap.studies.hidden.menu import MENU, STRANGE
from realitygap.studies.run.experiment import RunConfig

ROBOTS = 10


def told(
    *hidden: Hidden, seed: int, seconds: float = 120.0, withheld: tuple[str, ...] = ()
) -> tuple[Trial, dict[str, Any]]:
    """A run with this hidden in it, and what a process given its log alone answers."""
    config = RunConfig(
        case="light-at-nest",
        controller="search" if seed % 2 else "coevolution",
        minutes=seconds / 60.0,
        robots=ROBOTS,
        seed=seed,
    )
    trial = Trial(0, "single", seconds, config, hidden)
    with tempfile.TemporaryDirectory(prefix="log-") as given:
        record(config, trial.specs, Path(given) / LOG)
        answer, error = ask(Path(given), withheld)
    assert answer is not None, error
    return trial, answer


def hide(name: str, robot: int, **values: float | str) -> Hidden:
    return Hidden(name, values, (robot,), 0.0, 1.5)


def check(trial: Trial, answer: dict[str, Any]) -> Score:
    """The score, with what was said where it is not all right."""
    found = score(trial, answer)
    said = [(c.name, sorted(c.robots), c.rivals) for c in named(answer, ROBOTS)]
    missed = [h.name for h, hit in zip(trial.hidden, found.right, strict=True) if not hit]
    assert not found.wrong, f"wrong: {found.wrong}; said {said}"
    assert not found.accused, f"said {said}"
    assert not missed, f"missed: {missed}; said {said}, verdict {answer['verdict']}"
    return found


def test_five_robots_with_five_faults_of_geometry_and_mounting_are_told_apart() -> None:
    check(
        *told(
            hide("wheel_radius_mismatch", 1, ratio=1.015),
            hide("wheel_radius_scale", 3, scale=0.985),
            hide("wheel_separation", 5, scale=1.015),
            hide("tracker_yaw_offset", 7, angle=-0.026),
            hide("tracker_offset", 8, x=0.0015, y=0.0),
            seed=501,
        )
    )


@pytest.mark.slow
def test_five_robots_with_five_faults_of_motors_are_told_apart() -> None:
    check(
        *told(
            hide("command_latency", 0, seconds=0.06),
            hide("motor_lag", 2, time_constant=0.05),
            hide("motor_saturation", 4, limit=5.2, wheel="left"),
            hide("speed_droop", 6, rate=2.5e-4),
            hide("low_friction", 9, friction=0.1),
            seed=505,
        )
    )


@pytest.mark.slow
def test_what_no_catalogue_lists_is_called_unexplained_by_what_it_follows() -> None:
    lossy = hide("speed_loss", 2, share=0.06)
    eccentric = hide("eccentric_wheel", 6, share=0.1, wheel="left")
    trial, answer = told(lossy, eccentric, seed=507)
    assert answer["verdict"] == "unexplained"
    followed = {tuple(one["robots"]): one["quantity"] for one in answer["unexplained"]}
    assert set(followed) == {(2,), (6,)}
    for one in trial.hidden:
        assert followed[one.robots] in STRANGE[one.name].follows.split()
    assert not score(trial, answer).accused


@pytest.mark.slow
def test_a_lamp_that_stands_somewhere_else_altogether_is_found() -> None:
    moved = Hidden("lamp_moved", {"x": -1.0, "y": 0.4}, (), 1.08, 108.0)
    assert all(check(*told(moved, seed=506)).inside)


def test_a_healthy_swarm_is_told_so() -> None:
    trial, answer = told(seed=503)
    assert answer["verdict"] == "nothing_wrong"
    assert check(trial, answer).healthy == ROBOTS


@pytest.mark.blind
@pytest.mark.parametrize("seed", [601, 602])
@pytest.mark.parametrize("name", sorted(n for n in MENU if n not in ("floor_tilt",)))
def test_each_effect_is_named_alone_at_one_and_a_half_times_its_bar(name: str, seed: int) -> None:
    entry = MENU[name]
    random = np.random.default_rng(seed)
    size = min(1.5 * entry.bar, entry.largest)
    alone = catalogue()[name].per_robot and not name.startswith("nest")  # one robot: rarely there
    robots = (int(random.integers(ROBOTS)),) if alone else ()
    hidden = Hidden(name, dict(entry.values(size, random)), robots, size, 1.5)
    check(*told(hidden, seed=seed))


@pytest.mark.blind
@pytest.mark.parametrize("seed", range(700, 710))
def test_healthy_swarms_are_told_so(seed: int) -> None:
    trial, answer = told(seed=seed)
    assert answer["verdict"] == "nothing_wrong"
    check(trial, answer)


@pytest.mark.blind
@pytest.mark.parametrize("seed", range(710, 714))
def test_a_tilted_floor_gets_no_wrong_name(seed: int) -> None:
    tilt = Hidden("floor_tilt", {"slope": 0.035, "direction": float(seed % 3)}, (), 0.035, 1.0)
    trial, answer = told(tilt, seed=seed)
    assert not score(trial, answer).wrong
