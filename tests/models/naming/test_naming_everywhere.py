"""A cause is of one size in all parts of a log, or it is none."""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import replay
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.everywhere import uneven
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Where
from realitygap.models.naming.health.learned import NOBODY
from tests.models.naming.test_identify import HEALTHY, diagnosed, names, table, tracks
from tests.models.small import random_commands

STEP, ROWS = 0.04, 1500
SCALE = Term(causes()["wheel_radius_scale"], "")


def carpeted(seed: int, *, fast: float, slow: float, noise: float = 1.0) -> pd.DataFrame:
    """One robot's log whose wheels act as if of other sizes in fast motion and in slow."""
    commands = random_commands(np.random.default_rng(seed), ROWS)
    quick = np.abs(commands.mean(axis=1)) > np.median(np.abs(commands.mean(axis=1)))
    turned = commands * np.where(quick, fast, slow)[:, None]
    t = STEP * np.arange(ROWS)
    poses = replay(t, turned, [0, ROWS], np.zeros((1, 3)), drive=HEALTHY).poses
    off = np.random.default_rng(seed).normal(0, noise, poses.shape) * [5e-4, 5e-4, 5e-3]
    columns = dict(zip(("x", "y", "yaw"), (poses + off).T, strict=True))
    columns |= dict(zip(("cmd_left", "cmd_right"), commands.T, strict=True))
    return pd.DataFrame({"run": "a", "robot": 1, "t": t, **columns})


@cache
def where(fast: float, slow: float, noise: float = 1.0) -> Where | None:
    cut = tracks(carpeted(5, fast=fast, slow=slow, noise=noise))
    healthy = (Motion(drive=HEALTHY),)
    fitter = Fitter(Weighed(State(cut, healthy, tuple(robots_of(cut, healthy)), NOBODY)), 0)
    fit = fitter.fit((SCALE,), [np.zeros(1)])
    assert fit is not None
    return uneven(fitter, (SCALE,), fit.coordinates, SCALE)


def test_a_cause_that_is_only_there_in_fast_motion_is_uneven_by_as_much() -> None:
    found = where(1.04, 1.00)
    assert found is not None
    assert found.part == "speed"
    assert found.more > 0.5
    assert 0.0 < found.share <= 1.0


def test_one_that_is_less_there_is_uneven_the_other_way_round() -> None:
    found = where(1.02, 1.10)
    assert found is not None
    assert (found.part, found.more < 0.0) == ("speed", True)


@pytest.mark.parametrize("size", [0.97, 1.04, 1.1])
def test_a_cause_of_one_size_is_even(size: float) -> None:
    assert where(size, size) is None


def test_a_small_difference_is_no_other_cause_however_sure() -> None:
    assert where(1.050, 1.042, 0.1) is None


def test_a_large_difference_that_chance_may_have_made_is_none() -> None:
    assert where(1.04, 1.00, 30.0) is None


def test_what_would_have_to_be_of_two_sizes_is_not_named_but_unexplained() -> None:
    frame = table(31, {}, rows=ROWS)
    strange = carpeted(31, fast=1.03, slow=1.00)
    found = diagnosed(pd.concat([frame[frame["robot"] != 1], strange], ignore_index=True))
    assert names(found) == []
    assert [one.robots for one in found.unexplained] == [(1,)]
