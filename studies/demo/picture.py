"""The story in one picture: how wrong the simulator was, what was found, what it was worth."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from realitygap.models.belief.catalogue import every_cause
from realitygap.studies.demo.story import Story
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY
from realitygap.studies.gain.words import SHOWN
from realitygap.studies.paper import figures

WRONG, RIGHT, SOUND = "#b0413e", "#2a9d8f", "#9aa5b1"
"""The minimal model, the extended one, and healthy robots or fixed controllers."""
WIDTH = 52
"""Letters in a line of the middle panel."""
CHANNELS = {
    "position": "where a robot will be in 1 s",
    "heading": "which way a robot will face in 1 s",
    "infrared": "what a robot's infrared sensors see",
    "light": "what a robot's light sensors see",
    "nest": "where the nest is",
}


def draw_story(story: Story, path: Path) -> None:
    """Write the picture, a PNG."""
    figures.style()
    figure = Figure(figsize=(13, 4.2), layout="constrained")
    wrong, found, food = figure.subplots(1, 3)
    _wrong(wrong, story)
    _found(found, story)
    _food(food, story)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def shown_entry(story: Story) -> dict[str, Any] | None:
    """The channel in which the minimal model is furthest from health; None: nothing measured."""
    entries = [
        one
        for one in (story.gain.content["errors"] if story.gain else ())
        if one["channel"] in CHANNELS and one["horizon"] in ("1 s", None) and one[HEALTHY]
    ]
    return max(
        entries, key=lambda e: e[BEFORE]["value"] / max(e[HEALTHY]["value"], 1e-12), default=None
    )


def _wrong(axes: Axes, story: Story) -> None:
    """Error of prediction before and after, beside sound robots."""
    one = shown_entry(story)
    axes.set_title("1. The robots' simulator was wrong")
    if one is None:
        axes.text(0.5, 0.5, "not measured", ha="center")
        axes.set_axis_off()
        return
    factor, unit = SHOWN.get(one["unit"], (1.0, one["unit"]))
    bars = (
        ("before", one[BEFORE], WRONG),
        ("with what\nwas found", one[EXTENDED], RIGHT),
        ("robots with\nnothing wrong", one[HEALTHY], SOUND),
    )
    for at, (_, estimate, colour) in enumerate(bars):
        if estimate is None:
            continue
        value = factor * estimate["value"]
        ends = [[value - factor * estimate["low"]], [factor * estimate["high"] - value]]
        axes.bar(at, value, color=colour, width=0.65)
        axes.errorbar(at, value, yerr=ends, color="0.2", capsize=4)
        axes.annotate(f"{value:.3g}", (at, value), xytext=(14, 4), textcoords="offset points")
    axes.set_xticks(range(len(bars)), [name for name, *_ in bars])
    axes.set_ylabel(f"mean error ({unit})")
    axes.set_xlabel(f"predicting {CHANNELS[one['channel']]}")


def value_text(value: Mapping[str, Any], unit: str = "") -> str:
    """A value with its interval; a word, as of a sensor, has none."""
    if isinstance(value["value"], str) or value.get("low") is None:
        return f"{value['value']}{unit}"
    return f"{value['value']:.3g}{unit} ({value['low']:.3g} to {value['high']:.3g})"


def unit_of(name: str, key: str) -> str:
    """A parameter's unit, with a space before it; empty where it has none."""
    unit = {p.name: p.unit for p in every_cause()[name].parameters}.get(key, "")
    return "" if unit in ("", "1") else f" {unit}"


def _found(axes: Axes, story: Story) -> None:
    """What was named and how large, beside what was hidden."""
    axes.set_title("2. From their log alone it was found out why")
    axes.set_axis_off()
    score, hidden = story.score, story.secret.hidden
    assert score is not None
    causes = [] if story.diagnosis is None else story.diagnosis["causes"]
    lines = [("Hidden from the program:", "0.35")]
    lines += [(part, "0.05") for part in textwrap.wrap(story.secret.plainly, WIDTH)]
    lines += [(f"    {hidden.name}", "0.05")]
    lines += [
        (f"    {key} = {value}{unit_of(hidden.name, key)}", "0.05")
        for key, value in hidden.values.items()
    ]
    lines += [("Named by the program:", "0.35")]
    for cause in causes[:3]:
        rivals = cause["alternatives"] if score.verdict != "named" else []
        own = cause["name"] == hidden.name
        colour = RIGHT if own else WRONG
        lines.append(("    " + " or ".join([cause["name"], *rivals]), colour))
        lines += [
            (f"    {key} = {value_text(v, unit_of(cause['name'], key))}", colour)
            for key, v in cause["parameters"].items()
        ]
    if not causes:
        lines.append((story.failure or "nothing", WRONG))
    right = "✓ the right cause" if score.exact else "✗ not exactly what was hidden"
    lines.append((right, RIGHT if score.exact else WRONG))
    for at, (text, colour) in enumerate(lines):
        axes.text(0.03, 0.97 - 0.083 * at, text, color=colour, transform=axes.transAxes, va="top")


def _food(axes: Axes, story: Story) -> None:
    """Items per minute before and after, with what the fixed controllers bring."""
    axes.set_title("3. What it was worth in food")
    pairs = zip(story.food(story.before), story.food(story.after), strict=True)
    values = [story.food(story.before), story.food(story.after)]
    low, high = min(story.bars.values()), max(story.bars.values())
    axes.axhspan(low, high, color=SOUND, alpha=0.3, zorder=0)
    axes.annotate(
        "fixed controllers, from worst to best", (-0.55, high), xytext=(0, 4), ha="left",
        textcoords="offset points", fontsize=8, color="0.35",
    )  # fmt: skip
    for at, (runs, colour) in enumerate(zip(values, (WRONG, RIGHT), strict=True)):
        axes.bar(at, sum(runs) / len(runs), color=colour, width=0.55, zorder=2)
    for pair in pairs:
        axes.plot((0, 1), pair, color="0.25", marker="o", markersize=4, linewidth=1.0, zorder=3)
    axes.set_xticks((0, 1), ("swarm evolving in the\nwrong simulator", "in the corrected one"))
    axes.set_xlim(-0.6, 1.6)
    axes.set_ylim(bottom=0.0, top=1.15 * max(high, *values[0], *values[1], 0.1))
    axes.set_ylabel("items brought home per minute")
