"""How a robot comes by its next controller: co-evolution on board (III-G, III-H), or fixed.

The evolutionary operators of a robot's controllers and the swarm's simulators come first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim._core import lib
from realitygap.embedded_sim.behaviour import Behaviour
from realitygap.embedded_sim.genome import CHOICES, GENE_MAX, PAPER, Genome, Reading
from realitygap.embedded_sim.model import FloatArray, PointModel
from realitygap.embedded_sim.simulator import evaluate

POPULATION = 10
"""Controller genomes per robot (III-G), and most S0:F_R pairs a robot compares (III-H)."""
OVERWRITTEN = 4
"""40 % of the population is overwritten by children of the best 40 % (III-G)."""
MUTATION_PROBABILITY = 0.2
"""Per gene of a child (III-G)."""


def random_genes(shape: tuple[int, ...], random: np.random.Generator) -> FloatArray:
    """Genes uniform in [0, 0.99]: the populations' beginning."""
    return GENE_MAX * random.random(shape)


def next_controllers(
    genomes: FloatArray,
    fitness: FloatArray,
    reading: Reading,
    random: np.random.Generator,
    genome: Genome = PAPER,
) -> FloatArray:
    """One steady-state generation of controllers: rank-based, elitist, no crossover.

    The best four each have one child, mutated, in the place of one of the worst four; the best six
    stay as they are. Equal fitness is ranked by position, earlier first.

    Args:
        genomes: (10, genes).
        fitness: (10,) s, in the embedded simulator.
        reading: Mutation s.d. and bounding rule.
        random: The robot's own stream.
        genome: Which genes there are.

    Returns:
        (10, genes), best first.
    """
    ranked = genomes[np.argsort(-fitness, kind="stable")]
    children = ranked[:OVERWRITTEN].copy()
    mutated = random.random(children.shape) < MUTATION_PROBABILITY
    step = genome.mutation_sd(reading) * random.standard_normal(children.shape)
    ranked[-OVERWRITTEN:] = np.where(mutated, reading.bound(children + step), children)
    return ranked


def next_environment(
    pairs: npt.NDArray[np.float64], reading: Reading, random: np.random.Generator
) -> float:
    """A robot's next S0 from the S0:F_R pairs it compares, its own first.

    Rank-based and elitist: the pair of the highest fitness is the parent, ties drawn by lot; always
    mutated. A robot that heard nobody has one pair, and so no selection.

    Args:
        pairs: (pairs, 2) of S0 and F_R.
        reading: Mutation s.d., bounding rule, and whether fitness counts.
        random: The robot's own stream.
    """
    best = pairs[:, 1] == pairs[:, 1].max()
    candidates = np.flatnonzero(best) if reading.selects_environment else np.arange(len(pairs))
    parent = pairs[candidates[random.integers(len(candidates))], 0]
    mutated = np.array([parent + random.normal(0.0, reading.environment_sd)])
    return float(reading.bound(mutated)[0])


def third(gene: float) -> int:
    """Third of [0, 0.99] a gene lies in: 0, 1 or 2 (Figs. 4 and 5)."""
    return int(lib.rg_third(gene))


class Breeder(Protocol):
    """Decides what a robot runs next when its generation closes."""

    def start(self, robot: int) -> Bred:
        """The robot's first controller."""

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        """The next one, from the S0:F_R pairs compared, its own first."""


@dataclass(frozen=True)
class Bred:
    """A controller to run, and the S0 to broadcast meanwhile."""

    genome: tuple[float, ...]
    s0: float
    fitness_sim: float
    behaviour: Behaviour | None = None
    """The controller's own constants; None: the swarm's."""


class Fixed:
    """No evolution: every robot runs its genome for ever."""

    def __init__(self, *genomes: tuple[float, float]) -> None:
        """Deal genomes, (G0, G1) each, to the robots by turns; one alone is every robot's."""
        self._genomes = genomes

    def start(self, robot: int) -> Bred:
        """The robot's fixed controller."""
        return Bred(self._genomes[robot % len(self._genomes)], float("nan"), float("nan"))

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        """The robot's fixed controller."""
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
        genome: Genome = PAPER,
    ) -> None:
        """Begin with random genes.

        Args:
            seeds: One per robot, for its evolution and its trials.
            models: One per robot: what its simulator believes.
            behaviour: The controller's constants.
            reading: How the paper is read.
            trials: 60 s trials a genome's fitness is the mean of.
            genome: Which genes a controller has.
        """
        self._random = [np.random.default_rng(seed) for seed in seeds]
        self._models, self._behaviour = models, behaviour
        self._reading, self._trials, self._genome = reading, trials, genome
        self._s0 = [float(random_genes((1,), random)[0]) for random in self._random]
        shape = (POPULATION, genome.genes)
        self._genomes = [random_genes(shape, random) for random in self._random]

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
        return replace(bred, s0=evolved)

    def _generation(self, robot: int) -> Bred:
        """Evaluate ten genomes in one call into C; the best is what the robot runs."""
        random, genomes, s0 = self._random[robot], self._genomes[robot], self._s0[robot]
        total = POPULATION * self._trials
        behaviours = [self._genome.behaviour(genes, self._behaviour) for genes in genomes]
        result = evaluate(
            np.repeat(genomes[:, :CHOICES], self._trials, axis=0),
            np.full(total, third(s0), dtype=np.int32),
            random.integers(0, 2**32, (total, 4), dtype=np.uint32),
            model=self._models[robot],
            behaviour=[own for own in behaviours for _ in range(self._trials)]
            if self._genome.continuous
            else self._behaviour,
        )
        fitness = result.fitness.reshape(POPULATION, self._trials).mean(axis=1)
        best = int(np.argmax(fitness))
        bred = Bred(tuple(genomes[best].tolist()), s0, float(fitness[best]), behaviours[best])
        self._genomes[robot] = next_controllers(
            genomes, fitness, self._reading, random, self._genome
        )
        return bred
