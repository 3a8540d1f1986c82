"""What a robot carries on its board: the C point model, the controller, and their evolution."""

from embedded_sim.behaviour import Behaviour
from embedded_sim.errors import InputError
from embedded_sim.model import (
    CONTROL_STEP,
    SCENARIOS,
    SENSOR_ANGLES,
    SENSORS,
    Drive,
    PointModel,
    Tables,
)
from embedded_sim.simulator import (
    TRIAL_SECONDS,
    Diverged,
    Evaluation,
    Readings,
    Replay,
    evaluate,
    readings,
    replay,
)

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
    "Tables",
    "evaluate",
    "readings",
    "replay",
]
