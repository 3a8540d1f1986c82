"""Whose a cause or a law is: some robots by number, or all."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from realitygap.models.log.files import Refused

ROBOTS = 'robot numbers from 0, as in [3] or [1, 4], or "all"'


def whose(robots: Any) -> Any:
    """Robots as given, but for what names none, which is refused."""
    if robots == "all":
        return robots
    if isinstance(robots, str) or not isinstance(robots, Collection) or not robots:
        given = list(robots) if isinstance(robots, tuple) else robots
        raise Refused("", repr(given), ROBOTS)
    for robot in robots:
        if isinstance(robot, bool) or not isinstance(robot, int) or robot < 0:
            raise Refused("", repr(robot), ROBOTS)
    if len(set(robots)) < len(robots):
        raise Refused("", repr(list(robots)), "each robot once")
    return robots
