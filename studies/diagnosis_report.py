"""The report of a diagnosis: one self-contained page for whoever must repair a robot."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from models.causes import causes
from models.diagnosis import alternatives
from models.identify.examination import Examination
from models.senses.joined import WholeExamination
from studies import diagnosis_figures as figures
from studies import sense_figures
from studies.diagnosis_words import leftover_sentence, value_text, verdict_sentence, who
from studies.next_experiment import next_section
from studies.paper.page import Picture, Section, Table, write_page

CHECKED = (
    "Every cause of the catalogue was tried on every robot whose path differs from health at a "
    "first look, alone and together with others. A cause is named only if it lowers the error on "
    "parts of the log that it was not fitted to, and if its value lies further from health than "
    "any healthy robot's does."
)
BEFORE_AFTER = (
    "How far the predicted position is off, from each measured pose on: by the model alone, by a "
    "healthy robot of this kind (the model with the healthy reference), and with what was found. "
    "Left: the robots concerned; right: every robot."
)
RIVALS = (
    "What each cause takes off the error on held-out parts of the log when it is tried in the "
    "named one's place. The longer its bar against the others, the surer the name."
)
PROFILES = (
    "Deviance (twice the negative log likelihood) against the named value; the shaded band is the "
    "95 % interval, which also holds how much healthy robots differ."
)
LEFT = (
    "What is left after everything found: for each measured quantity, how far from health the "
    "part of speed, bend or turning is that follows it. Above about six it is reported as "
    "unexplained."
)

LEFT_IN_SENSES = (
    "The same for the readings of infrared and light: how far from health the part of them is that "
    "follows each quantity, beside everything named."
)


def write_report(
    examined: Examination, path: Path, *, command: str, following: Sequence[str] = ()
) -> None:
    """Write the page; `following` are the commands that perform what is proposed."""
    with tempfile.TemporaryDirectory(prefix="realitygap-") as room:
        sections = [
            _found(examined),
            *next_section(examined.diagnosis.proposal, following, Path(room)),
            _pictures(examined, Path(room)),
            _robots(examined),
            _not_checked(examined),
            Section("Where this comes from", [f"Command: {command}", *examined.diagnosis.notes]),
        ]
        write_page(path, "Diagnosis", verdict_sentence(examined.diagnosis), sections)


def _found(examined: Examination) -> Section:
    """Every cause: what it means, how large, how sure, what else it could be."""
    found = examined.diagnosis
    texts = [f"{who(one)}: {one.term.cause.meaning}." for one in found.named]
    texts += [leftover_sentence(one) for one in found.unexplained]
    rows = [
        {
            "cause": one.term.cause.name,
            "which": one.term.variant or None,
            "robots": who(one),
            "value (95 % interval)": "; ".join(value_text(v) for v in one.values),
            "error taken off, held out": f"{100 * one.evidence.share:.1f} %",
            "distance from health": f"{one.evidence.distance:.1f} s.d.",
            "could also be": ", ".join(alternatives(one)) or None,
        }
        for one in found.named
    ]
    tables = [Table.of(pd.DataFrame(rows))] if rows else []
    return Section("What was found", [CHECKED, *texts], tables=tables)


def _pictures(examined: Examination, room: Path) -> Section:
    """The evidence."""
    found = examined.diagnosis
    concerned = {robot for one in found.named for robot in one.robots}
    drawn = []
    figures.draw_errors(figures.error_table(examined), concerned, room / "errors.png")
    drawn.append(Picture(room / "errors.png", BEFORE_AFTER))
    if found.named:
        figures.draw_rivals(found.named, room / "rivals.png")
        drawn.append(Picture(room / "rivals.png", RIVALS))
    if any(one.term.cause.smooth for one in found.named):
        figures.draw_profiles(examined, room / "profiles.png")
        drawn.append(Picture(room / "profiles.png", PROFILES))
    figures.draw_left(examined, room / "left.png")
    drawn.append(Picture(room / "left.png", LEFT))
    if isinstance(examined, WholeExamination):
        table = sense_figures.far_from_health(examined.senses)
        if len(table):
            sense_figures.draw_left(table, room / "left_senses.png")
            drawn.append(Picture(room / "left_senses.png", LEFT_IN_SENSES))
    # the page reads the pictures when it is written, within the room's life
    return Section("The evidence", figures=drawn)


def _robots(examined: Examination) -> Section:
    """One row per robot."""
    tracks, found = examined.tracks, examined.diagnosis
    table = figures.error_table(examined)
    last = table[table["age"] == table["age"].max()]
    wide = last.pivot_table(index="robot", columns="kind", values="error")
    windows = np.bincount(tracks.robot, minlength=len(tracks.robots))
    rows = []
    for k, robot in enumerate(tracks.robots):
        names = [one.term.cause.name for one in found.named if robot in one.robots]
        left = [
            one.where for one in found.unexplained if one.robots == "all" or robot in one.robots
        ]
        errors = {
            f"{kind} (mm in 0.8 s)": float(wide.loc[robot, kind]) if robot in wide.index else np.nan
            for kind in figures.KINDS
        }
        rows.append(
            {
                "robot": robot,
                "named": ", ".join(names) or "nothing wrong",
                "unexplained": "; ".join(left) or None,
                "seconds of free motion": int(windows[k]),
                **errors,
            }
        )
    return Section("Robot by robot", tables=[Table.of(pd.DataFrame(rows))])


def _not_checked(examined: Examination) -> Section:
    """What this log cannot say."""
    found = examined.diagnosis
    health = (
        f"Health was taken from a reference of {examined.reference.robots} healthy robots in "
        f"{examined.reference.swarms} runs ({examined.reference.model})."
        if found.reference
        else "There was no healthy reference."
    )
    tried = ", ".join(name for name, cause in causes().items() if cause.identifiable)
    return Section(
        "What was not checked, and why", [health, f"Tried: {tried}.", *found.not_checked]
    )
