"""What a selection leaves: terms chosen, what speaks for each, and terms that only mimic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.consistency import Misfit
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term


@dataclass(frozen=True, eq=False, kw_only=True)
class Evidence:
    """One term of the chosen set, with what speaks for it."""

    term: Term
    coordinates: FloatArray
    """(p,)."""
    covariance: FloatArray
    """(p, p)."""
    gain: float
    """Held-out deviance that the set loses without it."""
    share: float
    """That gain relative to the deviance without it."""
    distance: float
    """Standard deviations from the healthy value."""
    rivals: tuple[Term, ...] = ()
    """Terms that could stand in its place."""
    gains: tuple[tuple[str, float], ...] = ()
    """Held-out deviance that every term fitted at its turn took off, best first."""

    @property
    def score(self) -> float:
        """How far beyond health, as -log10 of what normal tails leave beyond the distance.

        No probability: the best of many terms is told, and the tails of health are not normal.
        """
        return float(-(np.log(2.0) + log_ndtr(-self.distance)) / np.log(10.0))


class Replaced(NamedTuple):
    """What tells more than a term in its place."""

    channel: str
    quantity: str
    """Of `models.identify.structure`."""


class Mimic(NamedTuple):
    """A term that helps, and where it does not fit, or what fits better."""

    evidence: Evidence
    misfit: Misfit | Replaced
    gain: float
    """Held-out deviance of one robot."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Choice:
    """What was chosen for a group of robots."""

    problem: Problem
    named: tuple[Evidence, ...]
    fit: Fit
    """With every term kept, named or not."""
    before: Fit
    """Without any term."""
    mimics: tuple[Mimic, ...] = ()
    """Terms that help and do not fit: they mimic something that is not in the catalogue."""
