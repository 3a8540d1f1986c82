"""Forward selection of what is the matter: the item that health is least able to explain, again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.fitter import Fitter, Refined
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item, Mask
from realitygap.models.naming.engine.marginal import EMPTY, Scored, freed
from realitygap.models.naming.engine.state import SWARM, Kept, State, refusing, with_kept
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.rules import Rules

SAME = 1e-6
"""Of a column's information, what is left of it beside another that is the same. No rule: a
tolerance."""


class Offer(NamedTuple):
    """One linear step's promise."""

    gain: float
    item: Item
    step: FloatArray


def offers(score: Scored, items: Sequence[Item], known: Mask, rules: Rules) -> list[Offer]:
    """What every item promises, best first."""
    found = []
    for item in items:
        at = list(item.columns)
        if not known[at].all():
            continue
        own, pull = score.information[np.ix_(at, at)], score.slope[at]
        if (np.diag(own) < EMPTY).any():
            continue
        try:
            step = np.linalg.solve(own, pull)
        except np.linalg.LinAlgError:
            continue
        gain = float(step @ pull)
        if item.dose is not None and step[0] < rules.least_dose:
            continue
        if item.term is not None:
            if item.dose is not None and not item.term.cause.smooth:
                gain = float(2.0 * pull[0] - own[0, 0])  # a threshold has no half doses
            elif item.dose is None:
                sign = np.array([p.sign for p in item.term.cause.parameters])
                if (sign * step < 0.0).any():
                    continue
        found.append(Offer(gain - rules.price * (len(at) - 1), item, np.asarray(step)))
    return sorted(found, key=lambda one: -one.gain)


def search(state: State, gates: Gates, known: Mask) -> State:
    """Everything that is the matter."""
    before = state.refused
    while True:  # every round keeps an item, of which a scope has few, or refuses one
        weighed = Weighed(state)
        best = _scope(weighed, gates, known)
        if best is None:
            return replace(state, refused=before)
        scope, listed = best
        found = _chosen(weighed, scope, listed, gates)
        if found is None:
            state = refusing(state, scope, listed[0].item.key)
        else:
            state = with_kept(state, scope, found)


def _scope(weighed: Weighed, gates: Gates, known: Mask) -> tuple[int, list[Offer]] | None:
    """Where the most conspicuous thing is, and what it may be."""
    state, rules = weighed.state, weighed.state.rules
    best: tuple[int, list[Offer]] | None = None
    for scope in (SWARM, *range(len(state.robots))):
        if len(state.of(scope)) >= rules.most_items:
            continue
        taken = {_name(one.item) for one in state.of(scope)}
        listed = [
            one
            for one in offers(weighed.score(scope), possible(state, scope), known, rules)
            if one.gain > (gates.flexible if one.item.term is None else gates.cause)
            and _name(one.item) not in taken
            and (scope, one.item.key) not in state.refused
            and (scope != SWARM or _common(weighed, one))
        ]
        if listed and (best is None or listed[0].gain > best[1][0].gain):
            best = scope, listed
    return best


def possible(state: State, scope: int) -> list[Item]:
    """What may be the matter in a scope: what belongs to the place is everybody's alone.

    Of one robot by itself everything is everybody's, where something belongs to the place: else a
    lamp and its sensors would not be rivals.
    """
    alone = len(state.robots) == 1 and any(_of_place(item) for item in state.items)
    swarm = alone or len(state.robots) >= state.rules.least_swarm
    if scope == SWARM:
        return [item for item in state.items if swarm or _of_place(item)]
    return [] if alone else [item for item in state.items if not _of_place(item)]


def _of_place(item: Item) -> bool:
    return item.term is not None and item.term.cause.place


def _name(item: Item) -> str:
    return item.key if item.term is None else item.term.cause.name


def _common(weighed: Weighed, one: Offer) -> bool:
    """Whether nearly every robot is better off with a shared item, or it is shared anyway."""
    if _of_place(one.item):
        return True
    at, deviants = list(one.item.columns), weighed.state.rules.deviants
    gains = []
    for robot, score in zip(weighed.state.robots, weighed.alone, strict=True):
        own = score.information[np.ix_(at, at)]
        if np.diag(robot.information)[at].any():  # else it says nothing of the item
            gains.append(2.0 * one.step @ score.slope[at] - one.step @ own @ one.step)
    return bool(gains) and float(np.mean(np.array(gains) > 0.0)) >= 1.0 - deviants


def _chosen(weighed: Weighed, scope: int, listed: list[Offer], gates: Gates) -> list[Kept] | None:
    """What is kept in a scope with the best of what is offered; None: nothing stands."""
    state, rules = weighed.state, weighed.state.rules
    before = state.of(scope)
    fitter = Fitter(weighed, scope)
    terms = [one.item.term for one in before if one.item.term is not None]
    start = [one.coordinates for one in before if one.item.term is not None]
    now = fitter.square(terms, start)
    tried = []
    for offer in contenders(listed, rules):
        fit = fitted_with(fitter, terms, start, offer)
        if fit is None:
            continue
        gain = now - fit.square - rules.price * (len(fit.coordinates[-1]) - 1)
        tried.append((gain, offer, fit))
    plains = [one for one in listed if one.item.term is None]
    tried.sort(key=lambda one: -one[0])
    if tried and tried[0][0] > gates.cause:
        gain, offer, fit = _plainest(tried, rules)
        bare = _bare(state, scope)
        better = _replacing(weighed.score(scope), offer, gain, plains, bare, rules)
        if better is not None:
            return [*before, Kept(better, np.zeros(0))]
        rest = iter(fit.coordinates)
        kept = [
            one if one.item.term is None else one._replace(coordinates=next(rest)) for one in before
        ]
        linear = next(i for i in state.items if i.term == offer.item.term)
        return [*kept, Kept(linear if linear.dose is None else offer.item, next(rest))]
    return [*before, Kept(_steadiest(plains, rules).item, np.zeros(0))] if plains else None


def _plainest(
    tried: Sequence[tuple[float, Offer, Refined]], rules: Rules
) -> tuple[float, Offer, Refined]:
    """Of those that do as well as the best, which is first, that with fewest parameters."""
    close = [one for one in tried if one[0] > tried[0][0] - rules.odds]
    return min(close, key=lambda one: len(one[2].coordinates[-1]))


def _steadiest(plains: Sequence[Offer], rules: Rules) -> Offer:
    """The best of what follows something, best first; or what follows nothing, if it does nearly as
    well."""
    least = (1.0 - rules.almost) * plains[0].gain
    steady = [one for one in plains if _follows_nothing(one.item)]
    return next((one for one in steady if one.gain > least), plains[0])


def contenders(listed: Sequence[Offer], rules: Rules, most: float = 0.0) -> list[Offer]:
    """The causes worth a fit, each from where it promises most.

    Args:
        listed: Best first.
        rules: How many, and how much worse than the best.
        most: Gain that they are measured by; 0: the best of theirs.
    """
    seen: dict[Term, Offer] = {}
    most = most or max((one.gain for one in listed if one.item.term is not None), default=0.0)
    for one in listed:
        term = one.item.term
        if term is not None and term not in seen and one.gain >= rules.worth * most:
            seen[term] = one
    return list(seen.values())[: rules.contenders]


def fitted_with(
    fitter: Fitter, terms: Sequence[Term], start: Sequence[FloatArray], offer: Offer
) -> Refined | None:
    """Causes with one more, fitted; None where it ends on the wrong side of its null."""
    term = offer.item.of
    fit = fitter.fit([*terms, term], [*start, _begin(offer)])
    if fit is None or _wrong_sign(term, fit.coordinates[-1]):
        return None
    return fit


def _begin(offer: Offer) -> FloatArray:
    if offer.item.dose is not None:
        return np.array(offer.item.dose)
    low, high = np.array([p.bounds for p in offer.item.of.cause.parameters]).T
    return np.asarray(np.clip(offer.step, low, high))


def _wrong_sign(term: Term, coordinates: FloatArray) -> bool:
    return bool((np.array([p.sign for p in term.cause.parameters]) * coordinates < 0.0).any())


def _bare(state: State, scope: int) -> FloatArray:
    """(k,) information of single columns that health knows; the others are free anyway."""
    names = state.robots[0].names
    bare = np.sum([np.diag(state.robots[k].information) for k in state.members(scope)], axis=0)
    return np.asarray(np.where(["@" in name for name in names], 0.0, bare))


def _follows_nothing(item: Item) -> bool:
    return item.columns == (item.always,)


def _tells(score: Scored, bare: FloatArray, item: Item) -> bool:
    """Whether a channel's steady change is something else than what is fitted already."""
    if _follows_nothing(item):
        return False
    at = item.always
    return bare[at] == 0.0 or float(score.information[at, at]) > SAME * float(bare[at])


def _replacing(
    score: Scored,
    offer: Offer,
    gain: float,
    plains: Sequence[Offer],
    bare: FloatArray,
    rules: Rules,
) -> Item | None:
    """What follows a quantity, does better than a cause and leaves it little; None: nothing.

    What follows a quantity also has a mean, which a cause would take for its own: its channel's
    steady change is given beside.
    """
    rough = rules.rough if offer.item.of.cause.feigns else rules.almost
    best, most = None, gain + max(rules.better, rough * gain)
    at = list(offer.item.columns)
    steady = [one for one in plains if _follows_nothing(one.item)]
    for one in (*steady, *(one for one in plains if one not in steady)):
        mean = (one.item.always,) if _tells(score, bare, one.item) else ()
        item = one.item._replace(columns=(*one.item.columns, *mean))
        rest = freed(score, np.array(item.columns))
        told = score.square - rest.square - rules.price * (len(item.columns) - 1)
        own, pull = rest.information[np.ix_(at, at)], rest.slope[at]
        left = float(pull @ np.linalg.lstsq(own, pull, rcond=None)[0])
        if told > most and left < rules.left * gain:
            best, most = item, told * (1.0 + rules.almost) if one in steady else told
    return best
