"""What a robot carries on its board: the C point model, the controller, and their evolution."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from realitygap.embedded_sim.behaviour import Behaviour
    from realitygap.embedded_sim.errors import Diverged, InputError
    from realitygap.embedded_sim.model import (
        CONTROL_STEP,
        SCENARIOS,
        SENSOR_ANGLES,
        SENSORS,
        Drive,
        PointModel,
    )
    from realitygap.embedded_sim.senses import Senses
    from realitygap.embedded_sim.simulator import (
        TRIAL_SECONDS,
        Evaluation,
        Readings,
        Replay,
        evaluate,
        readings,
        replay,
    )
    from realitygap.embedded_sim.tables import Tables

_WHERE = {
    "Behaviour": "behaviour",
    "CONTROL_STEP": "model",
    "Diverged": "errors",
    "Drive": "model",
    "Evaluation": "simulator",
    "InputError": "errors",
    "PointModel": "model",
    "Readings": "simulator",
    "Replay": "simulator",
    "SCENARIOS": "model",
    "SENSORS": "model",
    "SENSOR_ANGLES": "model",
    "Senses": "senses",
    "TRIAL_SECONDS": "simulator",
    "Tables": "tables",
    "evaluate": "simulator",
    "readings": "simulator",
    "replay": "simulator",
}
"""Module of each name: imported when it is asked for, so that an error's name costs no numpy."""

__all__ = [
    "CONTROL_STEP",
    "SCENARIOS",
    "SENSORS",
    "SENSOR_ANGLES",
    "TRIAL_SECONDS",
    "Behaviour",
    "Diverged",
    "Drive",
    "Evaluation",
    "InputError",
    "PointModel",
    "Readings",
    "Replay",
    "Senses",
    "Tables",
    "evaluate",
    "readings",
    "replay",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(importlib.import_module(f"{__name__}.{_WHERE[name]}"), name)
    globals()[name] = found
    return found
