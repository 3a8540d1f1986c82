"""A log without its loudest window: nothing may be believed on one window's word.

A window in which something happened once, a touch, a lost command or a tracker's slip, can speak as
loudly for a cause as all others speak for none. Its noise has long tails, but not at any distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows
from realitygap.models.naming.engine.state import State


def without_loudest(state: State, scope: int, change: FloatArray) -> State:
    """The state without the window of a scope that says most.

    Args:
        state: With all windows.
        scope: Whose windows.
        change: (windows,) squares that each gives, member after member.
    """
    loudest = int(np.argmax(change))
    robots = list(state.robots)
    for k in state.members(scope):
        many = len(robots[k].block)
        if 0 <= loudest < many:
            robots[k] = robots[k].without(loudest)
        loudest -= many
    return replace(state, robots=tuple(robots))


def of_a_moment(state: State, scope: int, change: FloatArray) -> FloatArray:
    """(windows,) squares that each gives; 0 where a window stands for many moments, as a level of
    noise does, and happens not once."""
    block = np.concatenate([state.robots[k].block for k in state.members(scope)])
    return np.where(block >= 0, change, 0.0)


def given(
    state: State, scope: int, columns: Rows | Sequence[int], coefficients: FloatArray
) -> FloatArray:
    """(windows,) squares that columns take off each window, member after member.

    Args:
        state: With the robots at what is believed of them.
        scope: Whose windows.
        columns: (q,) which.
        coefficients: (q,) of them.
    """
    found = []
    for k in state.members(scope):
        robot = state.robots[k]
        errors = robot.own_errors
        told = [
            c * np.sum(robot.by_run(at), axis=0)
            for at, c in zip(columns, coefficients, strict=True)
        ]
        found.append(robot.by_window(errors**2 - (errors - np.sum(told, axis=0)) ** 2))
    return of_a_moment(state, scope, np.concatenate(found))
