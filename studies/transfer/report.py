"""Everything a transfer study is made into: transfer.json, tables, figures, one page."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from realitygap.models.belief.modelfile import load_models
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.paper import figures
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.report import write_csv
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import write_json
from realitygap.studies.run.altered import MODEL
from realitygap.studies.run.experiment import HALVES
from realitygap.studies.transfer import beliefs, words
from realitygap.studies.transfer.alterations import Alteration
from realitygap.studies.transfer.compare import compare
from realitygap.studies.transfer.measures import TRIALS, bar, choices, collect, earnings
from realitygap.studies.transfer.measures import Table as Earnings
from realitygap.studies.transfer.plan import MODELS, TransferConfig, TransferRun

SCHEMA = 1
COLOURS = {"minimal": "#9aa5b1", "extended": "#2a9d8f", "oracle": "#33658a"}
FOOD = (
    "Items per minute of single runs (points; lines join runs of one seed) and their means (bars), "
    "by the model on board. The dotted line is the best fixed controller's mean."
)


def write_report(directory: StudyDirectory[TransferConfig, TransferRun]) -> dict[str, Any]:
    """Make everything from the runs; returns the content of `transfer.json`."""
    out, study = directory.out, directory.study
    table = collect(directory)
    compared = compare(table, study.seed)
    picks = {one.name: _choices(one, study, out) for one in study.alterations}
    found = {one.name: beliefs.diagnosis_of(_folder(out, one)) for one in study.alterations}
    content = {
        "schema": SCHEMA,
        "configuration": study.model_dump(mode="json"),
        "alterations": [
            {
                "name": one.name,
                "label": one.label,
                "control": one.control,
                "case": one.case,
                "effects": list(one.effects),
                "diagnosed": words.diagnosed(found[one.name]),
                "bar": dict(zip(("controller", "food"), _bar(table, one.name), strict=True)),
                "comparisons": _plain(compared[compared["alteration"] == one.name]),
                "choices": picks[one.name],
                "reason": words.reason(picks[one.name]),
            }
            for one in study.alterations
        ],
    }
    with whole_file(out / "transfer.json", force=True) as part:
        write_json(part, content)
    write_csv(table, out / "runs.csv")
    write_csv(compared, out / "transfer.csv")
    _page(directory, table, compared, content)
    return content


def _folder(out: Path, one: Alteration, kind: str = "extended") -> Path:
    return out / "models" / f"{one.name}.{kind}"


def _bar(table: pd.DataFrame, name: str) -> tuple[str, float | None]:
    controller, food = bar(table, name)
    return controller, None if math.isnan(food) else food


def _choices(one: Alteration, study: TransferConfig, out: Path) -> list[dict[str, Any]]:
    """What each model picks among nine controllers."""
    sources = {
        "minimal": None,
        "extended": _folder(out, one) / MODEL,
        "oracle": _folder(out, one, "oracle") / MODEL,
    }
    believed: dict[str, Earnings] = {
        name: earnings(load_models(source, study.robots), study.seed)
        for name, source in sources.items()
    }
    return choices(believed, HALVES[one.case][0])


def _plain(rows: pd.DataFrame) -> list[dict[str, Any]]:
    """Rows as JSON, without the alteration's name; null for what does not exist."""
    return [
        {
            str(k): None if isinstance(v, float) and not math.isfinite(v) else v
            for k, v in row.items()
            if k != "alteration"
        }
        for row in rows.to_dict("records")
    ]


def _page(
    directory: StudyDirectory[TransferConfig, TransferRun],
    table: pd.DataFrame,
    compared: pd.DataFrame,
    content: dict[str, Any],
) -> None:
    out, study = directory.out, directory.study
    folder = out / "figures"
    folder.mkdir(exist_ok=True)
    figures.style()
    figures.save(draw(table, study), folder / "food")
    rows = {one.name: words.find(compared, one.name, "food") for one in study.alterations}
    told = [
        (
            f"{words.food_line(one, rows[one.name])} Diagnosed from the log alone: "
            f"{entry['diagnosed']}. {entry['reason']}"
        )
        for one, entry in zip(study.alterations, content["alterations"], strict=True)
    ]
    lead = (
        f"{len(study.alterations)} altered realities, {study.runs} paired runs of "
        f"{study.minutes:g} minutes with {study.robots} robots and each model on board; "
        f"{study.trials} embedded trials per genome ({study.genome}). {words.outcome(content)}"
    )
    picks = pd.DataFrame(
        [{"altered": e["name"], **p} for e in content["alterations"] for p in e["choices"]]
    )
    names = {"believed": "believes it earns (s)", "true": "earns (s)", "best": "best of nine (s)"}
    with whole_file(out / "report.html", force=True) as part:
        write_page(
            part,
            "Does a better model bring more food?",
            lead,
            [
                Section("Food", told, figures=[Picture(folder / "food.png", FOOD)]),
                Section("All comparisons", (METHOD,), tables=[PageTable.of(compared)]),
                Section(
                    "What each model would choose among nine controllers",
                    (CHOICES,),
                    tables=[PageTable.of(picks.rename(columns=names))],
                ),
            ],
        )


METHOD = (
    "First less second, runs paired by seed. F_R and F_S are means over generations and robots, "
    "the gap is F_S - F_R; right_third is the share of robots whose S0 names the scenario set up; "
    "minutes_to_adapt is the first minute from which three bring three quarters of the best fixed "
    "controller's food, and a run's length where none does."
)
CHOICES = (
    f"Nine controllers (with food / without), {TRIALS} simulated minutes each. The oracle's model "
    "is taken for the truth of the altered world; robots are alone there."
)


def draw(table: pd.DataFrame, study: TransferConfig) -> Figure:
    """Food by model, a panel per alteration."""
    columns = min(5, len(study.alterations))
    rows = math.ceil(len(study.alterations) / columns)
    figure = Figure(figsize=(2.9 * columns, 3.2 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(study.alterations) :]:
        panel.set_visible(False)
    for panel, one in zip(panels, study.alterations, strict=False):
        part = table[table["alteration"] == one.name]
        wide = part[part["model"].isin(MODELS)].pivot(index="index", columns="model", values="food")
        wide = wide.reindex(columns=list(MODELS))
        panel.bar(MODELS, wide.mean().fillna(0.0), color=[COLOURS[m] for m in MODELS], width=0.7)
        panel.plot(list(MODELS), wide.T.to_numpy(), color="0.3", marker=".", linewidth=0.5)
        controller, food = bar(table, one.name)
        if controller:
            panel.axhline(food, color="0.2", linestyle=":", linewidth=1.2)
        panel.set_title(one.name + (" (control)" if one.control else ""))
        panel.set_ylim(bottom=0.0)
        panel.tick_params(axis="x", labelrotation=20)
    panels[0].set_ylabel("items per minute")
    return figure
