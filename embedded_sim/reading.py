"""How the paper is read where its text is ambiguous: a named, validated part of the configuration.

The paper gives a mutation s.d. of 2 on genes in [0, 0.99], no bounding rule, and a broadcast pair
whose S0 may or may not be the one that bred the running controller (III-G, III-H).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

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
