"""The matrix as a page, and as a document, of which docs/conditions.md is a copy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import shorten
from typing import Any

import pandas as pd

from realitygap.studies.blind.conditions import scores
from realitygap.studies.blind.conditions.matrix import CONDITIONS, ILL, STATES
from realitygap.studies.pages.page import PageTable, Section, markdown, write_page
from realitygap.studies.plumbing.output import whole_file

TITLE = "Logs as labs make them"
MISSED = "✗"
SHOWN = 400
"""Letters of an answer on the page; our choice."""
MARK = "<!-- Written by `realitygap blind --conditions` as conditions.md; edit the code alone. -->"
HIDDEN = ", ".join(f"`{name}` ({state})" for state, name in ILL.items())
HOW = [
    "A run is recorded: ten robots, 120 s, nothing hidden, or one effect exactly at its bar in "
    f"one robot or the place: {HIDDEN}. The log is changed as labs change logs, and a process "
    "that has nothing else diagnoses it with the shipped model and reference. A condition knows "
    "nothing of what was hidden. Logs of one number share run and seed under every condition.",
    "No log says what recorded it, not even the one that is otherwise as recorded: a lab's log "
    "would not, and its rows may no longer be those of the recorder.",
    "In another arena nest and lamp stand to its wall as they always do. The ill robot "
    "has an even number, so that it is in the log where every second robot is not. Of robots "
    "whose parts differ, none counts as ill for that.",
]
ACCUSED, NAMED, WRONG, SILENCED = (
    f"{100.0 * bar:.0f} %"
    for bar in (
        scores.MOST_ACCUSED,
        scores.LEAST_NAMED,
        scores.MOST_WRONG,
        scores.MOST_SILENCED,
    )
)
CELLS = [
    "A cell counts robots with nothing hidden that were accused, of those that could be, and, "
    "where something was hidden, logs in which it was rightly named. *Wrong*: logs with a name "
    "that its robots do not have. *Silenced*: logs that cannot show what was hidden, and say so: "
    "the verdict is that the log cannot tell, the cause is not among those looked for, the "
    "pre-flight takes it away, or `detectable` says that only more would have shown, in a robot "
    "that has it, without a name or a rival's name for it. *Refused*: "
    "in one line. *Crashed*: anything else that is no answer; of such logs no robot counts. "
    "*Unexplained*: something is wrong that no known cause explains. A cell is silenced if half "
    "of its logs or more are silenced or refused without a right name. A dash: not tried.",
    f"Bars: at most {ACCUSED} of the healthy robots accused, the right name in {NAMED} of the "
    f"logs that are not silenced, a wrong name in at most {WRONG} of the logs, no crash, and at "
    f"most {SILENCED} of the cells in which something is hidden silenced. {MISSED} marks a cell "
    "that misses one.",
]


def write_pages(out: Path, content: Mapping[str, Any], logs: pd.DataFrame) -> None:
    """Write `report.html` and `conditions.md` into a directory that is there.

    Args:
        out: The directory.
        content: Of `conditions.json`.
        logs: A row per log.
    """
    sections = [
        Section("What is done", HOW),
        Section("The matrix", CELLS, tables=[PageTable.of(matrix(content["cells"]))]),
        Section("Where it came from", [_origin(content)]),
    ]
    if len(bad := failures(logs)):
        sections.insert(2, Section("Every log to look at", tables=[PageTable.of(bad)]))
    lead = _lead(content["summary"])
    plain = [replace(one, texts=[_unmarked(text) for text in one.texts]) for one in sections]
    with whole_file(out / "report.html", force=True) as part:
        write_page(part, TITLE, lead, plain)
    with whole_file(out / "conditions.md", force=True) as part:
        text = f"# {TITLE}\n\n{MARK}\n\n{lead}\n\n{markdown(sections)}"
        part.write_text(text, encoding="utf-8")


def _unmarked(text: str) -> str:
    """A text without what Markdown marks words by."""
    return text.replace("`", "").replace("*", "")


def matrix(cells: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Conditions down, what was hidden across.

    Args:
        cells: Of `scores.cells_of`.
    """
    told = {(one["condition"], one["state"]): _told(one) for one in cells}
    names = [name for name in CONDITIONS if any((name, state) in told for state in STATES)]
    return pd.DataFrame(
        [
            {
                "condition": name,
                "the log": CONDITIONS[name].meaning,
                **{state: told.get((name, state), "–") for state in STATES},
            }
            for name in names
        ]
    )


def failures(logs: pd.DataFrame) -> pd.DataFrame:
    """Every log that crashed, was answered wrongly, or in which what was hidden was missed.

    Args:
        logs: Of `scores.logs_table`.
    """
    bad = logs[logs["failing"]]
    return pd.DataFrame(
        {
            "log": bad["condition"] + "-" + bad["state"] + " " + bad["log"].astype(str),
            "hidden": bad["hidden"],
            "answer": bad["said"].map(lambda said: shorten(said, SHOWN, placeholder=" ...")),
        }
    )


def _told(cell: Mapping[str, Any]) -> str:
    """A cell in a few words."""
    words = []
    if cell["state"] != "healthy":
        words.append(f"named {cell['named']}/{cell['logs']}")
    if cell["healthy"]:
        words.append(f"accused {cell['accused']}/{cell['healthy']}")
    for flag in ("wrong", "silenced", "refused", "crashed", "unexplained"):
        if cell[flag]:
            words.append(f"{flag} {cell[flag]}")
    text = ", ".join(words) or "–"
    return f"{MISSED} {text}" if cell["misses"] else text


def _lead(summary: Mapping[str, int]) -> str:
    return (
        f"{summary['passing']} of {summary['cells']} cells pass. Healthy robots are accused in "
        f"{summary['accused']}, wrong names given in {summary['wrong']}, what is hidden is missed "
        f"in {summary['missed']}, and {summary['crashed']} crash. Of {summary['ill']} cells in "
        f"which something is hidden {summary['silenced']} are silenced."
    )


def _origin(content: Mapping[str, Any]) -> str:
    commit = f", commit {content['commit']}" if content["commit"] else ""
    return (
        f"`{content['command']}`: logs of each cell {content['config']['trials']}, seed "
        f"{content['config']['seed']}, program {content['versions']['program'][:12]}{commit}. "
        "Some conditions alone: `--only NAME`. The log of every row is made anew by the same "
        "command; `logs.csv` holds all answers."
    )
