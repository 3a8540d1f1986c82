"""A term with memory is told what came before, also in rows that nobody judges."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.senses.predicted import predict
from realitygap.models.naming.channels.senses.readings import Eye
from realitygap.models.naming.channels.senses.sight import Sight, look
from tests.models.naming.test_senses import CENTRES, MODEL, STEP, table

ROBOTS = len(CENTRES)
HEALTHY = Belief(senses=MODEL.senses)


@dataclass(frozen=True)
class Late:
    """What was read so many rows before, at first what is read first."""

    rows: int

    @property
    def reach(self) -> tuple[float, float]:
        return 0.0, STEP * (self.rows + 0.5)

    def __call__(self, counts: FloatArray, time: FloatArray) -> FloatArray:
        assert (np.diff(time) > 0.0).all()
        return counts[np.maximum(np.arange(len(counts)) - self.rows, 0)]


def sights() -> tuple[Sight, Sight]:
    """Of all rows of a log, and of one in seven."""
    log = make_log(table({}), drive=MODEL.drive)
    return look(log, MODEL), look(log, MODEL, most=len(log.t) // 7 + 1)


def remembering(rows: int) -> Belief:
    return replace(HEALTHY, memory=(Late(rows),))


def test_rows_that_are_thinned_out_are_remembered() -> None:
    whole, few = sights()
    beliefs = [remembering(5), HEALTHY, remembering(3), remembering(5)]
    of_whole, of_few = (predict(sight, MODEL, beliefs) for sight in (whole, few))
    assert len(few.time) < 0.2 * len(whole.time)
    for k in range(ROBOTS):
        mine, rows = few.rows_of(k), whole.rows_of(k)
        at = np.searchsorted(whole.time[rows], few.time[mine])
        np.testing.assert_allclose(of_few[mine], of_whole[rows][at], rtol=0, atol=1e-9)


def test_every_robot_remembers_its_own_run() -> None:
    whole, _ = sights()
    late, plain = (predict(whole, MODEL, [b] * ROBOTS) for b in (remembering(5), HEALTHY))
    for k in range(ROBOTS):
        mine = whole.rows_of(k)
        np.testing.assert_allclose(late[mine][5:], plain[mine][:-5], rtol=0, atol=1e-9)
        np.testing.assert_allclose(late[mine][:5], plain[mine][:1].repeat(5, 0), rtol=0, atol=1e-9)


def test_one_robots_rows_alone_are_told_the_same() -> None:
    _, few = sights()
    of_all = predict(few, MODEL, [remembering(5)] * ROBOTS)
    for k in range(ROBOTS):
        mine = Eye(few.of(k), MODEL).counts(remembering(5))
        np.testing.assert_allclose(mine, of_all[few.rows_of(k)], rtol=0, atol=1e-9)


def test_two_memories_act_one_after_the_other() -> None:
    whole, _ = sights()
    both = replace(HEALTHY, memory=(Late(2), Late(3)))
    found = predict(whole, MODEL, [both] * ROBOTS)
    np.testing.assert_allclose(found, predict(whole, MODEL, [remembering(5)] * ROBOTS), atol=1e-9)


def test_light_does_not_count_as_long_as_a_shadow_is_remembered() -> None:
    whole, _ = sights()
    free = np.ones_like(whole.free)
    free[100, [2, 8 + 2]] = False  # of an infrared and of a light sensor
    eye = Eye(replace(whole, free=free).of(0), MODEL)
    assert (eye.usable(HEALTHY) == eye.sight.free).all()
    lost = eye.sight.free & ~eye.usable(remembering(5))
    assert np.argwhere(lost).tolist() == [[row, 8 + 2] for row in range(101, 106)]
