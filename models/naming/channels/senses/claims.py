"""What may be said of the senses: which names are exported, and what that gains in readings.

As for motion (`motion.claims`), readings of one part of the log are predicted by a model file whose
values the other part gave. Errors are mean absolute ones, in counts, over the readings that
`claims.prediction` judges; of the nest they are answers predicted wrongly. `ir_noise`, which
changes no reading but how much readings scatter, is exported if the scatter of either part lies
nearer to that of the other than to a healthy robot's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, PointModel, Tables
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.extended import as_written
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.senses import Belief
from realitygap.models.log.blocks import Better, better, interval
from realitygap.models.log.frames import Rows
from realitygap.models.log.held_out import PARTS
from realitygap.models.naming.channels.motion.claims import bounded
from realitygap.models.naming.channels.motion.fitted import Values
from realitygap.models.naming.channels.senses.diagnose import SenseExamination
from realitygap.models.naming.channels.senses.nest import Answers
from realitygap.models.naming.channels.senses.predicted import noise, predict
from realitygap.models.naming.channels.senses.sight import Sight
from realitygap.models.naming.claims.harm import harmless, robots_of
from realitygap.models.naming.claims.prediction import judged_readings
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Gain, Unexplained
from realitygap.models.naming.findings import Named
from realitygap.models.naming.rules import Rules

READINGS = {"infrared_reading": "ps", "light_reading": "ls"}
"""Of `gain` in `diagnosis.json`, the kind of sensor that each is of."""
MEAN_SIZE = (2.0 / math.pi) ** 0.5
"""Mean size of a standard normal variable. No rule: of statistics."""
NEST = "nest_answer"
NOISE = "ir_noise"


class SensePredictions:
    """What models with some of the named causes in the senses predict, as `claims.harm` asks."""

    useless = "seen, but the model with it predicts readings no better: not exported"

    def __init__(
        self,
        senses: SenseExamination,
        model: ModelFile,
        named: Sequence[Named],
        tables: Tables | None,
    ) -> None:
        self.senses, self.model, self.named = senses, model, named
        self.by_part: tuple[Values, ...] = senses.by_part
        plain = model.model_copy(update={"extension": None})
        self.point: PointModel = plain.point_model(tables)
        sight = senses.sight
        self.judged: dict[str, npt.NDArray[np.bool_]] = {}
        if sight is not None:
            expected = predict(
                sight, self.point, [Belief(senses=self.point.senses)] * len(sight.robots)
            )
            self.judged = judged_readings(sight.free & np.isfinite(sight.read), expected)
        self._counts: dict[tuple[int, frozenset[int]], FloatArray] = {}

    @staticmethod
    def harms(keys: Sequence[str]) -> str:
        """Why a cause is not exported, in words."""
        words = " and ".join(k.split("_")[0] for k in keys)
        return f"seen, but the model with it predicts {words} worse: not exported"

    def belief(self, robot: int, causes: frozenset[int], part: int) -> Belief:
        """What the model file with some causes that judges a part has a robot believe."""
        values = self.by_part[1 - part]
        mine = [self.named[k] for k in sorted(causes) if robot in self.named[k].robots]
        file = self.model
        if mine:
            file = as_written(file, [written(one, values[one.key]) for one in mine])
        return Belief() if file.extension is None else file.extension.sensed(robot)

    def read(self, robot: int, causes: frozenset[int]) -> FloatArray:
        """(rows of the robot, 16) size of the errors of readings."""
        sight = self.senses.sight
        assert sight is not None
        mine = frozenset(k for k in causes if robot in self.named[k].robots)
        if (robot, mine) not in self._counts:
            index = sight.robots.index(robot)
            rows = sight.rows_of(index)
            counts = np.zeros((rows.stop - rows.start, 2 * SENSORS))
            beliefs = [Belief()] * len(sight.robots)
            for part in range(PARTS):
                beliefs[index] = self.belief(robot, mine, part)
                told = predict(sight, self.point, beliefs, [index])[rows]
                counts = np.where((sight.part[rows] == part)[:, None], told, counts)
            self._counts[robot, mine] = np.abs(sight.read[rows] - counts)
        return self._counts[robot, mine]

    def sizes(self, robots: Sequence[int], causes: frozenset[int], name: str) -> FloatArray:
        """(readings or answers,) errors of some robots."""
        if name == NEST:
            return self._wrong(robots, causes)
        each = [half(self.read(robot, causes), name)[self.use(robot, name)] for robot in robots]
        return np.concatenate([np.zeros(0), *each])

    def block(self, robots: Sequence[int], name: str) -> Rows:
        """(the same,) block of time of each."""
        if name == NEST:
            answers, part = self._answers()
            rows = np.isin(answers.robot, robots)
            return answers.block[rows] * PARTS + part[rows]
        sight = self.senses.sight
        assert sight is not None
        found = []
        for robot in robots:
            mine = sight.rows_of(sight.robots.index(robot))
            both = sight.block[mine] * PARTS + sight.part[mine]
            use = self.use(robot, name)
            found.append(np.broadcast_to(both[:, None], use.shape)[use])
        return np.concatenate([np.zeros(0, dtype=np.int64), *found])

    def compare(
        self, robots: Sequence[int], before: frozenset[int], after: frozenset[int]
    ) -> dict[str, Better]:
        """By key, how much better readings of robots are predicted with other causes."""
        found = {}
        for name in self.keys:
            less, more = (self.sizes(robots, causes, name) for causes in (before, after))
            one = better(less, more, self.block(robots, name))
            if one is not None:
                found[name] = one
        scatter = self._scatter(robots, after - before, before - after)
        return found | scatter

    @property
    def keys(self) -> list[str]:
        """What can be judged."""
        names = [name for name, kind in READINGS.items() if kind in self.judged]
        return names + ([NEST] if self.senses.answers is not None else [])

    def use(self, robot: int, name: str) -> npt.NDArray[np.bool_]:
        """(rows of the robot, 8) readings that are judged."""
        sight = self.senses.sight
        assert sight is not None
        return self.judged[READINGS[name]][sight.rows_of(sight.robots.index(robot))]

    def _answers(self) -> tuple[Answers, Rows]:
        assert self.senses.answers is not None
        return self.senses.answers, self.senses.answers_part

    def _wrong(self, robots: Sequence[int], causes: frozenset[int]) -> FloatArray:
        """(answers,) 1 where the virtual sensor's answer about the nest is predicted wrongly."""
        answers, part = self._answers()
        wrong = np.zeros(len(answers.robot))
        for robot in robots:
            for k in range(PARTS):
                these = (answers.robot == robot) & (part == k)
                x, y, radius = self.belief(robot, causes, k).of(self.point).nest
                away = answers.place[these] - [x, y]
                wrong[these] = (np.hypot(away[:, 0], away[:, 1]) < radius) != answers.inside[these]
        return wrong[np.isin(answers.robot, robots)]

    def _scatter(
        self, robots: Sequence[int], added: frozenset[int], taken: frozenset[int]
    ) -> dict[str, Better]:
        """Whether noise that is named or not makes the scatter of readings nearer."""
        changed = [
            k
            for k in added | taken
            if self.named[k].term.cause.name == NOISE and set(self.named[k].robots) & set(robots)
        ]
        keys = [self.named[k].key for k in changed]
        told = [[part[key][0].value for key in keys if key in part] for part in self.by_part]
        if not keys or any(len(one) < len(keys) for one in told):
            return {}
        one, other = np.log(told)
        far, near = float(np.mean(np.abs([one, other]))), float(np.mean(np.abs(one - other)))
        nearer = near < min(float(np.mean(np.abs(one))), float(np.mean(np.abs(other))))
        if changed[0] in taken:
            nearer, far, near = not nearer, near, far
        return {
            "scatter_of_infrared": Better(float(1.0 - near / max(far, 1e-12)), float(not nearer))
        }


def half(errors: FloatArray, name: str) -> FloatArray:
    """(rows, 8) of infrared or light, out of (rows, 16)."""
    return errors[:, :SENSORS] if READINGS[name] == "ps" else errors[:, SENSORS:]


def sense_claims(
    senses: SenseExamination,
    model: ModelFile,
    tables: Tables | None,
    rules: Rules = Rules(),
    *,
    seed: int,
) -> tuple[tuple[Named, ...], tuple[Unexplained, ...], dict[str, Gain]]:
    """Names with whether they are exported, what ended at a bound, and the gain in readings."""
    inside, ended = bounded(senses.named)
    predictions = SensePredictions(senses, model, inside, tables)
    refused = harmless(predictions, rules)
    named = tuple(
        replace(one, exported=k not in refused, why=refused.get(k, ""))
        for k, one in enumerate(inside)
    )
    exported = frozenset(range(len(named))) - refused.keys()
    rng = np.random.default_rng(seed)
    return named, ended, _gains(predictions, named, exported, rng)


def _gains(
    predictions: SensePredictions,
    named: Sequence[Named],
    exported: frozenset[int],
    rng: np.random.Generator,
) -> dict[str, Gain]:
    """By key, errors of the readings of the robots whose causes are exported, or of all.

    What healthy robots leave is known of light alone: beside a wall infrared is off by much more
    now and then, and how often no reference says.
    """
    sight = predictions.senses.sight
    if sight is None:
        return {}
    robots = robots_of([named[k] for k in sorted(exported)], sight.robots)
    sound = _sound(predictions, sight)
    result = {}
    for name in READINGS:
        before = predictions.sizes(robots, frozenset(), name)
        if not len(before):
            continue
        after = predictions.sizes(robots, exported, name)
        low, high = interval(after, predictions.block(robots, name), rng)
        healthy = None
        if sound is not None and READINGS[name] == "ls":
            rows = [sight.rows_of(sight.robots.index(robot)) for robot in robots]
            each = [
                half(sound[r], name)[predictions.use(robot, name)]
                for robot, r in zip(robots, rows, strict=True)
            ]
            healthy = float(np.concatenate(each).mean())
        result[name] = Gain(
            before=float(before.mean()),
            after=float(after.mean()),
            low=low,
            high=high,
            healthy=healthy,
            unit="counts",
        )
    return result


def _sound(predictions: SensePredictions, sight: Sight) -> FloatArray | None:
    """(rows, 16) mean size of the minimal model's errors of a healthy robot that was at the same
    places, as its noise leaves them; None: nobody knows."""
    reference = predictions.senses.reference
    if reference is None or not reference.robots:
        return None
    point = predictions.point
    minimal = [Belief(senses=point.senses)] * len(sight.robots)
    size = MEAN_SIZE * noise(sight, point, minimal, predict(sight, point, minimal))
    return np.asarray(size)
