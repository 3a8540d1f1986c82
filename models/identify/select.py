"""Forward selection of terms for one group of robots: few, each needed, each beyond health.

A term is taken when it takes more deviance off held-out blocks than any other; it is named only if
its parameter also lies outside the healthy spread of that very parameter. A term that helps but
stays within that spread is how healthy robots differ: it is kept in the fit, unnamed.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.choice import Choice, Evidence, Mimic, Replaced
from realitygap.models.identify.consistency import Misfit, misfit
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term, Terms
from realitygap.models.identify.measure import distance, jump
from realitygap.models.identify.plain import replaced
from realitygap.models.identify.separable import inseparable
from realitygap.models.identify.trials import Trials
from realitygap.models.reference import Reference

MOST_TERMS = 4
"""Terms tried in one robot; more are not told apart in two minutes."""
MARGIN = 6.0
"""Held-out deviance by which a rival must be worse: odds of 20 to 1."""
MARGIN_ERRORS = 3.0
"""Standard errors, over blocks, by which a rival must be worse."""
FAMILY = 0.03
"""Of the whole set's gain that a term needs beside a stronger one of its family."""
ANY = 0.01
"""Of the whole set's gain that any term needs: no model of a cause is exact."""
CLEARLY = 0.2
"""Of a term's gain that a rival may not miss, however few blocks it is lost in."""
BESIDE = 0.5
"""Of the gain of what is unknown in a robot that a name beside it needs: what half describes the
unknown would be named, too. Our choice."""
RIVAL_SHARE = 0.3
"""Of the gain that a term needs to be looked at as a rival."""


def choose(
    problem: Problem, reference: Reference, *, swarm: bool = False, shared: Terms = ()
) -> Choice:
    """The terms that one group of robots needs.

    Args:
        problem: With a single group.
        reference: What healthy robots show.
        swarm: Whether the group is a whole swarm, which differs less from others than a robot does.
        shared: Named already of this robot and others.
    """
    if problem.count != 1:
        raise ValueError(f"problem: got {problem.count} groups, expected one")
    search = _Search(problem, reference, swarm, shared)
    before = problem.at((), np.zeros((1, 0)))
    kept, tried = search.forward(before)
    kept = search.needed(kept)
    # what unnamed kin took belongs to the named cause of their family: first what health can do,
    # then what only companions do
    for judge in (search.beyond, search.strong):
        for term in search.kin(kept, judge(before, kept)):
            kept = search.without(kept, term)
    strong, mimics = search.fitting(kept, search.strong(before, kept))
    nuisance = [t for t in kept.terms if t not in [one.term for one in strong]]
    named = [
        replace(
            one,
            rivals=search.rivals(kept, one.term, tried.get(one.term, {}), nuisance),
            gains=_ranked(tried.get(one.term, {})),
        )
        for one in strong
    ]
    return Choice(problem=problem, named=tuple(named), fit=kept, before=before, mimics=mimics)


def _ranked(gains: dict[Term, float]) -> tuple[tuple[str, float], ...]:
    """Terms by name, best first."""
    return tuple(sorted(((t.key, g) for t, g in gains.items()), key=lambda kg: -kg[1]))


class _Search:
    """The fits of one selection."""

    def __init__(self, problem: Problem, reference: Reference, swarm: bool, shared: Terms) -> None:
        self.problem, self.reference, self.swarm = problem, reference, swarm
        self.shared = shared
        self.trials = Trials(problem)
        self.least_gain = reference.gates.gain
        self._without: dict[tuple[Fit, Term], Fit] = {}
        """At the present scale of the errors."""

    def forward(self, before: Fit) -> tuple[Fit, dict[Term, dict[Term, float]]]:
        """Add the best term until none helps; the gains of all terms at each one's turn."""
        kept = before
        tried: dict[Term, dict[Term, float]] = {}
        while len(kept.terms) < MOST_TERMS:
            fits = self.trials.one_more(kept, self.least_gain)
            if not fits:
                break
            self.trials.rescale(kept, fits)
            self._without.clear()
            gains = {t: float(self.problem.gain(kept, f).sum()) for t, f in fits.items()}
            best = max(gains, key=lambda t: gains[t])
            if gains[best] < self.least_gain:
                break
            kept = fits[best]
            tried[best] = gains
        return kept, tried

    def needed(self, kept: Fit) -> Fit:
        """Drop terms that the others make superfluous."""
        while len(kept.terms) > 1:
            loss = {term: self.gain_of(kept, term) for term in kept.terms}
            weakest = min(loss, key=lambda t: loss[t])
            if loss[weakest] >= self.least_gain:
                break
            kept = self.without(kept, weakest)
        return kept

    def strong(self, before: Fit, kept: Fit) -> list[Evidence]:
        """Evidence of the terms that are beyond health and more than companions."""
        total = float(self.problem.gain(before, kept).sum())
        return self.without_companions(self.beyond(before, kept), total)

    def beyond(self, before: Fit, kept: Fit) -> list[Evidence]:
        """Evidence of the terms that are beyond health."""
        found = [self.evidence(kept, term) for term in kept.terms]
        return [one for one in found if one is not None]

    def fitting(
        self, kept: Fit, strong: list[Evidence]
    ) -> tuple[list[Evidence], tuple[Mimic, ...]]:
        """The evidence of terms that fit, and those that do not.

        Beside what only mimics something unknown, a weaker term may mend what the mimic leaves.
        """
        mimics = []
        robots = len(self.problem.tracks.robots)
        for one in strong:
            found: Misfit | Replaced | None = misfit(self.problem, kept, one.term)
            if robots == 1 and not one.term.cause.geometric:
                without = self.without(kept, one.term)
                found = replaced(self.problem, kept, without, one.gain) or found
            if found is not None:
                mimics.append(Mimic(one, found, one.gain / robots))
        poor = [mimic.evidence.term for mimic in mimics]
        unknown = max((mimic.evidence.gain for mimic in mimics), default=0.0)
        return [
            one for one in strong if one.gain > BESIDE * unknown and one.term not in poor
        ], tuple(mimics)

    def kin(self, kept: Fit, strong: list[Evidence]) -> list[Term]:
        """Unnamed terms of the named ones' families: they mend what a rough model leaves."""
        named = [one.term for one in strong]
        families = {term.cause.family for term in named} - {""}
        return [t for t in kept.terms if t not in named and t.cause.family in families]

    def without_companions(self, found: list[Evidence], total: float) -> list[Evidence]:
        """The evidence but for terms that only mend what a stronger one of their kind leaves."""
        strong = []
        for one in found:
            family = one.term.cause.family
            kin = [
                o
                for o in found
                if o is not one and family and o.term.cause.family == family and o.gain > one.gain
            ]
            if one.gain >= (FAMILY if kin else ANY) * total:
                strong.append(one)
        return strong

    def evidence(self, kept: Fit, term: Term) -> Evidence | None:
        """A kept term's evidence, or None where it is how healthy robots differ."""
        without = self.without(kept, term)
        gain = float(self.problem.gain(without, kept).sum())
        part = kept.part(term)
        coordinates = kept.coordinates[:, part]
        covariance = kept.covariance[:, part, part]
        signs = [p.sign for p in term.cause.parameters]
        if (np.array(signs) * coordinates[0] < 0.0).any():
            return None
        jumped = np.zeros(1) if term.cause.smooth else jump(self.problem, without, kept)
        away = self.distance(term, coordinates, covariance, jumped, self.feigned(kept, term))
        if away < self.reference.gate(term.key, swarm=self.swarm) or gain < self.least_gain:
            return None
        total = float(self.problem.losses(without.held_out).sum())
        return Evidence(
            term=term,
            coordinates=coordinates[0],
            covariance=covariance[0],
            gain=gain,
            share=gain / total,
            distance=away,
        )

    def feigned(self, kept: Fit, term: Term) -> float:
        """Standard deviation of a coordinate that exact causes, stronger than its own, feign."""
        name = term.cause.name
        exact = [t for t in kept.terms if t.cause.exact and name in t.cause.feigns]
        if exact:
            own = self.alone(kept, term)
            exact = [t for t in exact if self.alone(kept, t) > own]
        feigned = [t.cause.feigns.get(name, 0.0) for t in (*exact, *self.shared) if t.cause.exact]
        return max(feigned, default=0.0)

    def alone(self, kept: Fit, term: Term) -> float:
        """Held-out deviance that a term takes off as the only one of its family."""
        kin = [t for t in kept.terms if t.cause.family == term.cause.family and t != term]
        only = reduce(self.without, kin, kept)
        return self.gain_of(only, term)

    def distance(
        self,
        term: Term,
        coordinates: FloatArray,
        covariance: FloatArray,
        jumped: FloatArray,
        feigned: float = 0.0,
    ) -> float:
        """Standard deviations from the healthy value."""
        mean, sd = self.reference.spread(term.key, coordinates.shape[1], swarm=self.swarm)
        commands, wide = self.problem.tracks.commands, np.hypot(sd, feigned)
        return float(distance(term, coordinates, covariance, commands, mean, wide, jumped)[0])

    def without(self, kept: Fit, term: Term) -> Fit:
        """The set refitted without a term."""
        if (kept, term) not in self._without:
            terms = tuple(t for t in kept.terms if t != term)
            rest = np.delete(kept.coordinates, np.r_[kept.part(term)], axis=1)
            self._without[kept, term] = self.problem.fit(terms, [rest])
        return self._without[kept, term]

    def gain_of(self, kept: Fit, term: Term) -> float:
        """Held-out deviance that a term takes off in the presence of the others."""
        return float(self.problem.gain(self.without(kept, term), kept).sum())

    def rivals(
        self, kept: Fit, term: Term, tried: dict[Term, float], nuisance: list[Term]
    ) -> tuple[Term, ...]:
        """Terms that could stand in a term's place without being clearly worse.

        A rival that needs an unnamed term to leave health would be two causes for one.
        """
        without = self.without(kept, term)
        own = max(tried.get(term, 0.0), 1e-9)
        names = {t.cause.name for t in kept.terms} - {term.cause.name}
        found = []
        for other, gain in tried.items():
            if other == term or other.cause.name in names or gain < RIVAL_SHARE * own:
                continue
            fit = self.trials.with_term(without, other)
            if (
                fit is not None
                and not self._worse(kept, fit, without)
                and self._alone(kept, fit, nuisance)
            ):
                found.append(other)
        found += [t for t in inseparable(self.problem, kept, term) if t not in found]
        return tuple(found)

    def _alone(self, kept: Fit, rival: Fit, nuisance: list[Term]) -> bool:
        """Whether the unnamed terms stay as near to health as they were."""
        for term in nuisance:
            far = []
            for fit in (kept, rival):
                part = fit.part(term)
                spread = fit.covariance[:, part, part]
                far.append(self.distance(term, fit.coordinates[:, part], spread, np.zeros(1)))
            if far[1] > max(self.reference.gate(term.key, swarm=self.swarm), 1.5 * far[0]):
                return False
        return True

    def _worse(self, kept: Fit, rival: Fit, without: Fit) -> bool:
        """Whether a rival set is clearly worse on held-out blocks."""
        lost = self.problem.gain(rival, kept)
        block = self.problem.tracks.block
        by_block = np.bincount(block, lost)
        error = float(np.sqrt(np.sum((by_block - by_block.mean()) ** 2)))
        whole = float(self.problem.gain(without, kept).sum())
        return float(lost.sum()) > max(MARGIN, min(MARGIN_ERRORS * error, CLEARLY * whole))
