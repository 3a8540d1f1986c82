"""Everything a finished paper study is made into: tables, figures, claims, one page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from realitygap.studies.fitness_gap.generations import PARTS, decompose, fresh_fitness_of
from realitygap.studies.pages.page import PageTable, Picture, Section, markdown, write_page
from realitygap.studies.paper import figures, gap_figures
from realitygap.studies.paper.conditions import PlannedRun, StudyConfig
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.gap_figures import controllers_table, gap_table
from realitygap.studies.paper.mixture import evolved_table
from realitygap.studies.paper.readings import DEFAULT, LAMPS, depends, of_variant, told
from realitygap.studies.paper.results import outcome, result_sections
from realitygap.studies.paper.rounds import NUMBERED, SELECTED, verdicts_by_variant
from realitygap.studies.paper.tables import StudyTables, collect
from realitygap.studies.plumbing.output import whole_file

CAPTIONS = {
    "fig6-food": "Items brought to the nest per run: mean (bars, halves shaded apart), quartiles "
    "and single runs. The last three are the fixed optimal controllers.",
    "fig7-retrieval": "Mean time from picking an item up to bringing it to the nest, per run, "
    "before and after half-time.",
    "fig8-s0": "Left: mean S0 of the swarm, boxed over runs, with the thirds shaded. Right: what "
    "the single robots believe, since a mean near 0.5 also comes from a mixture.",
    "lamp-range": "Claims of Fig. 6 against the lamp's range, which the paper does not give: each "
    "estimate with its interval, and where the claim is true (shaded).",
    "gap-course": "What the deployed controllers were promised by their simulators and what they "
    "earned in reality: by generation, and by what the robot believed.",
    "gap-parts": "The gap split into the winner's curse, the wrong scenario, and model error with "
    "the right scenario.",
}


def write_report(directory: StudyDirectory[StudyConfig, PlannedRun]) -> pd.DataFrame:
    """Make everything from the runs that are there; returns the claims table."""
    out, study = directory.out, directory.study
    everything = collect(directory)
    tables = of_variant(everything, DEFAULT)
    verdicts = verdicts_by_variant(everything, study.runs)
    fresh = fresh_fitness_of(study.model, study.robots, study.seed)
    gaps = decompose(tables.generations, fresh, study.minutes)
    across = [verdicts.pop(name) for name in (SELECTED, NUMBERED) if name in verdicts]
    claims, weighed = pd.concat([verdicts[DEFAULT], *across]), told(verdicts)
    keys = ["condition", "variant", "run"]
    runs = everything.runs.merge(_gap_of_runs(gaps), on=keys, how="left")
    write_parquet(runs, out / "study.parquet")
    write_parquet(everything.generations, out / "generations.parquet")
    made = {
        "claims": claims,
        "evolved": evolved_table(tables),
        "gap": gap_table(gaps),
        "controllers": controllers_table(fresh.mean(axis=0)),
    }
    if len(verdicts) > 1:
        made |= {"readings": weighed, "dependence": depends(weighed)}
    for name, frame in made.items():
        write_csv(frame, out / f"{name}.csv")
    results = result_sections(study, out)
    with whole_file(out / "results.md", force=True) as part:
        part.write_text(markdown(results), encoding="utf-8")
    drawn = _figures(tables, gaps, out / "figures")
    ranges = []
    if weighed["variant"].isin(LAMPS).any():
        ranges.append(draw(figures.lamps(weighed, claims), out / "figures" / "lamp-range"))
    with whole_file(out / "report.html", force=True) as part:
        write_page(
            part,
            "The paper's study, repeated",
            lead_line(directory, claims),
            [
                Section("Food collected", figures=[drawn["fig6-food"]]),
                Section("Collection rate", figures=[drawn["fig7-retrieval"]]),
                Section("What the robots believe", figures=[drawn["fig8-s0"]]),
                *results[:-1],
                replace(results[-1], figures=[drawn["gap-course"], drawn["gap-parts"]]),
                *([Section("The lamp's range", figures=ranges)] if ranges else []),
                *settings_sections(directory),
            ],
        )
    return claims


def lead_line(directory: StudyDirectory[StudyConfig, PlannedRun], claims: pd.DataFrame) -> str:
    """What was run and how it came out, in two sentences."""
    study = directory.study
    board = f", the model {Path(study.model).name} on board" if study.model else ""
    return (
        f"{len(directory.runs)} runs of {study.minutes:g} minutes with {study.robots} robots, "
        f"seed {study.seed}{board}. {outcome(claims)}"
    )


def settings_sections(directory: StudyDirectory[StudyConfig, PlannedRun]) -> list[Section]:
    """Settings, versions, computing time and seeds."""
    notes: dict[str, Any] = directory.notes
    facts = {**notes["configuration"], **notes["versions"]}
    settings = pd.DataFrame({"setting": list(facts), "value": [str(v) for v in facts.values()]})
    seeds = pd.DataFrame(
        [
            {"run": run.name, "case": run.config.case, "controller": run.config.controller}
            | {"seed": str(run.config.seed)}
            for run in directory.runs
        ]
    )
    took = [
        f"{session['runs']} runs, {session['simulated_hours']:.1f} simulated hours in "
        f"{session['wall_seconds'] / 60.0:.1f} minutes on {session['workers']} workers, which were "
        f"computing {100.0 * session['worker_share']:.0f} % of that time; cores busy: "
        + (", ".join(f"{100.0 * busy:.0f} %" for busy in session["cores_busy"]) or "unknown")
        + "."
        for session in directory.sessions
    ]
    repeat = (
        "A run of the default reading and lamp is repeated by: "
        "realitygap run --case … --controller … --seed … --no-samples"
    )
    return [
        Section("Settings, versions, computing", took, tables=[PageTable.of(settings)]),
        Section("Seeds", (repeat,), tables=[PageTable.of(seeds)]),
    ]


def write_csv(frame: pd.DataFrame, path: Path) -> None:
    """A small table, whole or not at all."""
    with whole_file(path, force=True) as part:
        frame.to_csv(part, index=False, lineterminator="\n", float_format="%.6g")


def draw(figure: Figure, path: Path) -> Picture:
    """Save a figure and say where it is."""
    figures.save(figure, path)
    return Picture(path.with_suffix(".png"), CAPTIONS[path.name])


def _figures(tables: StudyTables, gaps: pd.DataFrame, folder: Path) -> dict[str, Picture]:
    folder.mkdir(exist_ok=True)
    figures.style()
    drawn = {
        "fig6-food": figures.food(tables),
        "fig7-retrieval": figures.retrieval(tables),
        "fig8-s0": figures.beliefs(tables),
        "gap-course": gap_figures.course(gaps),
        "gap-parts": gap_figures.parts(gaps),
    }
    return {name: draw(figure, folder / name) for name, figure in drawn.items()}


def _gap_of_runs(gaps: pd.DataFrame) -> pd.DataFrame:
    """Mean gap and parts of each run."""
    means = gaps.groupby(["condition", "variant", "index"])[["gap", *PARTS]].mean()
    names = {"index": "run", **{part: f"gap_{part}" for part in PARTS}}
    return means.reset_index().rename(columns=names)


def write_parquet(frame: pd.DataFrame, path: Path) -> None:
    """A table for pandas, whole or not at all."""
    with whole_file(path, force=True) as part:
        frame.to_parquet(part, index=False)
