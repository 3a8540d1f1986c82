"""A diagnosis in sentences."""

from __future__ import annotations

from models.diagnosis import Diagnosis, Unexplained, alternatives, robots_of
from models.identify.swarm import Named
from models.identify.value import Value

VERDICTS = {
    "nothing_wrong": "Nothing wrong: no robot differs from health by more than healthy robots do.",
    "named": "Named",
    "ambiguous": "The log cannot decide",
    "unexplained": "Something is wrong that no known cause explains",
}


def verdict_sentence(found: Diagnosis) -> str:
    """The verdict as one or a few sentences."""
    if found.verdict == "nothing_wrong":
        return VERDICTS["nothing_wrong"]
    said = "; ".join(cause_sentence(one) for one in found.named)
    text = VERDICTS[found.verdict] + (f": {said}." if said else ".")
    return " ".join([text, *(leftover_sentence(one) for one in found.unexplained)])


def leftover_sentence(one: Unexplained) -> str:
    """What no cause explains: who, what, following what, how much."""
    robots = "all robots" if one.robots == "all" else ", ".join(f"robot {r}" for r in one.robots)
    return f"{robots}: {one.where}; {100 * one.share:.1f} % of the squared error, cause unknown."


def cause_sentence(named: Named) -> str:
    """One cause: name, robots, values, rivals."""
    cause = named.term.cause
    which = f" ({named.term.variant})" if named.term.variant else ""
    told = ", ".join(value_text(v) for v in named.values)
    others = alternatives(named)
    rivals = f", or {' or '.join(others)}" if others else ""
    return f"{who(named)}: {cause.name}{which} {told}{rivals}"


def who(named: Named) -> str:
    """Which robots, in words."""
    robots = robots_of(named)
    if robots == "all":
        return "all robots"
    return ("robot " if len(robots) == 1 else "robots ") + ", ".join(str(r) for r in robots)


def value_text(value: Value) -> str:
    """A value with its interval, to the digits that the interval leaves meaningful."""
    unit = "" if value.unit in ("", "1") else f" {value.unit}"
    return f"{value.name} {value.value:.4g} ({value.low:.4g} to {value.high:.4g}){unit}"
