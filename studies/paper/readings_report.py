"""Everything a finished study of readings is made into."""

from __future__ import annotations

import pandas as pd
import seaborn as sns
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from realitygap.studies.pages.page import VERDICTS, PageTable, Section, number, write_page
from realitygap.studies.paper import figures
from realitygap.studies.paper.conditions import LABELS, PlannedRun, StudyConfig
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.readings import VARIANTS, depends, mean_food, weigh_readings
from realitygap.studies.paper.report import (
    CAPTIONS,
    draw,
    settings_sections,
    write_csv,
    write_parquet,
)
from realitygap.studies.paper.tables import collect
from realitygap.studies.plumbing.output import whole_file

CAPTIONS |= {
    "readings-claims": "Every claim (rows) in every variant (columns): green where its 95 % "
    "interval lies wholly where the claim is true, red where it is false, light red where there is "
    "no difference that matters, grey where it is open.",
    "readings-food": "Mean items per run, conditions by variants; empty where a fixed controller "
    "cannot differ from the default.",
}
COLORS = ("#82c99b", "#d98880", "#e5b8a8", "#d5d8dc")
"""Of `VERDICTS`."""
TEXT = (
    "Variants: sdS-RULE has S0 mutated with standard deviation S and genes out of range treated "
    "by RULE; default is sd0.2-clamp; literal broadcasts the S0 that has already moved on, with "
    "the printed standard deviation; neutral draws S0's parent regardless of fitness; lampR has a "
    "lamp whose contrast fades at R metres, the default at 0.8.",
    "A claim depends on the reading, or on the lamp, if it holds in one variant and fails in "
    "another. One that holds in the neutral variant too needs no selection and proves nothing.",
)


def write_readings(directory: StudyDirectory[StudyConfig, PlannedRun]) -> pd.DataFrame:
    """Make everything from the runs of a finished study; returns what the claims depend on."""
    out, study = directory.out, directory.study
    tables = collect(directory)
    weighed = weigh_readings(tables)
    dependence, food = depends(weighed), mean_food(tables)
    write_parquet(tables.runs, out / "study.parquet")
    write_parquet(tables.generations, out / "generations.parquet")
    write_csv(weighed, out / "readings.csv")
    write_csv(dependence, out / "dependence.csv")
    figures.style()
    (out / "figures").mkdir(exist_ok=True)
    drawn = [
        draw(_claims(weighed), out / "figures" / "readings-claims"),
        draw(_food(food), out / "figures" / "readings-food"),
    ]
    lead = (
        f"{len(directory.runs)} runs of {study.minutes:g} minutes with {study.robots} robots, "
        f"seed {study.seed}: which claims of section IV depend on how its text is read, which on "
        f"the lamp, and which hold without any selection. {dependence_line(dependence)}"
    )
    with whole_file(out / "report.html", force=True) as part:
        write_page(
            part,
            "Readings of the paper",
            lead,
            [
                Section(
                    "What the claims depend on",
                    (*TEXT, few_runs(study)),
                    tables=[PageTable.of(dependence)],
                ),
                Section("Claims by variant", figures=drawn[:1]),
                Section("Food by variant", figures=drawn[1:]),
                *settings_sections(directory),
            ],
        )
    return dependence


def dependence_line(dependence: pd.DataFrame) -> str:
    """What came out, in one line."""
    reading, lamp = (
        (dependence[f"on the {what}"] == "depends").sum() for what in ("reading", "lamp")
    )
    nothing = (dependence["says"] == "proves nothing").sum()
    return (
        f"Of {len(dependence)} claims {reading} depend on the reading, {lamp} on the lamp, and "
        f"{nothing} hold without selection too."
    )


def few_runs(study: StudyConfig) -> str:
    """What the judgement of a variant rests on."""
    return (
        f"Every variant is judged by {study.runs} runs of {study.minutes:g} minutes and without "
        "correction for the number of claims. Some of what holds or fails here does so by chance, "
        "and what is open may depend as well."
    )


def _claims(weighed: pd.DataFrame) -> Figure:
    """A mosaic of what stands where, the effects written in it."""
    claims = list(dict.fromkeys(weighed["claim"]))
    level = weighed.assign(level=weighed["verdict"].map(VERDICTS.index))
    levels, effects = (
        level.pivot(index="claim", columns="variant", values=values).reindex(
            index=claims, columns=list(VARIANTS)
        )
        for values in ("level", "effect")
    )
    figure = Figure(figsize=(13, 0.32 * len(claims) + 2.0), layout="constrained")
    axes = figure.subplots()
    sns.heatmap(
        levels, cmap=ListedColormap(COLORS), vmin=-0.5, vmax=3.5, annot=effects.map(number),
        fmt="", annot_kws={"size": 7, "color": "#222222"}, linewidths=0.5, cbar=False, ax=axes,
    )  # fmt: skip
    axes.set(xlabel="", ylabel="")
    axes.tick_params(axis="x", rotation=45)
    axes.set_title("Claims by variant (numbers: estimates; green holds, red does not, grey open)")
    return figure


def _food(food: pd.DataFrame) -> Figure:
    figure = Figure(figsize=(13, 4.4), layout="constrained")
    axes = figure.subplots()
    sns.heatmap(
        food.rename(index=LABELS), annot=True, fmt=".0f", cmap="viridis", linewidths=0.5, ax=axes
    )
    axes.set(xlabel="", ylabel="")
    axes.tick_params(axis="x", rotation=45)
    axes.set_title("Mean items per run")
    return figure
