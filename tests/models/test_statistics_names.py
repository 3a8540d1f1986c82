"""From fits to names: distances from health, and rivals."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.tracks import BLOCK_WINDOWS
from realitygap.models.identify.value import values
from realitygap.models.naming.verdict import _margin
from realitygap.models.senses import diagnose as sense_diagnosis
from realitygap.models.senses import naming, select
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.problem import SWARM, Term
from realitygap.models.senses.reference import Level, away, no_sense_reference
from realitygap.models.senses.select import Found
from tests.models.toys import SenseToy, motion_term, sense_term, tracks

NO_COMMANDS = np.ones((1, 2))
BLOCKS, ROWS = 10, 10


def patterns(number: int) -> FloatArray:
    """(number, 1, BLOCKS, ROWS, 1) columns that share nothing, alike in every block."""
    rows = np.linalg.qr(np.random.default_rng(0).normal(size=(ROWS, number)))[0].T
    return np.broadcast_to(rows[:, None, None, :, None], (number, 1, BLOCKS, ROWS, 1)).copy()


def test_a_reading_is_as_far_from_health_as_fit_and_healthy_spread_together_have_it() -> None:
    random = np.random.default_rng(2)
    mean, sd, error = np.array([1.0]), np.array([0.4]), np.array([0.3])
    far = [away(mean + 0.5 * random.normal(size=1), error, mean, sd) for _ in range(4000)]
    assert (np.array(far) > 1.96).mean() == pytest.approx(0.05, abs=0.012)
    none = np.zeros(1)
    assert away(np.array([9.0]), none, mean, sd) == 0.0, "what did not move says nothing"


def test_an_interval_holds_the_part_though_this_robot_differs_in_it_as_sound_robots_do() -> None:
    random = np.random.default_rng(3)
    truth, mean, sd, error = 0.7, 0.2, 0.3, 0.4
    motion, sense = motion_term("a"), sense_term("a")
    held = np.zeros(2)
    for _ in range(2000):
        value = np.array([truth + mean + sd * random.normal() + error * random.normal()])
        (told,) = values(
            motion, value, np.array([[error**2]]), NO_COMMANDS, np.array([mean]), np.array([sd])
        )
        found = Found(
            term=sense,
            coordinates=value,
            error=np.array([error]),
            gain=99.0,
            share=0.5,
            distance=9.0,
        )
        known = no_sense_reference("toy").model_copy(
            update={"terms": {"a": _sense_health(mean, sd)}}
        )
        (named,) = naming.fitted_named([found], (0,), known)
        for k, one in enumerate((told, named.values[0])):
            held[k] += one.low <= truth <= one.high
            assert one.low < one.value < one.high
    assert held / 2000 == pytest.approx(0.95, abs=0.015)


def _sense_health(mean: float, sd: float) -> Any:
    of_offset = no_sense_reference("toy").terms["ir_offset"]
    return of_offset.model_copy(
        update={"mean": (mean,), "sd": (sd,), "swarm_mean": (mean,), "swarm_sd": (sd,)}
    )


EVEN = np.ones(BLOCKS) / BLOCKS
UNEVEN = np.array([0.5, 0.5, *[0.0] * (BLOCKS - 2)])
"""Shares of a whole, by block."""


def of_motion(lost: FloatArray, gain: float) -> bool:
    """Whether motion calls a rival worse by a (blocks,) deviance; `gain` is the cause's own."""
    cut = tracks(1, BLOCKS, ROWS)
    change = np.repeat(lost / BLOCK_WINDOWS, BLOCK_WINDOWS)
    assert change.sum() == pytest.approx(lost.sum())
    return bool(lost.sum() > _margin(change, cut, 0, gain))


def of_senses(lost: FloatArray, gain: float) -> bool:
    """The same of the senses, whose rule knows no gain."""
    fit = SenseToy(np.zeros((1, BLOCKS, ROWS)), {}).fit((), np.zeros(0))
    return select._worse(replace(fit, held_out=fit.held_out + lost), fit)


@pytest.mark.parametrize("worse", [of_motion, of_senses])
def test_a_rival_is_worse_by_odds_of_twenty_to_one_and_not_by_less(worse: Any) -> None:
    assert worse(12.0 * EVEN, 900.0)
    assert not worse(3.0 * EVEN, 900.0)
    assert not worse(-12.0 * EVEN, 900.0)


@pytest.mark.parametrize("worse", [of_motion, of_senses])
def test_what_a_rival_loses_must_be_clear_of_its_scatter_from_block_to_block(worse: Any) -> None:
    sides = np.array([1.0, -1.0])
    hardly_known = np.array([20.0, 20.0, *np.tile(20.0 * sides, 4)])
    well_known = 4.0 + 1.6 * np.tile(sides, 5)
    assert hardly_known.sum() == well_known.sum() == pytest.approx(40.0)
    assert not worse(hardly_known, 900.0)
    assert worse(well_known, 900.0)


def test_a_fifth_of_a_causes_gain_is_missed_however_few_blocks_it_is_lost_in() -> None:
    assert of_motion(40.0 * UNEVEN, 150.0)
    assert not of_motion(40.0 * UNEVEN, 900.0)


def test_one_that_can_bend_further_is_no_rival_for_fitting_as_well() -> None:
    one, two = patterns(2)
    y = 3.0 * one[..., 0] + 0.05 * np.random.default_rng(6).normal(size=one.shape[:3])
    problem = SenseToy(y, {"plain": one, "again": one, "bent": np.concatenate([one, two], axis=3)})
    plain, again, bent = sense_term("plain"), sense_term("again"), sense_term("bent", 2)
    tried = {plain: 100.0, again: 100.0, bent: 100.0}
    less = problem.fit((), np.zeros(0))

    def rivals(term: Term) -> set[Term]:
        kept = problem.fit((term,), np.zeros(term.size))
        return set(select._rivals(problem, kept, less, term, tried))

    assert rivals(plain) == {again}
    assert rivals(bent) == {plain, again}


@pytest.mark.parametrize(
    ("told", "error", "name", "rivals"),
    [
        (0.0, 0.01, "wall_albedo", ()),
        (0.2, 0.01, "ir_gain", ()),
        (0.05, 0.15, "wall_albedo", ("ir_gain",)),
        (0.15, 0.15, "ir_gain", ("wall_albedo",)),
        (np.nan, np.inf, "wall_albedo", ("ir_gain",)),
    ],
)
def test_what_other_robots_return_tells_the_wall_from_the_sensors(
    monkeypatch: pytest.MonkeyPatch, told: float, error: float, name: str, rivals: tuple[str, ...]
) -> None:
    """All infrared reads a share more before the wall. If it does before robots, too, it is the
    sensors; if robots return what they did, the wall."""
    monkeypatch.setattr(sense_diagnosis, "of_robots", lambda *_: (told, error))
    monkeypatch.setattr(sense_diagnosis, "predict", lambda *_: np.zeros((1, 16)))
    problem: Any = SenseToy(np.zeros((1, 1, 10)), {})
    problem.model = None
    fit = problem.fit((), np.zeros(0))
    healthy = no_sense_reference("toy").model_copy(update={"targets": Level()})
    for first in ("wall_albedo", "ir_gain"):
        variant = sense_causes()[first].variants[0]
        one = Found(
            term=Term(sense_causes()[first], variant, SWARM),
            coordinates=np.array([0.2]),
            error=np.array([0.005]),
            gain=99.0,
            share=0.5,
            distance=9.0,
        )
        found = sense_diagnosis._wall_or_sensors(one, problem, fit, healthy)
        assert found.term.cause.name == name
        assert tuple(t.cause.name for t in found.rivals) == rivals
