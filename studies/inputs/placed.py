"""A log's poses as they lie in the arena of a model."""

from __future__ import annotations

from realitygap.embedded_sim.tables import Tables
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.repertoire import manoeuvres
from realitygap.models.naming.frame import in_the_models_frame
from realitygap.models.naming.health.reference import shipped_reference, world_of


def placed(log: MeasuredLog, file: ModelFile, tables: Tables | None) -> MeasuredLog:
    """A log in the frame of the model's arena, with a note where it had another.

    Logs that were recorded as those of the shipped healthy reference lie there already.

    Args:
        log: Measured.
        file: What the simulator believes.
        tables: Captured, of the model; None: its sensors are not modelled.
    """
    world = world_of(log.recorder)
    healthy = shipped_reference(file.name, world=world, manoeuvres=manoeuvres(log))
    alike = healthy is not None and healthy.recorded_like(log.recorder, log.step)
    return in_the_models_frame(log, file, tables, alike=alike)[0]
