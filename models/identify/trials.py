"""One term more: which are worth a fit, and the fits.

Of a swarm, a few robots are asked first: from where a fit starts, and which terms they are so sure
of that all robots are asked. What is shared shows in any of them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.candidates import starts
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.screen import glance
from realitygap.models.identify.value import bracket

PROMISING = 0.5
"""Of the least gain that one linear step must promise for a term to be fitted."""
PROMISING_SHARE = 0.1
"""Of the most promising term's, likewise: a step underrates what is far from linear."""
MUCH = 200.0
"""Promised deviance that always earns a fit."""
SCOUTS = 3
"""Robots of a swarm that are asked first. Our choice."""
SHORT_LIST = 0.2
"""Of the best term's gain among scouts that earns a fit to all robots. Our choice, below the 0.3 at
which rivals are looked for."""


class Trials:
    """Fits of a hypothesis with one more term."""

    def __init__(self, problem: Problem) -> None:
        """Prepare; `problem` has a single group."""
        self.problem = problem
        robots = len(problem.tracks.robots)
        self._scouts = np.unique(np.linspace(0, robots - 1, SCOUTS, dtype=int)).tolist()
        self._rough: Problem | None = None
        if robots > SCOUTS:
            self._rough = Problem(
                problem.tracks.only(self._scouts),
                [problem.base[k] for k in self._scouts],
                groups=np.zeros(SCOUTS, dtype=int),
            )

    def one_more(self, kept: Fit, least_gain: float) -> dict[Term, Fit]:
        """The set with each further term that may help."""
        names = {term.cause.name for term in kept.terms}
        promised: dict[Term, float] = {}
        for one in glance(self.problem, self.problem.motions(kept.terms, kept.coordinates)):
            if one.term.cause.name not in names:
                promised[one.term] = max(promised.get(one.term, 0.0), float(one.gain.sum()))
        best = max(promised.values(), default=0.0)
        least = max(PROMISING * least_gain, min(PROMISING_SHARE * best, MUCH))
        hopeful = [term for term, gain in promised.items() if gain >= least]
        begun = {term: self._begun(kept, term) for term in hopeful}
        fits = {
            term: _fitted(self.problem, kept, term, begun[term])
            for term in self._short_list(kept, begun)
        }
        return {term: fit for term, fit in fits.items() if fit is not None}

    def with_term(self, kept: Fit, term: Term) -> Fit | None:
        """The set with one more term, or None where it cannot be tried on this log."""
        return _fitted(self.problem, kept, term, self._begun(kept, term))

    def rescale(self, kept: Fit, fits: Mapping[Term, Fit]) -> None:
        """Judge all by the errors that the best leaves."""
        problem = self.problem
        best = max(fits.values(), key=lambda f: float(problem.gain(kept, f).sum()))
        problem.scale = problem.spread(best.residual)
        if self._rough is not None:
            self._rough.scale = problem.scale[self._scouts]

    def _begun(self, kept: Fit, term: Term) -> list[FloatArray]:
        """Where fits with one more term start: for a swarm, where the scouts' ended."""
        begin = starts(self.problem, term, kept.coordinates)
        if self._rough is None:
            return begin
        scouted = _fitted(self._rough, kept, term, begin)
        return [] if scouted is None else [scouted.coordinates]

    def _short_list(self, kept: Fit, begun: Mapping[Term, list[FloatArray]]) -> list[Term]:
        """Terms that the scouts think something of."""
        rough = self._rough
        if rough is None or len(begun) < 2:
            return list(begun)
        before = rough.at(kept.terms, kept.coordinates)
        gains = {
            term: float(rough.gain(before, rough.at((*kept.terms, term), here[0])).sum())
            for term, here in begun.items()
            if here
        }
        most = max(gains.values(), default=0.0)
        least = min(SHORT_LIST * most, most)  # the best always, though scouts be worse off with it
        return [term for term, gain in gains.items() if gain >= least]


def _fitted(problem: Problem, kept: Fit, term: Term, begin: list[FloatArray]) -> Fit | None:
    """A set and one more term, from the best of several starts."""
    terms = (*kept.terms, term)
    if not begin:
        return None
    try:
        fit = problem.fit(terms, begin)
        if term.cause.smooth:
            return fit
        at = fit.part(term).start
        here = fit.coordinates.copy()
        here[0, at] = bracket(problem, terms, here, at).best
        return problem.fit(terms, [here])
    except Diverged:
        return None
