"""First, do no harm: which named causes the extended model may hold.

A cause is exported only if the model with it predicts better on parts of the log that its values
were not fitted to, 1, 5 or 20 s ahead in place or heading, and worse at none of them. The test is
paired over blocks of time of the robots that have the cause (`log.blocks`): at most
`Rules.harm_level` by chance, over the number of errors that it changes, and, to be worse, by more
than `Rules.harm_margin` of the error. Each named cause is judged by leaving
it out of the rest; what fails is dropped and the rest judged again, and at last all together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.extended import as_written
from realitygap.models.belief.extension import NamedCause
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.blocks import Better, better
from realitygap.models.naming.channels.motion.fitted import Values
from realitygap.models.naming.claims.ahead import KEYS, SECONDS, Ahead, key, together
from realitygap.models.naming.claims.prediction import MOTION
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.findings import Named
from realitygap.models.naming.rules import Rules

UNCHECKED = "seen, but the log has too little beside it to check: not exported"
"""Why a cause is not exported that only one part of the log shows, or no window of the other."""


class Weighable(Protocol):
    """Predictions by models that hold some of the named causes."""

    named: Sequence[Named]
    by_part: tuple[Values, ...]
    """Of each part of the log, the values that it gives by itself."""
    useless: str
    """Why a cause that helps nowhere is not exported."""

    def harms(self, keys: Sequence[str]) -> str:
        """Why a cause is not exported with which these are predicted worse."""

    def compare(
        self, robots: Sequence[int], before: frozenset[int], after: frozenset[int]
    ) -> dict[str, Better]:
        """By key, how much better robots are predicted with other causes, by number."""


class Predictions:
    """What models with some of the named causes predict, each in the part it was not fitted to."""

    useless = "seen, but the model with it predicts nothing better 1, 5 or 20 s ahead: not exported"

    def __init__(
        self,
        ahead: Ahead,
        model: ModelFile,
        named: Sequence[Named],
        by_part: tuple[Values, ...],
    ) -> None:
        """Prepare; `by_part` are the values that each part of the log gives by itself."""
        self.ahead, self.model, self.named, self.by_part = ahead, model, named, by_part
        self._files: dict[tuple[frozenset[int], int], ModelFile] = {}
        self._sizes: dict[tuple[int, frozenset[int]], dict[str, FloatArray]] = {}

    @staticmethod
    def harms(keys: Sequence[str]) -> str:
        """Why a cause is not exported, in words."""
        at = [h for h in SECONDS if any(key(channel, h) in keys for channel in MOTION)]
        onwards = list(SECONDS[SECONDS.index(at[0]) :]) == at
        when = f"from {at[0]} on" if onwards else f"at {' and '.join(at)}"
        return f"seen, but the model with it predicts worse {when}: not exported"

    def file(self, causes: frozenset[int], part: int) -> ModelFile:
        """The model file with some causes that judges a part, read back from its text."""
        if (causes, part) not in self._files:
            self._files[causes, part] = (
                as_written(self.model, self._written(causes, part)) if causes else self.model
            )
        return self._files[causes, part]

    def _written(self, causes: frozenset[int], part: int) -> list[NamedCause]:
        """Causes with the values of the other part."""
        values = self.by_part[1 - part]
        return [written(self.named[k], values[self.named[k].key]) for k in sorted(causes)]

    def sizes(self, robot: int, causes: frozenset[int]) -> dict[str, FloatArray]:
        """By key, (windows,) how far the model with some causes is off; others are left out."""
        mine = frozenset(k for k in causes if robot in self.named[k].robots)
        if (robot, mine) not in self._sizes:
            poses = self.ahead.replay(robot, lambda r, part: self.file(mine, part).motion(r))
            self._sizes[robot, mine] = self.ahead.sizes(robot, poses)
        return self._sizes[robot, mine]

    def compare(
        self, robots: Sequence[int], before: frozenset[int], after: frozenset[int]
    ) -> dict[str, Better]:
        """By key, how much better robots are predicted with other causes."""
        less = [self.sizes(robot, before) for robot in robots]
        more = [self.sizes(robot, after) for robot in robots]
        found = {}
        for name in KEYS:
            block = self.ahead.block(name, robots)
            one = better(together(less, name), together(more, name), block)
            if one is not None:
                found[name] = one
        return found


def harmless(predictions: Weighable, rules: Rules = Rules()) -> dict[int, str]:
    """Causes that may not be exported, by number, and why."""
    named, by_part = predictions.named, predictions.by_part
    refused = {
        k: UNCHECKED
        for k, one in enumerate(named)
        if any(one.key not in values for values in by_part)
    }
    kept = frozenset(range(len(named))) - refused.keys()
    while kept:
        worst = _worst(predictions, kept, rules)
        if worst is None:
            break
        number, refused[number] = worst[0], worst[1]
        kept -= {number}
    return refused


def _worst(predictions: Weighable, kept: frozenset[int], rules: Rules) -> tuple[int, str] | None:
    """The cause that must go first, and why; None: all may stay."""
    alone = {
        k: predictions.compare(predictions.named[k].robots, kept - {k}, kept) for k in sorted(kept)
    }
    harmful = {k: bad for k, one in alone.items() if (bad := worse(one, rules))}
    if harmful:
        number = max(harmful, key=lambda k: max(alone[k][name].level for name in harmful[k]))
        return number, predictions.harms(harmful[number])
    unchecked = [k for k, one in alone.items() if not one]
    if unchecked:
        return unchecked[0], UNCHECKED
    useless = [k for k, one in alone.items() if not helps(one, rules)]
    if useless:
        number = max(useless, key=lambda k: min((b.level for b in alone[k].values()), default=1.0))
        return number, predictions.useless
    for k in sorted(kept):
        robots = predictions.named[k].robots
        found = worse(predictions.compare(robots, frozenset(), kept), rules)
        if found:
            beside = [j for j in kept if set(predictions.named[j].robots) & set(robots)]
            number = max(beside, key=lambda j: min(b.level for b in alone[j].values()))
            return number, predictions.harms(found)
    return None


def helps(found: Mapping[str, Better], rules: Rules) -> bool:
    """Whether something is predicted better."""
    return any(one.level < rules.harm_level / len(found) for one in found.values())


def worse(found: Mapping[str, Better], rules: Rules) -> list[str]:
    """Keys of what is predicted worse."""
    sure = 1.0 - rules.harm_level / max(len(found), 1)
    return [k for k, one in found.items() if one.share < -rules.harm_margin and one.level > sure]


def robots_of(named: Sequence[Named], robots: Sequence[int]) -> list[int]:
    """Robots that some cause concerns, or all of them where none does."""
    concerned = {robot for one in named for robot in one.robots}
    return sorted(concerned) or [int(robot) for robot in robots]
