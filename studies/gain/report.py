"""`report.html`: what an extension gained, on one page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter

from realitygap.models.gap.replay import HORIZONS
from realitygap.studies.gain.food import food_lines, food_table
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE
from realitygap.studies.gain.weigh import LEAST_RUNS
from realitygap.studies.gain.words import LABELS, SHOWN, number, percent
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.plumbing.rooms import scratch

DPI = 100
COLOURS = {BEFORE: "#b0413e", HEALTHY: "#7f7f7f", EXTENDED: "#2f6f9f", ORACLE: "#222222"}
BY_HORIZON = (
    "Mean error of prediction against how far ahead, with 95 % intervals{over}. Windows of up "
    "to one second are clear of wall and robots; longer ones nearly always meet some."
)
GREY = " Grey: what the minimal model gets wrong of healthy robots, which an extension can reach."
SENSES = (
    "Mean error of the readings that wall and lamp alone can have caused, sensor by sensor, with "
    "95 % intervals."
)
BY_RUN = "The same one second ahead, run by run: scenarios the cause was not named from included."


def write_report(content: Mapping[str, Any], path: Path) -> None:
    """Write the page of what `gain.json` holds."""
    with scratch() as room:
        sections = [
            _pictures(content, room),
            _numbers(content),
            *_food(content),
            _runs(content),
            _named(content),
        ]
        write_page(path, "Gain", content["summary"][0], sections)


def _pictures(content: Mapping[str, Any], room: Path) -> Section:
    errors = content["errors"]
    drawn = []
    if any(one["kind"] == "motion" for one in errors):
        _draw_horizons(errors, room / "horizons.png")
        grey = GREY if any(one[HEALTHY] for one in errors) else ""
        drawn.append(Picture(room / "horizons.png", BY_HORIZON.format(over=_over(content)) + grey))
    if any(one["kind"] in ("ps", "ls") for one in errors):
        _draw_senses(errors, room / "senses.png")
        drawn.append(Picture(room / "senses.png", SENSES))
    if len(content["held_out"]["runs"]) > 1:
        _draw_runs(content, room / "runs.png")
        drawn.append(Picture(room / "runs.png", BY_RUN))
    return Section("What naming the cause is worth", content["summary"][1:], figures=drawn)


def _over(content: Mapping[str, Any]) -> str:
    """What intervals resample."""
    few = len(content["held_out"]["runs"]) < LEAST_RUNS
    return " over blocks of 5 s of each robot" if few else " over runs"


def _numbers(content: Mapping[str, Any]) -> Section:
    rows = [
        {
            "channel": one["channel"],
            "ahead": one["horizon"],
            **{LABELS[name]: number(one[name], one["unit"]) for name in LABELS},
            "of healthy": None if one["over_healthy"] is None else one["over_healthy"]["value"],
            "gap closed": percent(one["closed"]),
        }
        for one in content["errors"]
    ]
    text = (
        f"Mean absolute errors with 95 % intervals{_over(content)}. The share of the gap closed "
        "is stated only where the minimal model's error is surely larger than it is for healthy "
        "robots."
    )
    return Section("Every channel", [text], tables=[PageTable.of(pd.DataFrame(rows))])


def _food(content: Mapping[str, Any]) -> list[Section]:
    """The gain in food, where a study of it was given."""
    if content["transfer"] is None:
        return []
    table, lines = food_table(content["transfer"]), food_lines(content["transfer"])
    reasons = [f"{one['label']}: {one['reason']}" for one in content["transfer"]["alterations"]]
    return [Section("What it is worth in food", [*lines, *reasons], tables=[PageTable.of(table)])]


def _runs(content: Mapping[str, Any]) -> Section:
    """The held-out runs."""
    held = content["held_out"]
    robots = held["robots"]
    who = "all robots" if robots == "all" else f"robots {', '.join(map(str, robots))}"
    runs = [
        one | {"notes": "; ".join(one["notes"]) or None} if "notes" in one else one
        for one in held["runs"]
    ]
    return Section(
        "The held-out runs",
        [f"Nothing was named from them; judged: {who}."],
        tables=[PageTable.of(pd.DataFrame(runs))],
    )


def _named(content: Mapping[str, Any]) -> Section:
    """The extension and where everything comes from."""
    extended = content["extended"]
    rows = [
        {
            "cause": cause["name"],
            "which": cause["word"] or None,
            "robots": str(cause["robots"]),
            "values": "; ".join(
                f"{name} {p['value']:.4g} {p['unit']}".removesuffix(" 1")
                for name, p in cause["parameters"].items()
            ),
        }
        for cause in extended["causes"]
    ]
    texts = [
        f"Named by: {extended['command'] or 'hand'}.",
        f"From the log with SHA-256 {extended['log'] or 'unknown'}.",
        f"Measured by: {content['command']}.",
    ]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("The extension", texts, tables=tables)


def _draw_horizons(errors: list[dict[str, Any]], path: Path) -> None:
    figure = _figure(10, 3.8)
    for axis, channel in zip(figure.subplots(1, 2), ("position", "heading"), strict=True):
        draw_channel(errors, channel, axis)
    axis.legend(fontsize=8)
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})


def draw_channel(errors: Sequence[Mapping[str, Any]], channel: str, axis: Axes) -> None:
    """Errors of position or heading of every model, by how far ahead."""
    mine = [one for one in errors if one["kind"] == "motion" and one["channel"] == channel]
    mine.sort(key=lambda one: list(HORIZONS).index(one["horizon"]))
    factor, unit = SHOWN[mine[0]["unit"]]
    for k, name in enumerate(name for name in COLOURS if any(one[name] for one in mine)):
        known = [one for one in mine if one[name]]
        x = np.array([list(HORIZONS).index(one["horizon"]) for one in known]) + 0.06 * k
        value, low, high = (
            factor * np.array([one[name][key] for one in known]) for key in ("value", "low", "high")
        )
        reach, colour = [value - low, high - value], COLOURS[name]
        axis.errorbar(x, value, reach, marker="o", capsize=2, color=colour, label=LABELS[name])
    axis.set(yscale="log", ylabel=f"{channel} error ({unit})", xlabel="ahead")
    axis.set_xticks(range(len(HORIZONS)), list(HORIZONS))
    for which in (axis.yaxis.set_major_formatter, axis.yaxis.set_minor_formatter):
        which(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.4)))


def _draw_senses(errors: list[dict[str, Any]], path: Path) -> None:
    kinds = [kind for kind in ("ps", "ls") if any(one["kind"] == kind for one in errors)]
    figure = _figure(10, 3.4)
    for axis, kind in zip(np.atleast_1d(figure.subplots(1, len(kinds))), kinds, strict=True):
        mine = [one for one in errors if one["kind"] == kind and one["channel"][-1].isdigit()]
        for k, name in enumerate(name for name in COLOURS if any(one[name] for one in mine)):
            known = [one for one in mine if one[name]]
            x = np.array([int(one["channel"][-1]) for one in known]) + 0.12 * (k - 1)
            value, low, high = (
                np.array([one[name][key] for one in known]) for key in ("value", "low", "high")
            )
            style = {"color": COLOURS[name], "label": LABELS[name], "linestyle": ""}
            axis.errorbar(x, value, [value - low, high - value], marker="o", capsize=2, **style)
        axis.set(xlabel=f"{kind}0 to {kind}7", ylabel="error (counts)", ylim=(0, None))
    axis.legend(fontsize=8)
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})


def _draw_runs(content: Mapping[str, Any], path: Path) -> None:
    rows = pd.DataFrame(content["by_run"])
    one = rows[(rows["horizon"] == "1 s") & (rows["channel"] == "position")]
    long = one.melt("run", [name for name in COLOURS if name in one], "model", "error").dropna()
    long["error"] *= SHOWN["m"][0]
    figure = _figure(10, 3.2)
    axis = figure.subplots()
    held = {run["run"]: run for run in content["held_out"]["runs"]}
    long["run"] = [_scenario(held.get(run, {}), run) for run in long["run"]]
    long["model"] = long["model"].map(LABELS)
    palette = {LABELS[name]: colour for name, colour in COLOURS.items()}
    style = {"palette": palette, "jitter": False, "dodge": True}
    sns.stripplot(long, x="run", y="error", hue="model", ax=axis, **style)
    axis.set(ylabel="position error 1 s ahead (mm)", ylim=(0, None), xlabel="")
    axis.tick_params(axis="x", labelsize=7)
    axis.legend(fontsize=8, title=None)
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})


def _scenario(run: Mapping[str, Any], name: str) -> str:
    """A recorded run as an axis calls it; another's own name."""
    return f"{name}: {run['controller']},\n{run['case']}" if "controller" in run else name


def _figure(width: float, height: float) -> Figure:
    sns.set_theme(style="whitegrid", font_scale=0.85)
    return Figure(figsize=(width, height), layout="constrained")
