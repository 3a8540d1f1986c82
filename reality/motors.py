"""What happens to a command on its way to the wheels, from a delay to a lag.

Robots with nothing hidden in this chain get their commands as they are, once per control step. For
the others a joint's target in a physics step is the mean, over that step, of the speed that the
chain asks for, and a command that arrives within the step has the motor's torque for what is left
of it: wheels turn as far as they should however a delay falls between two steps.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality.engine import Engine
from realitygap.reality.hardware import FloatArray, Hardware

SUBSTEPS = round(k.CONTROL_STEP / k.PHYSICS_STEP)
"""Physics steps per control step."""

_TIE = 1e-9
"""control steps: a delay of whole steps must not be split by rounding."""


class Motors:
    """The motors of a swarm."""

    def __init__(self, hardware: Hardware) -> None:
        self._torque = hardware.motor_torque.tolist()
        self._driven: FloatArray = np.full((hardware.robots, 2), np.nan)
        touched = (
            (hardware.command_delay > 0.0)
            | (hardware.motor_lag > 0.0)
            | (hardware.droop != 0.0)
            | (hardware.motor_gain != 1.0).any(axis=1)
            | (hardware.speed_limit < np.inf).any(axis=1)
            | (hardware.turn_first < np.inf)
            | (hardware.start_delay > 0.0)
            | (hardware.slew_limit < np.inf)
            | (hardware.dead_zone > 0.0).any(axis=1)
            | (hardware.laws.wheels is not None)
        )
        self._law = hardware.laws.wheels
        self._angles: FloatArray = np.zeros((hardware.robots, 2))
        self._chained = np.flatnonzero(touched)
        self._plain = ~touched
        self._share: FloatArray = np.ones(len(self._chained))
        self.chain = Chain(hardware, self._chained) if touched.any() else None

    def command(self, engine: Engine, commands: FloatArray) -> None:
        """Take the wheel speeds (robots, 2) in rad/s of a control step."""
        changed = (commands != self._driven).any(axis=1) & self._plain
        for i in np.flatnonzero(changed).tolist():
            left, right = commands[i].tolist()
            engine.drive(i, left, right, self._torque[i])
        if self.chain is None:
            self._driven[:] = commands
            return
        self._driven[self._plain] = commands[self._plain]
        self.chain.push(commands[self._chained])

    def drive(self, engine: Engine, substep: int, poses: FloatArray) -> None:
        """Set the joints' targets for one physics step of robots whose chain is not plain."""
        if self.chain is None:
            return
        targets, share = self.chain.targets(substep)
        if self._law is not None:
            targets = self._law(targets, self._angles, poses, self.chain.now(substep))
            self._angles += targets * k.PHYSICS_STEP
        changed = (targets != self._driven[self._chained]).any(axis=1) | (share != self._share)
        self._driven[self._chained], self._share = targets, share
        for n in np.flatnonzero(changed).tolist():
            robot = int(self._chained[n])
            left, right = targets[n].tolist()
            engine.drive(robot, left, right, share[n] * self._torque[robot])


class Chain:
    """The chain of some robots, as arrays with a row per robot; a physics step has two parts.

    Within a physics step of 10 ms at most one new command, sent every 40 ms, arrives at a motor:
    the part before it obeys the older command, the part after it the newer. Where it falls depends
    on the delay alone and is the same in every control step.
    """

    def __init__(self, hardware: Hardware, robots: npt.NDArray[np.intp]) -> None:
        self._limit, self._dead = hardware.speed_limit[robots], hardware.dead_zone[robots]
        self._droop, self._gain = hardware.droop[robots, None], hardware.motor_gain[robots]
        self._start_delay = hardware.start_delay[robots, None]
        self._released: FloatArray = np.zeros((len(robots), 2))
        """s from which on each wheel turns the way it was last told to, if it still is."""
        self._way: FloatArray = np.zeros((len(robots), 2))
        self._slew_limit = hardware.slew_limit[robots, None]
        self._ramp: FloatArray = np.zeros((len(robots), 2))
        """rad/s that the ramps have come to."""
        self._turn_first = hardware.turn_first[robots]
        self._rows = np.arange(len(robots))
        delay = hardware.command_delay[robots]
        starts = k.PHYSICS_STEP * np.arange(SUBSTEPS)[:, None]
        back = np.floor((starts - delay) / k.CONTROL_STEP + _TIE)
        arrival = (back + 1.0) * k.CONTROL_STEP + delay - starts
        older = np.clip(arrival, 0.0, k.PHYSICS_STEP)
        older[k.PHYSICS_STEP - older < _TIE * k.CONTROL_STEP] = k.PHYSICS_STEP
        self._slot = np.stack([back, np.minimum(back + 1.0, 0.0)], axis=1).astype(np.intp)
        """(substeps, 2, n): control steps before the present one."""
        self._span = np.stack([older, k.PHYSICS_STEP - older], axis=1)[..., None]
        """(substeps, 2, n, 1) s."""
        lag = hardware.motor_lag[robots, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            left = np.exp(-self._span / lag)
        self._left = np.where(self._span > 0.0, np.where(lag > 0.0, left, 0.0), 1.0)
        """(substeps, 2, n, 1): share of the way to the target that is still to go after a part."""
        self._slip = lag * (1.0 - self._left)
        """(substeps, 2, n, 1) s: part of that way not turned meanwhile."""
        self._quick = hardware.motor_lag[robots] == 0.0
        self._queue: FloatArray = np.zeros((1 - int(self._slot.min()), len(robots), 2))
        self._newest = -1
        self._speed: FloatArray = np.zeros((len(robots), 2))

    def push(self, commands: FloatArray) -> None:
        """A control step begins with commands (n, 2) in rad/s."""
        self._newest += 1
        self._queue[self._newest % len(self._queue)] = self._shaped(commands)

    def _shaped(self, commands: FloatArray) -> FloatArray:
        """Commands (n, 2) as a controller passes them on that turns before it drives."""
        left, right = commands.T
        most = self._turn_first
        ahead, turn = 0.5 * (left + right), np.clip(0.5 * (right - left), -most, most)
        room = most - np.abs(turn)
        ahead = np.clip(ahead, -room, room)
        within = np.maximum(np.abs(left), np.abs(right)) <= most
        shaped = np.column_stack([ahead - turn, ahead + turn])
        return np.where(within[:, None], commands, shaped)

    def now(self, substep: int) -> float:
        """s since the battery was full."""
        return self._newest * k.CONTROL_STEP + substep * k.PHYSICS_STEP

    def targets(self, substep: int) -> tuple[FloatArray, FloatArray]:
        """Mean speeds (n, 2) in rad/s asked for in a physics step, and share (n,) of the torque."""
        now = self.now(substep)
        turned: FloatArray = np.zeros_like(self._speed)
        at = (self._newest + self._slot[substep]) % len(self._queue)
        older, newer = self._queue[at, self._rows]
        switched = (older != newer).any(axis=1) & self._quick & (self._span[substep, 1, :, 0] > 0.0)
        for part, command in enumerate((older, newer)):
            span = self._span[substep, part]
            asked = self._answer(command, now) * self._free(command, now, span)
            asked = self._ramped(asked, span)
            now += span
            away = self._speed - asked
            turned += asked * span + away * self._slip[substep, part]
            self._speed = asked + away * self._left[substep, part]
        share = np.where(switched, self._span[substep, 1, :, 0] / k.PHYSICS_STEP, 1.0)
        return turned / k.PHYSICS_STEP, share

    def _free(self, command: FloatArray, now: float | FloatArray, span: FloatArray) -> FloatArray:
        """Share (n, 2) of a part that wheels are not held: those that start are, for a while."""
        way = np.sign(command)
        self._released = np.where(way != self._way, now + self._start_delay, self._released)
        self._way = way
        held = np.clip(self._released - now, 0.0, span)
        return 1.0 - np.divide(held, span, out=np.zeros_like(held), where=span > 0.0)

    def _ramped(self, asked: FloatArray, span: FloatArray) -> FloatArray:
        """Mean speeds (n, 2) of a part in which ramps go towards what is asked for."""
        limited = self._slew_limit < np.inf
        most = np.where(limited, self._slew_limit, 0.0) * span
        away = asked - self._ramp
        step = np.where(limited, np.clip(away, -most, most), away)
        share = np.divide(np.abs(step), most, out=np.zeros_like(step), where=most > 0.0)
        """Of the part, until the ramp ends; 1 where it does not."""
        self._ramp = self._ramp + step
        return np.where(limited, self._ramp - 0.5 * share * step, asked)

    def _answer(self, command: FloatArray, now: float | FloatArray) -> FloatArray:
        """Speeds (n, 2) that motors without inertia would reach at a time (s)."""
        speed = np.abs(command)
        speed[speed < self._dead] = 0.0
        np.minimum(speed, self._limit, out=speed)
        speed *= self._gain * np.maximum(1.0 - self._droop * now, 0.0)
        return np.copysign(speed, command)
