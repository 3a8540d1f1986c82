"""A gain in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from realitygap.studies.gain.food import food_lines
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE

SHOWN = {"m": (1e3, "mm"), "rad": (1e3, "mrad"), "counts": (1.0, "counts"), "share": (100.0, "%")}
"""Factor and unit that errors are shown in."""
LABELS = {
    BEFORE: "minimal model",
    HEALTHY: "healthy robots, minimal model",
    EXTENDED: "extended model",
    ORACLE: "true parameters",
}
NOTHING = (
    "Nothing was there to gain: no error of the minimal model is larger than it is for healthy "
    "robots by more than chance."
)
NO_HEALTHY = (
    "There is no healthy level (every robot of these logs is concerned, and no log of sound robots "
    "was given with --healthy), so that no share of the gap can be stated."
)
NO_ORACLE = "The true parameters are not known, so that there is no column for them."


def number(estimate: Mapping[str, float] | None, unit: str) -> str:
    """A value with its interval, in the unit that is shown."""
    if estimate is None:
        return "–"
    factor, name = SHOWN.get(unit, (1.0, unit))
    value, low, high = (factor * estimate[key] for key in ("value", "low", "high"))
    return f"{value:.3g} {name} ({low:.3g} to {high:.3g})"


def percent(estimate: Mapping[str, float] | None) -> str:
    """A share with its interval."""
    if estimate is None:
        return "–"
    value, low, high = (100.0 * estimate[key] for key in ("value", "low", "high"))
    return f"{value:.0f} % ({low:.0f} to {high:.0f})"


def reduced(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Entries whose error is larger than healthy robots', the largest departure first; the single
    sensors are left to their sense."""
    found = [
        one
        for one in content["errors"]
        if one["closed"] is not None and not one["channel"][-1].isdigit()
    ]
    return sorted(found, key=lambda one: -one[BEFORE]["value"] / max(one[HEALTHY]["value"], 1e-300))


def told(one: Mapping[str, Any]) -> str:
    """An entry in a sentence."""
    ahead = f" {one['horizon']} ahead" if one["horizon"] not in (None, "step") else ""
    if one["horizon"] == "step":
        ahead = " one row ahead"
    texts = [f"{LABELS[k]} {number(one[k], one['unit'])}" for k in LABELS if one[k] is not None]
    share = f"; {percent(one['closed'])} of the reducible gap closed" if one["closed"] else ""
    return f"{one['channel']}{ahead}: {', '.join(texts)}{share}."


def summary(content: Mapping[str, Any]) -> list[str]:
    """What was gained, what remains, what is not known, how logs were read."""
    found = reduced(content)
    first = [one for one in found if one["horizon"] in ("1 s", None)]
    lines = [told(one) for one in (first or found)[:3]]
    if content["healthy"] is None:
        lines += [told(one) for one in content["errors"][:2]] + [NO_HEALTHY]
    elif not found:
        lines.append(NOTHING)
    left = [
        one for one in content["errors"]
        if one["remains"] and one["remains"]["low"] > 0 and not one["channel"][-1].isdigit()
    ]  # fmt: skip
    if left:
        worst = max(left, key=lambda one: one["remains"]["value"] / one[HEALTHY]["value"])
        ahead = f" {worst['horizon']} ahead" if worst["horizon"] else ""
        beyond = number(worst["remains"], worst["unit"])
        lines.append(f"What remains, most of it in {worst['channel']}{ahead}: {beyond} too much.")
    if not content["oracle"]:
        lines.append(NO_ORACLE)
    lines += [
        f"{run['run']}: {note}."
        for run in content["held_out"]["runs"]
        for note in run.get("notes", ())
    ]
    if content["transfer"] is not None:
        lines += food_lines(content["transfer"])
    return lines
