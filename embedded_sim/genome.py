"""What of a controller evolves: the paper's two genes, or these and five of its constants.

How the paper is read where its text is ambiguous is a named, validated part of the configuration:
it gives a mutation s.d. of 2 on genes in [0, 0.99], no bounding rule, and a broadcast pair whose S0
may or may not be the one that bred the running controller (III-G, III-H).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from realitygap.embedded_sim.behaviour import Behaviour
from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.model import FloatArray

GENE_MAX = 0.99
"""Genes lie in [0, 0.99] (paper, Figs. 4 and 5)."""

Bounding = Literal["clamp", "wrap", "reflect"]


def _clamp(genes: FloatArray) -> FloatArray:
    return np.clip(genes, 0.0, GENE_MAX)


def _wrap(genes: FloatArray) -> FloatArray:
    return np.mod(genes, GENE_MAX)


def _reflect(genes: FloatArray) -> FloatArray:
    folded = np.mod(genes, 2.0 * GENE_MAX)
    return np.minimum(folded, 2.0 * GENE_MAX - folded)


BOUNDINGS: Mapping[Bounding, Callable[[FloatArray], FloatArray]] = {
    "clamp": _clamp,
    "wrap": _wrap,
    "reflect": _reflect,
}
"""What happens to a gene that a mutation carries out of its range."""


@dataclass(frozen=True, kw_only=True)
class Reading:
    """One reading of sections III-G and III-H."""

    environment_sd: float = 0.2
    """s.d. of S0's mutation: with the printed 2, S0 is hardly inherited."""
    controller_sd: float = 2.0
    """s.d. of the controller genes' mutation (printed); it acts as replacement of the gene."""
    bounding: Bounding = "clamp"
    pair_is_generator: bool = True
    """The broadcast pair is (the S0 that bred the running controller, F_R). False: S0 has already
    moved on when the controller bred under the old one runs, as the text reads literally."""
    selects_environment: bool = True
    """False: S0's parent is drawn regardless of fitness, a control."""

    def bound(self, genes: FloatArray) -> FloatArray:
        """The genes brought back into [0, 0.99]."""
        return BOUNDINGS[self.bounding](genes)


READINGS: Mapping[str, Reading] = {
    "default": Reading(),
    "literal": Reading(environment_sd=2.0, pair_is_generator=False),
    "neutral": Reading(selects_environment=False),
    "reflect": Reading(bounding="reflect"),
    "wrap": Reading(bounding="wrap"),
}


def reading(
    name: str, *, environment_sd: float | None = None, bounding: Bounding | None = None
) -> Reading:
    """A reading by name, with the s.d. of S0's mutation and the bounding rule replaced if given.

    Raises:
        InputError: no such reading.
    """
    if name not in READINGS:
        raise InputError("--reading", repr(name), nearest(name, READINGS))
    named = READINGS[name]
    return replace(
        named,
        environment_sd=named.environment_sd if environment_sd is None else environment_sd,
        bounding=bounding or named.bounding,
    )


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
