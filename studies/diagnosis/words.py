"""A diagnosis in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from realitygap.models.belief.catalogue import causes, every_cause
from realitygap.models.log.named import Names
from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.naming.channels.motion.detectable import core
from realitygap.models.naming.diagnosis import (
    Detectable,
    Diagnosis,
    Gain,
    Unexplained,
    alternatives,
)
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Named
from realitygap.models.naming.rules import Rules
from realitygap.studies.pages.page import number

VERDICTS = {
    "nothing_wrong": "Nothing wrong: no robot differs from health by more than healthy robots do.",
    "cannot_tell": "The log cannot tell whether anything is wrong",
    "named": "Named",
    "ambiguous": "The log cannot decide",
    "unexplained": "Something is wrong that no known cause explains",
}
SEEN = "Something is wrong that no known cause accounts for well enough to predict by"
"""Where nothing but causes that are not exported was found."""
NO_REFERENCE = "There was no healthy reference: whatever this kind of robot does counts as a fault."
UNKNOWN_HEALTH = (
    "Nothing wrong by the model alone: no robot differs from what it predicts. How healthy robots "
    "differ from it is not known."
)


def verdict_sentence(found: Diagnosis) -> str:
    """The verdict as one or a few sentences."""
    if found.verdict == "nothing_wrong":
        return VERDICTS["nothing_wrong"] if found.reference else UNKNOWN_HEALTH
    unknown = [] if found.reference else [NO_REFERENCE]
    if found.verdict == "cannot_tell":
        return " ".join([f"{VERDICTS['cannot_tell']}: {untold_sentence(found)}", *unknown])
    begin, said = VERDICTS[found.verdict], found.named
    if found.verdict == "unexplained":
        begin = begin if found.unexplained else SEEN
        said = tuple(one for one in found.named if not one.exported)
    elif found.verdict == "ambiguous":
        said = tuple(one for one in found.named if alternatives(one))
    sure = tuple(one for one in found.named if one not in said)
    beside = [f"Beside it is named: {_causes(sure, found.names)}."] if sure else []
    text = begin + (f": {_causes(said, found.names)}." if said else ".")
    left = [leftover_sentence(one, found.names) for one in found.unexplained]
    return " ".join([text, *left, *beside, *unknown])


def _causes(named: Sequence[Named], names: Names) -> str:
    return "; ".join(cause_sentence(one, names) for one in named)


def untold_sentence(found: Diagnosis) -> str:
    """Which robots cannot be called sound, and which causes could be unseen in them."""
    by_causes: dict[tuple[str, ...], list[int]] = {}
    for robot, names in found.untold.items():
        by_causes.setdefault(names, []).append(robot)
    said = []
    for names, robots in by_causes.items():
        sizes = ", ".join(f"{name} of {_core(name, found.rules)}" for name in names)
        everyone = len(robots) == len(found.robots) > 1
        where = "any robot" if everyone else _listed(robots, found.names)
        said.append(f"in {where} {sizes} could be unseen")
    return "; ".join(said) + "."


def _core(name: str, rules: Rules) -> str:
    parameter = causes()[name].parameters[0]
    return _amount(core(rules)[name], parameter.null, parameter.unit)


def detectable_sentence(found: Sequence[Detectable]) -> str:
    """What would have shown, and what would not, worst robot."""
    shown = "; ".join(f"{one.cause} {_from(one)}" for one in found if one.size is not None)
    unseen = ", ".join(one.cause for one in found if one.size is None)
    said = [f"In any robot these would have shown: {shown}."] if shown else []
    said += [f"These would not have shown in every robot: {unseen}."] if unseen else []
    return " ".join(said)


def _from(one: Detectable) -> str:
    assert one.size is not None
    if one.null is None:
        return f"{one.parameter} below {one.size:.3g} {one.unit}"
    parameter = next(p for p in every_cause()[one.cause].parameters if p.name == one.parameter)
    if parameter.sign < 0:
        unit = "" if one.unit == "1" else f" {one.unit}"
        return f"{one.parameter} below {one.null - one.size:.2g}{unit}"
    return f"above {_amount(one.size, one.null, one.unit)}"


def _amount(size: float, null: float, unit: str) -> str:
    """A departure from a null: of a factor in per cent."""
    if null == 1.0:
        return f"{100.0 * size:.2g} %"
    return f"{size:.2g}" + ("" if unit in ("", "1") else f" {unit}")


def leftover_sentence(one: Unexplained, names: Names) -> str:
    """What no cause explains: who, what, following what, how much."""
    robots = "all robots" if one.robots == "all" else _listed(one.robots, names)
    return f"{robots}: {one.where}; {100 * one.share:.1f} % of the squared error, cause unknown."


def cause_sentence(named: Named, names: Names) -> str:
    """One cause: name, robots, values, rivals, and why it is not exported."""
    cause = named.term.cause
    which = f" ({named.term.variant})" if named.term.variant else ""
    told = ", ".join(value_text(v) for v in named.values)
    others = alternatives(named)
    rivals = f", or {' or '.join(others)}" if others else ""
    why = "" if named.exported else f" ({named.why})"
    return f"{who(named, names)}: {cause.name}{which} {told}{rivals}{why}"


def who(named: Named, names: Names) -> str:
    """Which robots, in words."""
    return "all robots" if named.whole_swarm else _listed(named.robots, names)


def _listed(robots: Sequence[int], names: Names) -> str:
    return ("robot " if len(robots) == 1 else "robots ") + ", ".join(names[r] for r in robots)


def value_text(value: Value) -> str:
    """A value with its interval, to the digits that the interval leaves meaningful."""
    unit = "" if value.unit in ("", "1") else f" {value.unit}"
    return f"{value.name} {value.value:.4g} ({value.low:.4g} to {value.high:.4g}){unit}"


def entry_text(one: PreflightEntry) -> str:
    """A value of the pre-flight with its unit and interval."""
    if one.value is None:
        return "not told"
    if isinstance(one.value, bool):
        return "yes" if one.value else "no"
    if isinstance(one.value, str):
        return one.value
    interval = "" if one.low is None else f" ({one.low:.3g} to {one.high:.3g})"
    return f"{one.value:.4g}{interval}" + ("" if one.unit == "1" else f" {one.unit}")


def follows_text(one: PreflightEntry) -> str:
    """What follows from it."""
    said = ": ".join(part for part in (one.follows, one.why) if part)
    return said + (f" ({', '.join(one.causes)})" if one.causes else "")


def gain_row(name: str, gain: Gain) -> dict[str, str | None]:
    """One line of the table of gains; lengths in mm, angles in mrad."""
    what, _, when = name.partition("_")
    ahead = f" {when.removesuffix('s')} s ahead" if when != "reading" else " readings"
    scale, unit = (1.0, gain.unit) if gain.unit == "counts" else (1e3, f"m{gain.unit}")
    before, after, low, high = (
        number(scale * value) for value in (gain.before, gain.after, gain.low, gain.high)
    )
    return {
        "mean error of": f"{what}{ahead} ({unit})",
        "before": before,
        "extended model (95 %)": f"{after} ({low} to {high})",
        "of a healthy robot": None if gain.healthy is None else number(scale * gain.healthy),
    }
