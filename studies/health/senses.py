"""The senses' half of a healthy reference, from the same logs as the motion's."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor

import numpy as np

from realitygap.models.senses.cause import Belief
from realitygap.models.senses.health import Healthy, healthy_log, inherent_of, make_sense_reference
from realitygap.models.senses.reference import INHERENT, SenseReference, with_inherent
from realitygap.models.senses.sight import Sight, look
from realitygap.models.sensor_gap import sensors_to_judge
from realitygap.studies.inputs.logs import Source, read_logs
from realitygap.studies.inputs.model import Model


def sense_reference_of(
    logs: Sequence[Source], model: Model, pool: Executor, *, command: str
) -> SenseReference | None:
    """A healthy reference of the senses; None where the model or the logs have no sensors.

    Args:
        logs: Of healthy robots.
        model: What is believed of them.
        pool: What works through the logs.
        command: What a user would type.

    Raises:
        InputError: a log cannot be used.
    """
    if model.tables is None:
        return None
    found = pool.map(_inherent, [(log, model) for log in logs])
    inherent = [one for one in found if one is not None]
    if not inherent:
        return None
    common = {
        name: float(np.median([one[name] for one in inherent if name in one]))
        for name in INHERENT
        if any(name in one for one in inherent)
    }
    tasks = [(log, model, common) for log in logs]
    healthy = [one for one in pool.map(_healthy, tasks) if one is not None]
    return make_sense_reference(healthy, common, model=model.name, command=command)


def _sight(log: Source, model: Model) -> Sight | None:
    """A log cut for the senses; None where it has none."""
    measured, point = read_logs(log, model.file), model.point()
    return look(measured, point) if sensors_to_judge(measured, point) else None


def _inherent(task: tuple[Source, Model]) -> dict[str, float] | None:
    sight = _sight(*task)
    return None if sight is None else inherent_of(sight, task[1].point())


def _healthy(task: tuple[Source, Model, dict[str, float]]) -> Healthy | None:
    log, model, common = task
    sight, point = _sight(log, model), model.point()
    if sight is None:
        return None
    return healthy_log(sight, point, with_inherent(Belief(senses=point.senses), common))
