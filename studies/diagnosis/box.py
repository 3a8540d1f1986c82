"""What a diagnosis' page says first: the verdict for whoever must repair a robot.

Each cause is a plain sentence with its numbers in units that people use.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import tomli_w

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.extension import NamedCause
from realitygap.models.log.named import Names
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Diagnosis, alternatives
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Named
from realitygap.studies.diagnosis.words import NO_REFERENCE, leftover_sentence, verdict_sentence
from realitygap.studies.pages.page import Box

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


UNDECIDED = "The log cannot decide what is wrong."
UNDECIDED_REST = "The log cannot decide what else is wrong."
UNKNOWN = "Something is wrong that no known cause explains."
ALSO = "That is not all: something else is wrong that no known cause explains."
REFUSED = "Something is wrong, but no correction of the model could be shown to help."
UNTIL = "Until that is mended, put this into your model; extended.toml has it already:"


def verdict_box(found: Diagnosis) -> Box:
    """The verdict with what to do."""
    if found.verdict in ("nothing_wrong", "cannot_tell"):
        sound = found.verdict == "nothing_wrong" and bool(found.reference)
        return Box("sound" if sound else "open", verdict_sentence(found))
    sure = [one for one in found.named if one.exported and not alternatives(one)]
    texts = [plain_sentence(one, found.names) for one in sure]
    unsure = [one for one in found.named if one not in sure]
    if unsure and sure:
        texts.append(UNDECIDED_REST)
    for one in unsure:
        texts += _unsure(one, found)
    left = [leftover_sentence(one, found.names) for one in found.unexplained]
    if left:
        texts += [*([ALSO] if found.named else []), *(f"Of {text}" for text in left)]
    if not found.reference:
        texts.append(NO_REFERENCE)
    code = model_lines(found)
    headline = _headline(found, sure)
    if sure:
        texts = texts[1:]
    return Box(
        "open" if found.verdict == "ambiguous" and not sure else "fault",
        headline,
        [*texts, *([UNTIL] if code else [])],
        code,
    )


def _headline(found: Diagnosis, sure: list[Named]) -> str:
    if sure:
        return plain_sentence(sure[0], found.names)
    if found.verdict == "ambiguous":
        return UNDECIDED
    return UNKNOWN if found.unexplained else REFUSED


def _unsure(one: Named, found: Diagnosis) -> list[str]:
    """A cause that has rivals, or that the model goes without."""
    said = plain_sentence(one, found.names)
    rivals = [f"Or {name}: {every_cause()[name].meaning}." for name in alternatives(one)]
    first = f"Either: {said}" if rivals else f"It may be this: {said}"
    name = one.term.cause.name
    why = [] if one.exported else [f"{name} is not in extended.toml: {one.why}."]
    return [first, *rivals, *why]


def model_lines(found: Diagnosis) -> str:
    """The lines of a model file that say what was named; empty: nothing is exported."""
    causes = [written(one, one.values) for one in found.named if one.exported]
    return "\n\n".join(_lines(one) for one in causes)


def _lines(cause: NamedCause) -> str:
    """One cause, a line for each of its parameters."""
    parameters = cause.model_dump(mode="json", exclude_none=True)["parameters"]
    lines = ["[[extension.causes]]", f"name = {_toml(cause.name)}"]
    lines.append(f"robots = {_toml(cause.robots)}")
    if cause.word:
        lines.append(f"word = {_toml(cause.word)}")
    for name, value in parameters.items():
        inside = ", ".join(f"{key} = {_toml(part)}" for key, part in value.items())
        lines.append(f"parameters.{name} = {{ {inside} }}")
    return "\n".join(lines if parameters else [*lines, "parameters = {}"])


def _toml(value: object) -> str:
    """A value on one line."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(str, value))}]"
    return tomli_w.dumps({"value": value}).removeprefix("value = ").strip()
