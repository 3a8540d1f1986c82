"""The evolutionary operators: a robot's controllers (III-G), the swarm's simulators (III-H)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.genome import PAPER, Genome
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.reading import GENE_MAX, Reading

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
