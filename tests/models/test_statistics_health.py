"""What healthy robots teach: their spread beyond fit error, and what a family of terms costs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.senses import health as senses
from realitygap.models.senses.reference import no_sense_reference
from realitygap.models.senses.structure_health import _band, of_healthy, pool

SWARMS, ROBOTS = 60, 10
TRUE_MEAN, TRUE_SD = 0.4, 0.5


def of_senses(value: FloatArray, error: FloatArray) -> tuple[float, float]:
    """Mean and spread of a term of the senses, of (swarms, robots)."""
    each = zip(value.ravel(), error.ravel(), strict=True)
    seen = [senses.Seen("a", False, np.array([v]), np.array([e]), 99.0) for v, e in each]
    mean, sd, *_ = senses._spread(seen)
    return mean[0], sd[0]


def of_levels(value: FloatArray, error: FloatArray) -> tuple[float, float]:
    """The same of a number of each robot, as of its noise."""
    level = senses._level(value.ravel(), error.ravel(), np.zeros(0))
    return level.mean, level.sd


def of_sense_structure(value: FloatArray, error: FloatArray) -> tuple[float, float]:
    """The same of a flexible term of the senses."""
    band = _band([np.stack(one, axis=1) for one in zip(value, error, strict=True)])
    assert band is not None
    return band.mean, band.sd


Learned = Callable[[FloatArray, FloatArray], tuple[float, float]]


@pytest.mark.parametrize("learned", [of_senses, of_levels, of_sense_structure])
def test_healthy_spread_is_what_robots_differ_by_beyond_what_fits_err_by(learned: Learned) -> None:
    random = np.random.default_rng(1)
    error = np.full((SWARMS, ROBOTS), 0.6)
    value = (
        TRUE_MEAN
        + TRUE_SD * random.normal(size=error.shape)
        + error * random.normal(size=error.shape)
    )
    mean, sd = learned(value, error)
    assert mean == pytest.approx(TRUE_MEAN, abs=0.1)
    assert sd == pytest.approx(TRUE_SD, rel=0.15)


def test_robots_pooled_weigh_by_how_sure_they_are() -> None:
    random = np.random.default_rng(3)
    error = np.array([0.1, 0.1, 1.0, 5.0])
    found = [pool(0.7 + error * random.normal(size=4), error) for _ in range(4000)]
    mean, told = np.array(found).T
    assert mean.mean() == pytest.approx(0.7, abs=0.01)
    assert mean.std() == pytest.approx(told[0], rel=0.05)
    assert told[0] == pytest.approx(1.0 / np.sqrt((1.0 / error**2).sum()))


def test_of_logs_that_are_alike_a_new_one_is_seldom_the_most_conspicuous() -> None:
    """Of n + 1 healthy logs each is as likely as another to hold the largest of all terms, however
    long the tails: one in n + 1 may pass the gate that n have set, whatever the family's size."""
    random = np.random.default_rng(4)
    logs, new, terms = 12, 120, 40

    def log() -> dict[str, FloatArray]:
        rows = random.standard_t(2.0, (terms, ROBOTS))
        return {f"t{k}": np.stack([one, np.full(ROBOTS, 0.05)], 1) for k, one in enumerate(rows)}

    structure, joint = of_healthy([log() for _ in range(logs)])
    update = {"robots": 120, "structure": structure, "joint": joint}
    known = no_sense_reference("toy").model_copy(update=update)

    def passes(one: dict[str, FloatArray]) -> bool:
        return any(
            (
                np.abs(rows[:, 0] - structure[key].mean) / np.hypot(rows[:, 1], structure[key].sd)
                > known.structure_gate(key, swarm=False)
            ).any()
            for key, rows in one.items()
        )

    assert np.mean([passes(log()) for _ in range(new)]) < 3.0 / (logs + 1)
