"""How a robot is believed to move and to be seen: what the causes change.

A `Motion` is the point model's drive and what lies between the robot and the tracker's numbers. The
catalogue's causes are functions from one motion to another, so that any set of them can be tried.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from realitygap.embedded_sim import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """One robot's motion and how it is measured; the defaults are the minimal model, seen truly."""

    drive: Drive = field(default_factory=Drive)
    """From commands to the robot's motion over the floor."""
    encoder_drive: Drive | None = None
    """From commands to the wheels' own speeds where these differ, as in slip; None: `drive`."""
    wheel_gain: tuple[float, float] = (1.0, 1.0)
    """How far the left and the right wheel turn, over what their commands ask for. What the robot
    drives for it is in `drive` already; the encoders see it too."""
    motor_delay: float = 0.0
    """s by which motors answer later than `drive.latency` says; negative: earlier."""
    pose_delay: float = 0.0
    """s by which poses are stamped late; negative: early."""
    clock_rate: float = 0.0
    """s by which the stamps of poses come later per s since the log began; negative: earlier."""
    smear: float = 0.0
    """s^2, variance of the times over which a pose is an average."""
    pose_lag: float = 0.0
    """s, time constant of a causal first-order filter that poses went through."""
    pose_scale: float = 1.0
    """Measured distances over true ones."""
    yaw_offset: float = 0.0
    """rad, measured yaw minus the robot's."""
    lever: tuple[float, float] = (0.0, 0.0)
    """m ahead and to the left of the axle's middle, where the tracker sees the robot."""

    @property
    def wheels(self) -> Drive:
        """What the encoders follow."""
        return self.drive if self.encoder_drive is None else self.encoder_drive

    def driving(self, **changes: Any) -> Motion:
        """The motion with some of its drive's fields changed."""
        return replace(self, drive=replace(self.drive, **changes))
