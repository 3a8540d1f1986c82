"""`report.html` of a gap: what the simulation gets wrong, on one page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.studies.gap.words import WORDS, group_text, size
from realitygap.studies.pages.page import Box, PageTable, Picture, Section, number, write_page

OFF = "The model is off by more than noise."
CAPTIONS = {
    "horizons": "How far a prediction is off, against how far ahead (s): of single robots and runs "
    "(thin), their median, 95 % of it, and what the tracker's noise alone would give.",
    "arena": "Where in the arena predictions are off over a second.",
    "maps": "Mean error over a second by what a robot did and where it was, with two standard "
    "errors. Red: beyond chance.",
    "shares": "Of what the mean square error consists: noise, a constant offset, and what follows "
    "something measured.",
    "sensors": "What sensors read beyond what is predicted of them, in counts.",
    "coevolution": "Fitness (s) in the simulator against fitness in reality, generation by "
    "generation, by whether the simulator's third of the light was right.",
}
"""By name of the figure."""
PLACES = {
    "How far off": ("horizons",),
    "Where and when": ("arena", "maps"),
    "Of what errors consist": ("shares",),
    "The sensors": ("sensors",),
    "Fitness in simulation and reality": ("coevolution",),
}
"""Figures by section."""
UNLIKE = (
    "The largest deviation of each robot from the swarm under like commands; a chance below "
    "{level:g} is beyond what robots that are alike would show."
)


def write_report(content: Mapping[str, Any], folder: Path) -> None:
    """Write the page of what `gap.json` holds, with the figures that lie in the folder."""
    sections = [_figures(folder, title, names) for title, names in PLACES.items()]
    replayed = "log" in content
    if replayed:
        sections[0] = _horizons(content, sections[0])
        sections += [_robots(content), _not_judged(content), _channels(content)]
    sections.append(_origin(content))
    full = [one for one in sections if one.figures or one.tables or one.points or one.texts]
    write_page(folder / "report.html", "The gap", _box(content), full)


def _box(content: Mapping[str, Any]) -> Box:
    summary = list(content["summary"])
    if "flagged" not in content:
        return Box("open", summary[0], summary[1:])
    if content["flagged"]:
        return Box("fault", OFF, summary)
    return Box("sound", summary[0], summary[1:])


def _figures(folder: Path, title: str, names: tuple[str, ...]) -> Section:
    there = [name for name in names if (folder / f"{name}.png").is_file()]
    return Section(title, figures=[Picture(folder / f"{n}.png", CAPTIONS[n]) for n in there])


def _horizons(content: Mapping[str, Any], drawn: Section) -> Section:
    """The figure with its numbers."""
    rows = []
    for one in content["horizons"]:
        row = {"ahead": one["horizon"], "windows": one["windows"]}
        for channel in ("position", "heading"):
            told = one[channel]
            for key, words in (("median", "median"), ("p95", "95 %"), ("noise", "noise alone")):
                row[f"{channel}, {words}"] = size(told[key], told["unit"])
        rows.append(row)
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section(drawn.title, figures=drawn.figures, tables=tables)


def _robots(content: Mapping[str, Any]) -> Section:
    rows = [
        {
            "robot": one["robot"],
            "deviates in": WORDS.get(one["channel"], one["channel"]),
            "where": _where(one["condition"], one["group"]),
            "chance": number(float(one["p"])),
            "unlike the others": "yes" if one["flagged"] else "no",
        }
        for one in content["robots"]
    ]
    if not rows:
        return Section("Robot by robot")
    text = UNLIKE.format(level=content["level"])
    return Section("Robot by robot", [text], tables=[PageTable.of(pd.DataFrame(rows))])


def _where(condition: str, group: str) -> str:
    if condition == "all":
        return "anywhere"
    return f"{WORDS.get(condition, condition)} {group_text(condition, group)}"


def _not_judged(content: Mapping[str, Any]) -> Section:
    log = content["log"]
    return Section(
        "What was repaired, and what was not judged", points=[*log["notes"], *log["not_judged"]]
    )


def _channels(content: Mapping[str, Any]) -> Section:
    rows = [
        {
            "channel": one["channel"],
            "ahead": one["horizon"],
            "rms": size(one["rms"], one["unit"]),
            "of noise": size(one["noise_rms"], one["unit"]),
            **{name: f"{100 * share:.0f} %" for name, share in one["shares"].items()},
            "chance": number(float(one["p"])),
        }
        for one in content["channels"]
    ]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("Every channel", tables=tables, folded=True)


def _origin(content: Mapping[str, Any]) -> Section:
    points = [
        f"{one['option']} {one['file']}, SHA-256 {one['sha256']}" for one in content["inputs"]
    ]
    return Section("Where this comes from", points=points, folded=True)
