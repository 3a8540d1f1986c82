"""Leave-one-out: an effect of the catalogue is hidden, and the diagnosis must do without its cause.

Every effect becomes an unknown, of which everything else is known. `FOLLOWS` says which measured
quantities such an unknown follows, by its physics; it was written down before any of it was tried.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from realitygap.studies.blind.limits import share
from realitygap.studies.blind.scoring import Score
from realitygap.studies.blind.trials import Trial

FOLLOWS: Mapping[str, frozenset[str]] = {
    name: frozenset(quantities.split())
    for name, quantities in {
        # motion: a constant fault of geometry grows with how fast the robot drives or turns
        "wheel_radius_mismatch": "always speed",
        "wheel_radius_scale": "always speed",
        "wheel_separation": "always turning",
        "command_latency": "change",
        "motor_lag": "change",
        "weak_motor": "change",
        "low_friction": "change",
        "motor_saturation": "speed speed_squared turning",
        "motor_dead_zone": "speed turning",
        "speed_droop": "time",
        "tracker_yaw_offset": "always speed",
        "tracker_offset": "turning",
        "clock_offset": "change",
        "floor_tilt": "heading",
        # infrared: all readings of a sensor, or of what it looks at
        "ir_gain": "always level sensor",
        "wall_albedo": "always level",
        "ir_dead_sensor": "sensor",
        "ir_rotation": "bearing",
        "ir_offset": "always",
        "ir_noise": "noise",
        # light: what falls with distance is also smaller where little is read
        "lamp_intensity": "always level",
        "lamp_height": "distance level",
        "light_falloff": "distance level",
        "lamp_moved": "bearing place point",
        "ambient_light": "always level",
        "second_lamp": "heading place point",
        "lamp_decay": "time",
        "light_gamma": "always level distance",
        "ls_dead_sensor": "sensor",
        # task
        "nest_moved": "bearing",
        "nest_radius": "distance",
    }.items()
}
"""By effect: keys of `quantity` in `diagnosis.json`, any of which is right."""


def quantity_right(
    follows: frozenset[str], trial: Trial, diagnosis: Mapping[str, Any] | None
) -> bool:
    """Whether what is said to be unexplained, of robots that have it, follows the right thing."""
    robots = {robot for one in trial.hidden for robot in one.robots}
    return any(
        one.get("quantity") in follows
        for one in (() if diagnosis is None else diagnosis.get("unexplained", ()))
        if one.get("robots", "all") == "all" or not robots or robots & set(one["robots"])
    )


def unknowns(scored: Sequence[tuple[Score, bool]]) -> dict[str, Any]:
    """How effects without a name fare: (score, whether the quantity is right) of each."""
    return {
        "flagged_unexplained": _share([s.verdict == "unexplained" for s, _ in scored]),
        "wrong_name_alone": _share(
            [bool(s.wrong) and s.verdict != "unexplained" for s, _ in scored]
        ),
        "quantity_right": _share([right for _, right in scored]),
    }


def _share(flags: Sequence[bool]) -> dict[str, float | int | None]:
    return share(sum(flags), len(flags))
