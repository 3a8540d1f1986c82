"""A hypothesis: a tuple of terms, and what came out where it was fitted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause


class Term(NamedTuple):
    """One variant of a cause."""

    cause: Cause
    variant: str

    @property
    def key(self) -> str:
        """A name for tables: `motor_saturation/left`, `motor_lag`."""
        return f"{self.cause.name}/{self.variant}" if self.variant else self.cause.name


Terms = tuple[Term, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """A hypothesis fitted to every group of robots; p parameters in all."""

    terms: Terms
    coordinates: FloatArray
    """(groups, p)."""
    covariance: FloatArray
    """(groups, p, p) by blocks; infinite for a coordinate that the data do not tell."""
    residual: FloatArray
    """(n, 3) errors at the optimum, in noise."""

    def part(self, term: Term) -> slice:
        """Columns of a term's parameters."""
        begin = 0
        for one in self.terms:
            end = begin + len(one.cause.parameters)
            if one == term:
                return slice(begin, end)
            begin = end
        raise KeyError(term.key)
