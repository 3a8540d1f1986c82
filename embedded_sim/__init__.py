"""What a robot carries on its board: the C point model, the controller, and their evolution."""

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
