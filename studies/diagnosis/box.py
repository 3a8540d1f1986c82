"""What a diagnosis' page says first: the verdict for whoever must repair a robot."""

from __future__ import annotations

import tomli_w

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import NamedCause
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Diagnosis, alternatives
from realitygap.models.naming.findings import Named
from realitygap.studies.diagnosis.plain import plain_sentence
from realitygap.studies.diagnosis.words import (
    NO_REFERENCE,
    leftover_sentence,
    verdict_sentence,
)
from realitygap.studies.pages.page import Box

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
