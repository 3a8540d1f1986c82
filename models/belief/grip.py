"""How fast a robot's wheels change speed: what weak motors and slipping wheels limit.

Nobody who has only a log knows newton metres or coefficients of friction. What a log tells is the
acceleration at which wheels change speed, and a healthy reference tells that of sound robots
(`health.inherent`). Both causes are told as a share of the latter.
"""

from __future__ import annotations

import math

import numpy as np

from realitygap.embedded_sim.model import FloatArray, Pair
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.motion import Motion

LEAST = 0.003
"""Share of a healthy acceleration, least believed: such a robot needs seconds to reach a speed."""
HEALTHY = Parameter(
    name="healthy_acceleration",
    unit="rad/s^2",
    null=math.inf,
    low=1.0,
    high=1e5,
    step=1.0,
)
"""Of a sound robot's wheels at a start. Bounds as of the inherent motion; infinite: such wheels
have no limit, and a share of it is none."""


def limits(motion: Motion, values: FloatArray) -> Pair:
    """rad/s^2: the wheels' acceleration limits at a share of the healthy ones.

    Args:
        motion: Whose own limits are the healthy ones, if it has any.
        values: The share, and the healthy limit to take where the motion has none.
    """
    share = float(values[0])
    left, right = motion.drive.acceleration
    if math.isinf(left) and len(values) > 1 and share < 1.0:
        left = right = float(values[1])
    return left * share, right * share


def told_against(healthy: Motion) -> FloatArray:
    """(1,) the acceleration that a share is of; infinite where nobody has measured it."""
    return np.array([min(healthy.drive.acceleration)])
