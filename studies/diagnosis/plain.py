"""A cause in a plain sentence, with its numbers in units that people use."""

from __future__ import annotations

import math
from collections.abc import Sequence

from realitygap.models.belief.cause import Parameter
from realitygap.models.log.named import Names
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Named

SCALES = {"m": (1e3, " mm"), "s": (1e3, " ms"), "rad": (180.0 / math.pi, "°")}
"""Units that small values are told in."""
FASTEST = 5e-3
"""1/s below which a rate is told per minute; our choice."""


def plain_sentence(named: Named, names: Names) -> str:
    """What is wrong, of whom, by how much with its 95 % interval, and what to do."""
    cause = named.term.cause
    parameters = {p.name: p for p in (*cause.parameters, *cause.given)}
    told = {v.name: PlainAmount(v, parameters[v.name]) for v in (*named.values, *named.given)}
    owner = whose(named, names)
    words = {"Whose": owner[0].upper() + owner[1:], "whose": owner}
    return cause.plain.format(**words, which=_which(cause.word, named.term.variant), **told)


def whose(named: Named, names: Names) -> str:
    """Of which robots, before the part that is theirs."""
    if named.whole_swarm:
        return "every robot's"
    return joined([f"robot {names[robot]}'s" for robot in named.robots])


def joined(words: Sequence[str]) -> str:
    """As one lists them: a, b and c."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def _which(word: str, variant: str) -> str:
    """Which wheel or sensor, after a robot's name."""
    if word == "wheel":
        return {"both": "left and right motors"}.get(variant, f"{variant} motor")
    return "ring of sensors" if variant == "all" else f"{word} {variant}"


class PlainAmount:
    """A value with its interval; its format says as what it is told (`Cause.plain`)."""

    def __init__(self, value: Value, parameter: Parameter) -> None:
        self.value, self.parameter = value, parameter

    def __format__(self, spec: str) -> str:
        three = (self.value.value, self.value.low, self.value.high)
        if not spec:
            return self._told(three)
        if spec == "%":
            return _interval([100.0 * v for v in three], " %")
        more, less = spec.split("/")
        null = self.parameter.zero
        away = [v / null - 1.0 if self.relative else v - null for v in three]
        if away[0] < 0.0:
            away = [-away[0], -away[2], -away[1]]
            more = less
        return f"{self._told(away)} {more}"

    @property
    def relative(self) -> bool:
        """Whether it is a factor, so that it departs by a share."""
        return self.parameter.null == 1.0

    def _told(self, three: Sequence[float]) -> str:
        unit = self.value.unit
        largest = max(abs(v) for v in three if math.isfinite(v))
        if unit == "1/s":
            scale, unit = (6e3, " % per minute") if largest < FASTEST else (100.0, " % per second")
        elif self.relative or unit.startswith("share"):
            scale, unit = 100.0, " %"
        elif unit in SCALES and (unit == "rad" or largest < 1.0):
            scale, unit = SCALES[unit]
        else:
            scale, unit = 1.0, "" if unit == "1" else f" {unit}"
        return _interval([scale * v for v in three], unit)


def _interval(three: Sequence[float], unit: str) -> str:
    """A value and its interval, to the first digit of the interval's half width."""
    value, low, high = three
    width = max(abs(high - value), abs(value - low))
    digits = 2
    if 0.0 < width < math.inf:
        digits = min(max(0, -math.floor(math.log10(width))), 6)
    one, least, most = (f"{v:.{digits}f}" for v in (value, low, high))
    return f"{one}{unit} ({least} to {most}{unit})"
