"""What a robot carries on its board: the C point model, the controller, and their evolution."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from realitygap.embedded_sim.behaviour import Behaviour as Behaviour
    from realitygap.embedded_sim.errors import Diverged as Diverged
    from realitygap.embedded_sim.errors import InputError as InputError
    from realitygap.embedded_sim.model import CONTROL_STEP as CONTROL_STEP
    from realitygap.embedded_sim.model import SCENARIOS as SCENARIOS
    from realitygap.embedded_sim.model import SENSOR_ANGLES as SENSOR_ANGLES
    from realitygap.embedded_sim.model import SENSORS as SENSORS
    from realitygap.embedded_sim.model import Drive as Drive
    from realitygap.embedded_sim.model import PointModel as PointModel
    from realitygap.embedded_sim.senses import Senses as Senses
    from realitygap.embedded_sim.simulator import TRIAL_SECONDS as TRIAL_SECONDS
    from realitygap.embedded_sim.simulator import Evaluation as Evaluation
    from realitygap.embedded_sim.simulator import Readings as Readings
    from realitygap.embedded_sim.simulator import Replay as Replay
    from realitygap.embedded_sim.simulator import evaluate as evaluate
    from realitygap.embedded_sim.simulator import readings as readings
    from realitygap.embedded_sim.simulator import replay as replay
    from realitygap.embedded_sim.tables import Tables as Tables

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

__all__ = sorted(_WHERE)


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(importlib.import_module(f"{__name__}.{_WHERE[name]}"), name)
    globals()[name] = found
    return found
