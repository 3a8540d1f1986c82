"""The senses' half of a healthy reference, from the same logs as the motion's."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor

from realitygap.models.belief.senses import Belief
from realitygap.models.gap.sensor_gap import sensors_to_judge
from realitygap.models.log.held_out import parts
from realitygap.models.naming.channels.senses.robot import SenseLog
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.engine.health import Told
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.health.learned import told_by
from realitygap.models.naming.health.senses import SenseReference, make_sense_reference
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
    told = [one for one in pool.map(_told, [(log, model) for log in logs]) if one is not None]
    if not told:
        return None
    return make_sense_reference(told, model=model.name, command=command)


@one_thread
def _told(task: tuple[Source, Model]) -> Told | None:
    """What one healthy log's readings and answers say; None where it has no sensors."""
    log, model = task
    measured, point = read_logs(log, model.file), model.point()
    if not sensors_to_judge(measured, point):
        return None
    seen = SenseLog(measured, point, look(measured, point), of_log=parts(measured))
    base = [Belief(senses=point.senses)] * len(seen.robots)
    return told_by(seen.at(range(len(base)), base))
