"""The on-board programs of a swarm: controllers, clocks, fitness, what was heard.

One array per property with a row per robot; each robot still has its own clock and random streams.
Between generations a control step is one call into C.
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import is_not
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim._core import ffi, lib
from realitygap.embedded_sim.behaviour import Behaviour
from realitygap.embedded_sim.binding import array, check, memory, refusal
from realitygap.embedded_sim.breeding import POPULATION, Bred, Breeder
from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.genome import CHOICES
from realitygap.embedded_sim.model import CONTROL_STEP, SENSORS, FloatArray
from realitygap.embedded_sim.simulator import TRIAL_SECONDS

GENERATION_STEPS = round(60.0 / CONTROL_STEP)
"""Control steps of a generation: 60 s of a robot's own clock (III-H)."""

Flags = npt.NDArray[np.uint8]


@dataclass(frozen=True, kw_only=True)
class Generation:
    """What a robot's log says of one generation, written when it closes."""

    robot: int
    generation: int
    start_step: int
    end_step: int
    s0: float
    """Of the pair broadcast; NaN for a fixed controller."""
    genome: tuple[float, ...]
    """G0, G1 and what continuous genes there are."""
    fitness_sim: float
    """s, of the running controller when it was bred; NaN for a fixed controller."""
    fitness_real: float
    """s, eq. 1 on the generation's own clock."""
    deposits: int
    heard: int
    """Other robots whose pair was compared."""


class Swarm:
    """All robots' on-board programs, stepped together."""

    def __init__(
        self,
        seed: np.random.SeedSequence,
        *,
        breeder: Breeder,
        behaviour: Behaviour,
        start_steps: npt.NDArray[np.int64],
    ) -> None:
        """Robots that are switched on at their start steps.

        Args:
            seed: For the controllers' streams.
            breeder: Co-evolution or a fixed controller.
            behaviour: The controller's constants.
            start_steps: (robots,) control step at which each robot is started by hand.

        Raises:
            InputError: there is no robot, or the start steps are no whole numbers.
        """
        start_steps = array("start_steps", start_steps, np.int64, (None,))
        robots = len(start_steps)
        if not robots:
            raise InputError("start_steps", "no robots", "at least one")
        self.robots, self._breeder, self._behaviour = robots, breeder, behaviour
        self.commands: FloatArray = np.zeros((robots, 2))
        """rad/s, left and right."""
        self.picked: Flags = np.zeros(robots, dtype=np.uint8)
        self.dropped: Flags = np.zeros(robots, dtype=np.uint8)
        self.carrying: Flags = np.zeros(robots, dtype=np.uint8)
        self.active: Flags = np.zeros(robots, dtype=np.uint8)
        self.deposits: list[tuple[int, int, int, int]] = []
        """(robot, step, step of pick-up, generation) of every deposit."""
        self.generations: list[Generation] = []
        self.generation = np.full(robots, -1, dtype=np.int64)
        self._genomes: FloatArray = np.zeros((robots, CHOICES))
        self._behaviours = ffi.new("rg_behaviour[]", [behaviour.struct[0]] * robots)
        self._bred: list[Bred] = [Bred((0.0, 0.0), 0.0, 0.0)] * robots
        self._opened = start_steps.astype(np.int64)
        self._due = start_steps.astype(np.int64)
        self._next_due = int(self._due.min())
        self._pickup = np.zeros(robots, dtype=np.int64)
        self._fitness: FloatArray = np.zeros(robots)
        self._count = np.zeros(robots, dtype=np.int64)
        self._s0: FloatArray = np.full(robots, np.nan)
        self._heard_s0: FloatArray = np.zeros((robots, robots))
        self._heard_fitness: FloatArray = np.zeros((robots, robots))
        self._heard_step = np.full((robots, robots), -1, dtype=np.int64)
        self._running = memory("uint8_t[]", self.active), memory("double[]", self._genomes)
        self._answers = (
            memory("double[]", self.commands),
            memory("uint8_t[]", self.picked),
            memory("uint8_t[]", self.dropped),
        )
        self._readings = "double[]", np.dtype(np.float64), (robots, SENSORS)
        self._flags = "uint8_t[]", np.dtype(np.uint8), (robots,)
        self._given: tuple[Any, ...] = (None,) * 4
        self._sensed: tuple[Any, ...] = ()
        self._why = refusal()
        self._controllers = ffi.new("rg_controller[]", robots)
        for i, words in enumerate(seed.generate_state(4 * robots).reshape(robots, 4).tolist()):
            lib.rg_controller_start(ffi.addressof(self._controllers, i), words)

    def step(
        self, now: int, ps: FloatArray, ls: FloatArray, on_food: Flags, on_nest: Flags
    ) -> None:
        """Close due generations, then run every controller: fills commands, picked, dropped.

        Args:
            now: Control step since the run began.
            ps: (robots, 8) infrared counts.
            ls: (robots, 8) light counts.
            on_food: (robots,) virtual sensor.
            on_nest: (robots,) virtual sensor.

        Raises:
            InputError: an array is not of that shape, or not contiguous float64 (flags: uint8), or
                a reading is not finite.
        """
        given = ps, ls, on_food, on_nest
        if any(map(is_not, given, self._given)):
            self._sensed = self._as_c(*given)
            self._given = given
        if now >= self._next_due:
            for robot in np.flatnonzero(self._due <= now).tolist():
                self._turn_over(robot, now)
            self._next_due = int(self._due.min())
        status = lib.rg_control_swarm(
            self._behaviours,
            self.robots,
            *self._running,
            self._controllers,
            *self._sensed,
            *self._answers,
            self._why,
        )
        if status:
            check(status, self._why)
        if self.picked.any():
            self._pickup[self.picked != 0] = now
            self.carrying |= self.picked
        if self.dropped.any():
            self.carrying &= ~self.dropped & 1
            for robot in np.flatnonzero(self.dropped).tolist():
                self._deposit(robot, now)

    def _as_c(self, ps: Any, ls: Any, on_food: Any, on_nest: Any) -> tuple[Any, ...]:
        """What the robots sense as C has it; the same arrays are not looked at again."""
        return (
            _as_it_is("ps", ps, self._readings),
            _as_it_is("ls", ls, self._readings),
            _as_it_is("on_food", on_food, self._flags),
            _as_it_is("on_nest", on_nest, self._flags),
        )

    def hear(self, heard: Flags, now: int) -> None:
        """Store the present pair of every robot heard; `heard` is (receiver, sender).

        Raises:
            InputError: it is not (robots, robots).
        """
        if np.shape(heard) != (self.robots, self.robots):
            expected = f"shape {(self.robots, self.robots)}"
            raise InputError("heard", f"shape {np.shape(heard)}", expected)
        receivers, senders = np.nonzero(heard)
        self._heard_s0[receivers, senders] = self._s0[senders]
        self._heard_fitness[receivers, senders] = self._fitness[senders]
        self._heard_step[receivers, senders] = now

    def finish(self, now: int) -> None:
        """Log the generations that the end of the run cuts short."""
        for robot in np.flatnonzero(self.active).tolist():
            if self._opened[robot] < now:
                self._log(robot, now, len(self._pairs(robot)) - 1)

    def _turn_over(self, robot: int, now: int) -> None:
        """A robot's 60 s are over, or it is switched on."""
        if self.active[robot]:
            pairs = self._pairs(robot)
            self._log(robot, now, len(pairs) - 1)
            bred = self._breeder.breed(robot, pairs)
        else:
            self.active[robot] = 1
            bred = self._breeder.start(robot)
        self._bred[robot], self._s0[robot] = bred, bred.s0
        self._genomes[robot] = bred.genome[:CHOICES]
        self._behaviours[robot] = (bred.behaviour or self._behaviour).struct[0]
        self.generation[robot] += 1
        self._fitness[robot], self._count[robot] = 0.0, 0
        self._heard_step[robot] = -1  # the temporary population is cleared (III-H)
        self._opened[robot], self._due[robot] = now, now + GENERATION_STEPS

    def _pairs(self, robot: int) -> FloatArray:
        """The robot's own S0:F_R pair and the latest heard of others, ten in all at most."""
        senders = np.flatnonzero(self._heard_step[robot] >= 0)
        newest = np.argsort(-self._heard_step[robot, senders], kind="stable")
        senders = senders[newest[: POPULATION - 1]]
        pairs = np.empty((1 + len(senders), 2))
        pairs[0] = self._s0[robot], self._fitness[robot]
        pairs[1:, 0] = self._heard_s0[robot, senders]
        pairs[1:, 1] = self._heard_fitness[robot, senders]
        return pairs

    def _deposit(self, robot: int, now: int) -> None:
        """Credit an item to the generation: F grows by T_max - T_D (eq. 1)."""
        elapsed = (now - int(self._opened[robot])) * CONTROL_STEP
        self._fitness[robot] += TRIAL_SECONDS - elapsed
        self._count[robot] += 1
        generation = int(self.generation[robot])
        self.deposits.append((robot, now, int(self._pickup[robot]), generation))

    def _log(self, robot: int, now: int, heard: int) -> None:
        bred = self._bred[robot]
        self.generations.append(
            Generation(
                robot=robot,
                generation=int(self.generation[robot]),
                start_step=int(self._opened[robot]),
                end_step=now,
                s0=float(self._s0[robot]),
                genome=bred.genome,
                fitness_sim=bred.fitness_sim,
                fitness_real=float(self._fitness[robot]),
                deposits=int(self._count[robot]),
                heard=heard,
            )
        )


def _as_it_is(field: str, given: Any, expected: tuple[str, Any, tuple[int, ...]]) -> Any:
    """An array's memory as a C pointer, where type, shape and order are those of C: no copy is made
    at every step."""
    kind, dtype, shape = expected
    if not isinstance(given, np.ndarray):
        raise InputError(field, type(given).__name__, f"an array of {dtype}, shape {shape}")
    if given.dtype != dtype or given.shape != shape or not given.flags.c_contiguous:
        order = "" if given.flags.c_contiguous else ", not contiguous"
        got = f"{given.dtype} of shape {given.shape}{order}"
        raise InputError(field, got, f"{dtype} of shape {shape}, contiguous")
    return ffi.from_buffer(kind, given)
