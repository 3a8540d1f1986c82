"""The senses' half of a healthy reference, from the same logs as the motion's."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np

from realitygap.models.log import read_log
from realitygap.models.modelfile import ModelFile, find_model_file, load_model, read_model_file
from realitygap.models.senses.cause import Belief
from realitygap.models.senses.health import Healthy, healthy_log, inherent_of, make_sense_reference
from realitygap.models.senses.reference import INHERENT, SenseReference, with_inherent
from realitygap.models.senses.sight import Sight, look
from realitygap.models.sensor_gap import sensors_to_judge


def sense_reference_of(
    paths: Sequence[Path], model: str | None, pool: Executor, *, command: str
) -> SenseReference | None:
    """A healthy reference of the senses; None where the model or the logs have no sensors.

    Args:
        paths: Logs of healthy robots.
        model: File or name.
        pool: What works through the logs.
        command: What a user would type.

    Raises:
        InputError: a log or the model cannot be used.
    """
    believed = read_model_file(model)
    if believed.sensors is None:
        return None
    inherent = [one for one in pool.map(_inherent, [(p, model) for p in paths]) if one is not None]
    if not inherent:
        return None
    common = {
        name: float(np.median([one[name] for one in inherent if name in one]))
        for name in INHERENT
        if any(name in one for one in inherent)
    }
    tasks = [(path, model, common) for path in paths]
    healthy = [one for one in pool.map(_healthy, tasks) if one is not None]
    return make_sense_reference(healthy, common, model=believed.name, command=command)


def _sight(path: Path, model: str | None) -> Sight | None:
    """A log cut for the senses; None where it has none."""
    believed: ModelFile = read_model_file(find_model_file(model))
    point = load_model(model, sensors="declared")
    log = read_log(path, drive=believed.nominal_drive)
    return look(log, point) if sensors_to_judge(log, point) else None


def _inherent(task: tuple[Path, str | None]) -> dict[str, float] | None:
    sight = _sight(*task)
    return None if sight is None else inherent_of(sight, load_model(task[1], sensors="declared"))


def _healthy(task: tuple[Path, str | None, dict[str, float]]) -> Healthy | None:
    path, model, common = task
    sight = _sight(path, model)
    if sight is None:
        return None
    point = load_model(model, sensors="declared")
    return healthy_log(sight, point, with_inherent(Belief(senses=point.senses), common))
