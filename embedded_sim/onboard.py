"""The on-board programs of a swarm: controllers, clocks, embedded simulators, what was heard.

One array per property with a row per robot; each robot still has its own clock and random streams.
Between generations a control step is one call into C.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from embedded_sim._core import ffi, lib
from embedded_sim.behaviour import Behaviour
from embedded_sim.genetics import POPULATION, next_controllers, next_environment, random_genes
from embedded_sim.model import CONTROL_STEP, FloatArray, PointModel
from embedded_sim.reading import Reading
from embedded_sim.simulator import TRIAL_SECONDS, evaluate

GENERATION_STEPS = round(60.0 / CONTROL_STEP)
"""Control steps of a generation: 60 s of a robot's own clock (III-H)."""

Flags = npt.NDArray[np.uint8]


def third(gene: float) -> int:
    """Third of [0, 0.99] a gene lies in: 0, 1 or 2 (Figs. 4 and 5)."""
    return int(lib.rg_third(gene))


@dataclass(frozen=True, kw_only=True)
class Generation:
    """What a robot's log says of one generation, written when it closes."""

    robot: int
    generation: int
    start_step: int
    end_step: int
    s0: float
    """Of the pair broadcast; NaN for a fixed controller."""
    genome: tuple[float, float]
    fitness_sim: float
    """s, of the running controller when it was bred; NaN for a fixed controller."""
    fitness_real: float
    """s, eq. 1 on the generation's own clock."""
    deposits: int
    heard: int
    """Other robots whose pair was compared."""


class Breeder(Protocol):
    """Decides what a robot runs next when its generation closes."""

    def start(self, robot: int) -> Bred:
        """The robot's first controller."""

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        """The next one, from the S0:F_R pairs compared, its own first."""


@dataclass(frozen=True)
class Bred:
    """A controller to run, and the S0 to broadcast meanwhile."""

    genome: tuple[float, float]
    s0: float
    fitness_sim: float


@dataclass(frozen=True)
class Fixed:
    """No evolution: every robot runs the same genome for ever."""

    genome: tuple[float, float]

    def start(self, robot: int) -> Bred:
        """The fixed controller."""
        return Bred(self.genome, float("nan"), float("nan"))

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        """The fixed controller."""
        return self.start(robot)


class CoEvolution:
    """Controllers evolve in each robot's simulator, simulators across the swarm (III-G, III-H)."""

    def __init__(
        self,
        seeds: Sequence[np.random.SeedSequence],
        *,
        models: Sequence[PointModel],
        behaviour: Behaviour,
        reading: Reading,
        trials: int = 1,
    ) -> None:
        """Begin with random genes.

        Args:
            seeds: One per robot, for its evolution and its trials.
            models: One per robot: what its simulator believes.
            behaviour: The controller's constants.
            reading: How the paper is read.
            trials: 60 s trials a genome's fitness is the mean of.
        """
        self._random = [np.random.default_rng(seed) for seed in seeds]
        self._models, self._behaviour = models, behaviour
        self._reading, self._trials = reading, trials
        self._s0 = [float(random_genes((1,), random)[0]) for random in self._random]
        self._genomes = [random_genes((POPULATION, 2), random) for random in self._random]

    def start(self, robot: int) -> Bred:
        """Evaluate the initial population under the initial S0."""
        return self._generation(robot)

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        """Evolve S0 and one generation of controllers.

        By default S0 moves first and the controllers are bred under it, so the broadcast pair names
        the S0 that made the running controller. Read literally, the controllers that finish now
        were bred under the S0 of the generation that closes, and S0 moves afterwards.
        """
        evolved = next_environment(pairs, self._reading, self._random[robot])
        if self._reading.pair_is_generator:
            self._s0[robot] = evolved
            return self._generation(robot)
        bred = self._generation(robot)
        self._s0[robot] = evolved
        return Bred(bred.genome, evolved, bred.fitness_sim)

    def _generation(self, robot: int) -> Bred:
        """Evaluate ten genomes in one call into C; the best is what the robot runs."""
        random, genomes, s0 = self._random[robot], self._genomes[robot], self._s0[robot]
        total = POPULATION * self._trials
        result = evaluate(
            np.repeat(genomes, self._trials, axis=0),
            np.full(total, third(s0), dtype=np.int32),
            random.integers(0, 2**32, (total, 4), dtype=np.uint32),
            model=self._models[robot],
            behaviour=self._behaviour,
        )
        fitness = result.fitness.reshape(POPULATION, self._trials).mean(axis=1)
        best = int(np.argmax(fitness))
        bred = Bred((float(genomes[best, 0]), float(genomes[best, 1])), s0, float(fitness[best]))
        self._genomes[robot] = next_controllers(genomes, fitness, self._reading, random)
        return bred


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
        """
        robots = len(start_steps)
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
        self._genomes: FloatArray = np.zeros((robots, 2))
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
        """
        if now >= self._next_due:
            for robot in np.flatnonzero(self._due <= now).tolist():
                self._turn_over(robot, now)
            self._next_due = int(self._due.min())
        lib.rg_control_swarm(
            self._behaviour.struct,
            self.robots,
            ffi.from_buffer("uint8_t[]", self.active),
            ffi.from_buffer("double[]", self._genomes),
            self._controllers,
            ffi.from_buffer("double[]", ps),
            ffi.from_buffer("double[]", ls),
            ffi.from_buffer("uint8_t[]", on_food),
            ffi.from_buffer("uint8_t[]", on_nest),
            ffi.from_buffer("double[]", self.commands),
            ffi.from_buffer("uint8_t[]", self.picked),
            ffi.from_buffer("uint8_t[]", self.dropped),
        )
        if self.picked.any():
            self._pickup[self.picked != 0] = now
            self.carrying |= self.picked
        if self.dropped.any():
            self.carrying &= ~self.dropped & 1
            for robot in np.flatnonzero(self.dropped).tolist():
                self._deposit(robot, now)

    def hear(self, heard: Flags, now: int) -> None:
        """Store the present pair of every robot heard; `heard` is (receiver, sender)."""
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
        self._bred[robot], self._genomes[robot], self._s0[robot] = bred, bred.genome, bred.s0
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
