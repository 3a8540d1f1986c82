"""What of a controller evolves: the paper's two genes, or these and five of its constants."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from realitygap.embedded_sim.behaviour import Behaviour
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.reading import GENE_MAX, Reading

CHOICES = 2
"""G0 and G1, the behaviour with and without food (paper, Fig. 4): the first genes of any genome."""
CONTINUOUS_SD = 0.2
"""s.d. of a continuous gene's mutation, our choice: the paper's 2 on a range of 1 would bring most
children to an end of the range."""


@dataclass(frozen=True, kw_only=True)
class Gene:
    """A gene in [0, 0.99] that stands for a constant of the controller."""

    name: str
    """As `generations.parquet` has it."""
    unit: str
    low: float
    """At gene 0."""
    high: float
    """At gene 0.99."""
    logarithmic: bool = False

    def value(self, gene: float) -> float:
        """The constant that a gene stands for, in the unit."""
        share = gene / GENE_MAX
        if self.logarithmic:
            return self.low * math.pow(self.high / self.low, share)
        return self.low + (self.high - self.low) * share


@dataclass(frozen=True, kw_only=True)
class Genome:
    """The genes of a controller: G0, G1 and then `continuous`."""

    name: str
    continuous: tuple[Gene, ...] = ()

    @property
    def genes(self) -> int:
        """How many genes there are."""
        return CHOICES + len(self.continuous)

    def mutation_sd(self, reading: Reading) -> FloatArray:
        """(genes,) s.d. of each gene's mutation."""
        own = [CONTINUOUS_SD] * len(self.continuous)
        return np.array([reading.controller_sd] * CHOICES + own)

    def values(self, genes: FloatArray) -> dict[str, float]:
        """What the continuous genes of one controller, (genes,), stand for."""
        own = genes[CHOICES:].tolist()
        return {gene.name: gene.value(g) for gene, g in zip(self.continuous, own, strict=True)}

    def behaviour(self, genes: FloatArray, base: Behaviour) -> Behaviour:
        """The controller's constants: those of `base` where no gene stands for them."""
        if not self.continuous:
            return base
        values = self.values(genes)
        scale = values["avoid_threshold_scale"]
        return replace(
            base,
            avoid_threshold=tuple(scale * counts for counts in base.avoid_threshold),
            avoid_speed=values["avoid_speed"],
            light_gain=values["light_gain"],
            search_curvature=values["search_curvature"],
            cruise_speed=values["cruise_speed"],
        )


PAPER = Genome(name="paper")
CONTINUOUS = Genome(
    name="continuous",
    continuous=(
        # one for all sensors; the front pair's 200 counts become 50 (far ahead) to 3200 (contact)
        Gene(name="avoid_threshold_scale", unit="", low=0.25, high=16.0, logarithmic=True),
        Gene(name="avoid_speed", unit="rad/s", low=1.0, high=6.28),
        Gene(name="light_gain", unit="1/rad", low=0.1, high=4.0),
        Gene(name="search_curvature", unit="", low=0.1, high=2.0),
        # up to the e-puck's fastest
        Gene(name="cruise_speed", unit="rad/s", low=1.0, high=6.28),
    ),
)
"""The paper's genes, and continuous ones for avoidance (threshold, gain), phototaxis (gain) and
search (turn rate, speed). The ranges are our choice: each holds the paper's controller inside."""

GENOMES: Mapping[str, Genome] = {genome.name: genome for genome in (PAPER, CONTINUOUS)}
