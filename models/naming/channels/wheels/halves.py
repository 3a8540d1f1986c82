"""The chain from a command to a pose, cut where the encoders are.

Before the cut stand motors and their controller. Behind it stand wheels, floor and tracker, whose
poses are then predicted from what the encoders counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.driven import with_changes
from realitygap.models.naming.channels.motion.tracks import Tracks


def before_the_encoders(cause: Cause) -> bool:
    """Whether a cause of motion acts between a command and the wheel: encoders show it."""
    plain = Motion()
    some = np.array([p.step if np.isfinite(p.null) else 1.0 for p in cause.parameters])
    given = np.ones(len(cause.given))
    changed = cause.change(plain, np.r_[cause.values(some), given], cause.variants[-1])
    actuated = replace(changed, drive=changed.wheels, encoder_drive=None)
    return _actuators(actuated) != _actuators(plain)


def _actuators(motion: Motion) -> tuple[Drive, float, tuple[float, float]]:
    """What acts before the encoders."""
    nominal = Drive()
    drive = with_changes(
        motion.drive, wheel_radius=nominal.wheel_radius, axle=nominal.axle, laws=()
    )
    return drive, motion.motor_delay, motion.wheel_gain


def driven_by_encoders(
    tracks: Tracks, believed: Sequence[Motion]
) -> tuple[Tracks, tuple[Motion, ...]]:
    """The tracks as if the encoders were the commands, and motions whose motors obey at once."""
    assert tracks.encoders is not None
    counted = pd.DataFrame(tracks.encoders).ffill().fillna(0.0).to_numpy()
    ahead = np.vstack([counted[1:], counted[-1:]])  # they give the mean speed since the row before
    ahead[tracks.start[1:] - 1] = counted[tracks.start[1:] - 1]
    free = []
    for motion in believed:
        d = motion.drive
        obeying = with_changes(
            Drive(),
            wheel_radius=d.wheel_radius,
            axle=d.axle,
            laws=d.laws,
            reach=d.reach,
            body=d.body,
        )
        free.append(replace(motion, drive=obeying, encoder_drive=None, motor_delay=0.0))
    told = replace(tracks, commands=np.ascontiguousarray(ahead), encoders=None, rolling=None)
    return told, tuple(free)
