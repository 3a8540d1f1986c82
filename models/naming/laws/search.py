"""Laws of the robots of a log that no listed cause explains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.laws import QUANTITIES, SIMULATED, Atom, Law
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.law_words import equation, reading
from realitygap.models.naming.channels.motion.robot import Robot
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.laws.amplitude import NORMAL, CurveOf, amounts, curve
from realitygap.models.naming.laws.columns import LawColumns
from realitygap.models.naming.laws.decoys import of_another, shifted
from realitygap.models.naming.laws.found import Amount, FoundLaw
from realitygap.models.naming.laws.grammar import Candidate, candidates
from realitygap.models.naming.laws.judged import Panel
from realitygap.models.naming.laws.room import LawRoom, obeying, relearned
from realitygap.models.naming.laws.selection import (
    LawRobot,
    Offered,
    explored,
    names,
    phased,
    refined,
    scanned,
)

LEAST = 12.0
"""Deviance that a law takes off held-out blocks beyond the price of its constants.
No rule, as all numbers here: laws are stated beside a verdict and change none."""
BEYOND = 1.5
"""Times the best decoy's, and the farthest other robot's."""
FAR = 6.0
"""Standard deviations of the other robots, beyond which a law is not theirs."""
CEILING = 0.8
"""Of what the best curve takes off, that a law must."""
SECOND = 0.05
"""Of what a first law takes off, that a second must."""
CLOSE = 0.98
"""Of what a law takes off, that another must, or all but `ODDS`, to be one that the log cannot tell
from it."""
ODDS = 6.0
MOST_LAWS = 2
"""Of the same robots."""
MANY = 4
"""Robots that are searched, the first ones of those concerned; all of them are fitted. From as many
on fewer decoys are asked."""
LIKE = 0.5
"""Of a law's amplitude, least that another robot has that has it as well."""
LEAST_OTHERS = 2
"""Other robots that a law of one must be compared with."""
SETTLED = SIMULATED - {"wall"}
"""Quantities whose laws the motion has before amplitudes are told; tracks know of no arena."""
RIVALS = 12
"""Curves that are drawn."""


class Stated(NamedTuple):
    """A law, as it was tried and as it is told."""

    law: Candidate
    told: FoundLaw
    like: frozenset[int]
    """Other robots of the log that have it as well."""


class Hunt:
    """Laws of some robots that are alike in what is the matter."""

    def __init__(self, room: LawRoom, who: Sequence[int]) -> None:
        self.room, self.who = room, sorted(who)
        self.shared = len(who) > 1
        self.robots = [self._seen(k, room.robots[k], ()) for k in self.who]
        places = np.concatenate([robot.shown.known["place"] for robot in self.robots])
        self.laws = list(candidates(list(names(self.robots)), places, room.seconds))

    def _seen(self, k: int, robot: Robot, beside: Sequence[FloatArray]) -> LawRobot:
        prior = self.room.prior(k, shared=self.shared)
        return LawRobot(LawColumns(robot), Panel(robot, prior, beside))

    def found(self) -> Iterator[Stated]:
        """Laws, the first the strongest."""
        kept: list[Candidate] = []
        first = 0.0
        for _ in range(MOST_LAWS):
            one = self._next(kept)
            if one is None or one.told.gain < SECOND * first:
                return
            if kept and not one.told.shape:
                return
            first = first or one.told.gain
            kept.append(one.law)
            yield one
            if not one.told.shape:  # what it leaves is no law's
                return

    def _next(self, kept: Sequence[Candidate]) -> Stated | None:
        """The next law beside others; None: there is none."""
        best = explored(self._at(kept, (), MANY), self.laws, self.room.seconds)
        best = [one for one in best if one.worth > LEAST]
        if not best:
            return None
        robots = self._at(kept, [one.law for one in best])
        again = [_of_all(robots[:MANY], one.law) for one in best]
        fitted = [refined(robots[:MANY], one, self.room.seconds) for one in again]
        offered = [_of_all(robots, one.law) for one in fitted] if len(robots) > MANY else fitted
        return self._weighed(robots, sorted(offered, key=lambda one: -one.worth), kept)

    def _at(
        self, kept: Sequence[Candidate], more: Sequence[Candidate], most: int | None = None
    ) -> list[LawRobot]:
        """The robots, noise learned with laws free, and the kept ones free beside any other."""
        if not kept and not more:
            return self.robots[:most]
        made = []
        for k, robot in list(zip(self.who, self.robots, strict=True))[:most]:
            shown = robot.shown
            every = [shown.change(one.channel, robot.strength(one)) for one in (*kept, *more)]
            fresh = relearned(self.room.robots[k], np.concatenate(every, axis=2))
            beside = [fresh.white(own) for own in every[: len(kept)]]
            made.append(self._seen(k, fresh, beside))
        return made

    def _weighed(
        self, robots: Sequence[LawRobot], offered: Sequence[Offered], kept: Sequence[Candidate]
    ) -> Stated | None:
        """The best law, or the curve that does clearly better, where decoys and others do not."""
        best = _plainest(offered)
        rivals = [one for one in offered if one is not best and _close(one, best)]
        some = robots[:MANY]
        top = self._ceiling(some, offered)
        worth = _of_all(some, best.law).worth
        shape = top is None or worth >= CEILING * top.worth
        law = phased(robots, best.law)
        atoms, channel, of = law.atoms[:1], law.channel, law.atoms[0].of
        if not shape:
            assert top is not None
            atoms = () if top.atom is None else (top.atom,)
            channel, of, worth = top.channel, top.of, top.worth
            law = Candidate(channel, atoms) if atoms else law
        decoy = self._decoys(kept, law)
        ids = [self.room.state.tracks.robots[k] for k in self.who]
        sizes = dict(zip(ids, self._sizes(robots, law, kept, shape=shape), strict=True))
        others = self._others(law)
        like = {k for k, one in others.items() if _alike(one, sizes)}
        if worth < max(LEAST, BEYOND * decoy) or not (like or _beyond(sizes, others)):
            return None
        radius = float(np.mean(robots[0].shown.robot.motion.drive.wheel_radius))
        told = FoundLaw(
            channel=channel,
            of=of,
            atoms=atoms,
            robots=tuple(sizes),
            amounts=sizes if atoms else {},
            shape=shape,
            whole_swarm=len(self.who) == len(self.room.robots) > 1,
            reading=reading(channel, atoms or (Atom(of, "curve"),), _largest(sizes), radius),
            gain=worth,
            ceiling=worth if top is None else top.worth,
            decoy=decoy,
            compared=len(others),
            instead=tuple(equation(*phased(robots, one.law)) for one in rivals) if shape else (),
        )
        return Stated(law, told, frozenset(like))

    def _sizes(
        self, robots: Sequence[LawRobot], law: Candidate, kept: Sequence[Candidate], *, shape: bool
    ) -> list[Amount]:
        """Amplitudes; of what can be simulated, from about where it is so large."""
        first = amounts(robots, law, MANY)
        if not shape or law.atoms[0].of not in SETTLED:
            return first
        moved = []
        for k, robot, one in zip(self.who, robots, first, strict=True):
            obeys = obeying(self.room.robots[k], Law(law.channel, one.value, law.atoms))
            shown = LawColumns(obeys, robot.shown)
            every = [shown.change(o.channel, robot.strength(o)) for o in (*kept, law)]
            fresh = relearned(obeys, np.concatenate(every, axis=2))
            beside = [fresh.white(own) for own in every[:-1]]
            panel = Panel(fresh, self.room.prior(k, shared=self.shared), beside)
            moved.append(LawRobot(LawColumns(fresh, robot.shown), panel))
        return amounts(moved, law, MANY, [one.value for one in first])

    def _ceiling(self, robots: Sequence[LawRobot], offered: Sequence[Offered]) -> CurveOf | None:
        """The best curve of a quantity, in the channels of the best laws."""
        pairs = [(one.law.channel, one.law.atoms[0].of) for one in offered]
        held = [of for of in QUANTITIES if of in robots[0].shown.known]
        pairs += [(offered[0].law.channel, of) for of in held]
        drawn = [curve(robots, *pair) for pair in list(dict.fromkeys(pairs))[:RIVALS]]
        return max((one for one in drawn if one is not None), key=lambda o: o.worth, default=None)

    def _decoys(self, kept: Sequence[Candidate], law: Candidate) -> float:
        """The most that a law of a quantity takes off that cannot be behind it, beside the law."""
        robots = self._at((*kept, law), (), MANY)
        tried = [one for one in self.laws if one.atoms[0].of not in ("time", "since")]
        shifts = (0.3, 0.6) if len(robots) >= MANY else (0.2, 0.4, 0.6, 0.8)
        most = 0.0
        for shift in shifts:
            moved = [replace(one, shown=shifted(one.shown, shift)) for one in robots]
            most = max(most, scanned(moved, tried)[0].worth)
        strangers = [k for k in range(len(self.room.robots)) if k not in self.who or self.shared]
        if strangers:
            moved = []
            for k, one in zip(self.who, robots, strict=False):
                other = next((s for s in strangers if s != k), None)
                if other is not None:
                    known = LawColumns(self.room.robots[other])
                    moved.append(replace(one, shown=of_another(one.shown, known)))
            most = max(most, scanned(moved, tried)[0].worth)
        return most

    def _others(self, law: Candidate) -> dict[int, Amount]:
        """Of the log's other robots, the same law, where it can be seen in them."""
        found = {}
        for k, robot in enumerate(self.room.robots):
            if k not in self.who:
                seen = self._seen(k, robot, ())
                width = float(np.diag(seen.told(law).information).min())
                if width > EMPTY:
                    (found[k],) = amounts([seen], law, 0)
        return found


def hunted(room: LawRoom, who: Sequence[int]) -> list[Stated]:
    """Laws of some robots, and of those of the others that turn out to have the first as well."""
    found = []
    for one in Hunt(room, who).found():
        if one.like:
            return hunted(room, [*who, *one.like])
        found.append(one)
    return found


def _of_all(robots: Sequence[LawRobot], law: Candidate) -> Offered:
    return Offered(law, np.asarray(np.sum([r.told(law).gain for r in robots], axis=0)))


def _alike(one: Amount, amounts: Mapping[int, Amount]) -> bool:
    """Whether another robot has a law, too, of about the same size."""
    error = (one.high - one.low) / (2.0 * NORMAL)
    least = min((abs(own.value), own.value) for own in amounts.values())[1]
    return abs(one.value) > FAR * error and LIKE < one.value / least < 1.0 / LIKE


def _beyond(amounts: Mapping[int, Amount], others: Mapping[int, Amount]) -> bool:
    """Whether a law is none of the log's other robots; where there are few nobody can say."""
    if len(others) < LEAST_OTHERS:
        return True
    sizes = np.array([one.value for one in others.values()])
    errors = np.array([(one.high - one.low) / (2.0 * NORMAL) for one in others.values()])
    spread = float(np.sqrt(max(np.mean(sizes**2) - np.mean(errors**2), 0.0)))
    least = min(abs(one.value) for one in amounts.values())
    return least >= max(FAR * spread, BEYOND * float(np.abs(sizes).max()))


def _plainest(offered: Sequence[Offered]) -> Offered:
    """Of those that do as well as the best, that with the fewest constants."""
    close = [one for one in offered if one.worth > offered[0].worth - ODDS]
    return min(close, key=lambda one: (len(one.law.atoms[0].parameters), -one.worth))


def _close(one: Offered, best: Offered) -> bool:
    return one.worth > min(best.worth - ODDS, CLOSE * best.worth)


def _largest(amounts: Mapping[int, Amount]) -> float:
    return max((one.value for one in amounts.values()), key=abs)
