"""The demo's page: one picture first, then chapter by chapter."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from realitygap.studies.demo.picture import draw_story, value_text
from realitygap.studies.demo.story import Story, gap_line
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE
from realitygap.studies.gain.words import LABELS, number, percent
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.replay.watch import watch
from realitygap.studies.run.altered import MODEL
from realitygap.studies.run.picture import draw_run, items_per_minute

IN_ONE_PICTURE = (
    "Left: how far predictions are off, in fresh runs that nothing was named from. Middle: what "
    "was hidden and what was named. Right: food in runs of the same seeds (lines)."
)
RUN_BEFORE = (
    "The first co-evolution: where the robots went, the food they brought home, and what their "
    "simulators believed of the lamp."
)
RUN_AFTER = "The same seed with the corrected simulator on board."

WATCH_BEFORE = (
    "replay-before.html",
    "Watch it: ghosts show where the wrong simulator says the robots are.",
)
WATCH_AFTER = (
    "replay-after.html",
    "Watch it: ghosts show where the corrected simulator says the robots are.",
)


def write_report(story: Story, out: Path) -> None:
    """Write report.html, the picture of the first run as demo.png, and replays into a directory."""
    hidden, runs = _lamps(story), (out / "before", out / "after")
    most = max(items_per_minute(run).max() for run in runs)
    draw_run(runs[0], story.secret.case, out / "demo.png", hidden=hidden, most=most)
    _watched(out, hidden)
    with scratch() as room:
        main, after = room / "story.png", room / "after.png"
        draw_story(story, main)
        draw_run(runs[1], story.secret.case, after, hidden=hidden, most=most)
        write_page(
            out / "report.html",
            "A simulator that learns what it gets wrong",
            _lead(story),
            [
                Section("In one picture", figures=[Picture(main, IN_ONE_PICTURE)]),
                _hidden(story),
                Section(
                    "Co-evolution before",
                    [f"In simulation and in reality: {gap_line(story.before)}."],
                    figures=[Picture(out / "demo.png", RUN_BEFORE)],
                    links=[WATCH_BEFORE],
                ),
                _named(story),
                _predictions(story),
                Section(
                    "Co-evolution after",
                    _food(story),
                    figures=[Picture(after, RUN_AFTER)],
                    links=[WATCH_AFTER],
                ),
            ],
        )


def _lamps(story: Story) -> list[tuple[float, float]]:
    """Where lamps were hidden (m); none if something else was."""
    hidden = story.secret.hidden
    if hidden.name != "second_lamp":
        return []
    return [(float(hidden.values["x"]), float(hidden.values["y"]))]


def _watched(out: Path, hidden: list[tuple[float, float]]) -> None:
    """Write what the page links to: the first run of each co-evolution, with its model's ghosts."""
    extended = out / "diagnosis" / MODEL
    watch(out / "before", out / WATCH_BEFORE[0], hidden=hidden, title="The swarm before")
    watch(
        out / "after",
        out / WATCH_AFTER[0],
        model=extended if extended.is_file() else None,
        hidden=hidden,
        title="The swarm after",
    )


def _lead(story: Story) -> str:
    """The story for a reader who has not read the paper."""
    return (
        f"{story.size.robots} robots look for food. Each carries a small simulator of itself in "
        "which it tries out ways to behave. Something was changed in their world that the "
        f"simulator does not know: {story.secret.plainly}. A program that saw "
        f"nothing but the robots' log had to find out. {story.verdict.capitalize()}."
    )


def _hidden(story: Story) -> Section:
    keys = ", ".join(f"{key} = {value}" for key, value in story.secret.hidden.values.items())
    return Section(
        "What was hidden",
        [
            f"{story.secret.hidden.name}: {keys}. Drawn from seed {story.seed}, written to "
            f"sealed.json before anything else ran (SHA-256 {story.digest}) and read again only "
            "after the diagnosis, the second co-evolution and the gain were done.",
            f"A run with it: realitygap run --case {story.secret.case} "
            f"--effect {story.secret.hidden.spec}",
        ],
    )


def _named(story: Story) -> Section:
    """The diagnosis against the truth."""
    hidden = story.secret.hidden
    causes = [] if story.diagnosis is None else story.diagnosis["causes"]
    rows = [
        {
            "named": cause["name"],
            "robots": str(cause["robots"]),
            "parameter": key,
            "value (95 % interval)": value_text(v),
            "hidden": str(hidden.values[key])
            if cause["name"] == hidden.name and key in hidden.values
            else None,
            "could also be": ", ".join(cause["alternatives"]) or None,
        }
        for cause in causes
        for key, v in cause["parameters"].items()
    ]
    told = (
        f"The diagnosis got {story.size.log_minutes:g} minutes of log of the first run and nothing "
        "else, in a process and a directory of its own."
    )
    failed = [f"It gave no answer: {story.failure}."] if story.diagnosis is None else []
    found = [f"{story.verdict.capitalize()}."]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What was named", [told, *failed, *found], tables=tables)


def _predictions(story: Story) -> Section:
    """Errors by channel and horizon."""
    entries = [] if story.gain is None else story.gain.content["errors"]
    rows = [
        {
            "predicted": one["channel"],
            "ahead": one["horizon"],
            **{
                LABELS[name]: number(one[name], one["unit"])
                for name in (BEFORE, EXTENDED, HEALTHY, ORACLE)
            },
            "gap closed": percent(one["closed"]),
        }
        for one in entries
        if not one["channel"][-1].isdigit()
    ]
    told = (
        "Mean absolute errors with 95 % intervals, in fresh runs with other seeds and controllers. "
        "The level of healthy robots is what can be reached."
    )
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("Prediction before and after", [told], tables=tables)


def _food(story: Story) -> list[str]:
    """Food before and after, and what may be said of so few runs."""
    before, after = story.food(story.before), story.food(story.after)
    wins = sum(b > a for a, b in zip(before, after, strict=True))
    bars = ", ".join(f"{name} {food:.1f}" for name, food in story.bars.items())
    return [
        f"{sum(before) / len(before):.1f} items per minute before, {sum(after) / len(after):.1f} "
        f"after; more in {wins} of {len(before)} runs of the same seeds. Fixed controllers: "
        f"{bars}.",
        f"{len(before)} pairs of {story.size.minutes:g} minutes show large differences only; "
        "realitygap study transfer measures with intervals. Better prediction brings more food "
        "only where it changes which of the nine controllers is best.",
    ]
