"""Whether a log can be of the robot that is assumed when nobody says which it is."""

from __future__ import annotations

import numpy as np

from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.tracker import MOST_WILD


def unlike(log: MeasuredLog, assumed: ModelFile) -> str:
    """What the assumed robot could not have done, in one sentence; empty: nothing.

    Args:
        log: The measured log.
        assumed: The model that was taken because none was given.
    """
    seen = []
    if assumed.arena is not None and log.tracked.any():
        out = np.hypot(*log.poses[log.tracked, :2].T) > assumed.arena.radius
        if out.mean() > MOST_WILD:
            wall = f"beyond the wall of its arena ({assumed.arena.radius:g} m)"
            seen.append(f"{100 * out.mean():.0f} % of the poses lie {wall}")
    fast = np.abs(log.commands).max(axis=1) > assumed.robot.wheel_speed_max
    if fast.mean() > MOST_WILD:
        most = f"faster than its motors turn ({assumed.robot.wheel_speed_max:g} rad/s)"
        seen.append(f"{100 * fast.mean():.0f} % of the commands are {most}")
    if not seen:
        return ""
    return (
        f"No --model was given, and the {assumed.name} is assumed; but {' and '.join(seen)}: "
        "give the robot's model (`realitygap model new` writes one)"
    )
