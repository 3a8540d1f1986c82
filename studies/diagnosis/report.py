"""The report of a diagnosis: one self-contained page for whoever must repair a robot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.models.belief.catalogue import causes
from realitygap.models.log.used import REASONS
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.diagnosis import alternatives
from realitygap.studies.diagnosis import figures, sense_figures
from realitygap.studies.diagnosis.laws import law_section
from realitygap.studies.diagnosis.next_experiment import next_section
from realitygap.studies.diagnosis.words import (
    detectable_sentence,
    entry_text,
    follows_text,
    gain_row,
    leftover_sentence,
    untold_sentence,
    value_text,
    verdict_sentence,
    who,
)
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.plumbing.rooms import scratch

CHECKED = (
    "Every cause of the catalogue was tried on every robot whose path differs from health at a "
    "first look, alone and together with others. A cause is named only if it lowers the error on "
    "parts of the log that it was not fitted to, and if its value lies further from health than "
    "any healthy robot's does."
)
BEFORE_AFTER = (
    "How far the predicted position is off, from each measured pose on: by the model as it was, by "
    "the extended one, and what the minimal model leaves of a healthy robot. Left: the robots "
    "concerned; right: every robot."
)
GAIN = (
    "How far predictions are off, on parts of the log that no value was fitted to: the log is cut "
    "in two, by runs where there are several and else by time, and each part is predicted by a "
    "file with the values of the other. Before: the model as it was. Of a healthy robot: what the "
    "minimal model leaves of one under the same commands."
)
CAN_TELL = (
    "Measured of the log before anything is asked of a robot, with what is made of it. None of it "
    "is a fault of a robot."
)
SHOWN = (
    "What this log would have shown of one cause alone, in the robot that shows it worst, with "
    "95 % probability."
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
    with scratch() as room:
        sections = [
            _found(examined),
            *law_section(examined.diagnosis.laws, examined.diagnosis.names, room),
            *next_section(
                examined.diagnosis.proposal,
                following,
                room,
                examined.diagnosis.rules.promising,
            ),
            _pictures(examined, room),
            _gain(examined),
            _robots(examined),
            _can_tell(examined),
            _would_have_shown(examined),
            _not_checked(examined),
            Section("Where this comes from", [f"Command: {command}", *examined.diagnosis.notes]),
        ]
        write_page(path, "Diagnosis", verdict_sentence(examined.diagnosis), sections)


def _found(examined: Examination) -> Section:
    """Every cause: what it means, how large, how sure, what else it could be."""
    found = examined.diagnosis
    texts = [f"{who(one, found.names)}: {one.term.cause.meaning}." for one in found.named]
    texts += [leftover_sentence(one, found.names) for one in found.unexplained]
    rows = [
        {
            "cause": one.term.cause.name,
            "which": one.term.variant or None,
            "robots": who(one, found.names),
            "value (95 % interval)": "; ".join(value_text(v) for v in one.values),
            "error taken off, held out": f"{100 * one.evidence.share:.1f} %",
            "distance from health": f"{one.evidence.distance:.1f} s.d.",
            "could also be": ", ".join(alternatives(one)) or None,
            "in extended.toml": "yes" if one.exported else one.why,
        }
        for one in found.named
    ]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What was found", [CHECKED, *texts], tables=tables)


def _gain(examined: Examination) -> Section:
    """What the extended model predicts better."""
    found = examined.diagnosis
    exported = any(one.exported for one in found.named)
    nothing = [] if exported else ["Nothing was added to the model, so that nothing is gained."]
    rows = [gain_row(name, gain) for name, gain in found.gain.items()]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What the extended model gains", [GAIN, *nothing], tables=tables)


def _can_tell(examined: Examination) -> Section:
    """The pre-flight."""
    rows = [
        {"what": one.meaning, "value": entry_text(one), "what follows": follows_text(one)}
        for one in examined.diagnosis.preflight
    ]
    return Section("What this log can tell", [CAN_TELL], tables=[PageTable.of(pd.DataFrame(rows))])


def _would_have_shown(examined: Examination) -> Section:
    """What this log could tell."""
    found = examined.diagnosis
    told = [detectable_sentence(found.detectable)] if found.detectable else []
    if found.untold:
        told.append(f"So that not every robot can be called sound: {untold_sentence(found)}")
    rows = [
        {
            "robot": found.names[one.robot],
            "seconds": round(one.seconds, 1),
            **{name.replace("_", " "): f"{100 * getattr(one, name):.1f} %" for name in REASONS},
        }
        for one in found.used
    ]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What would have shown", [SHOWN, *told], tables=tables)


def _pictures(examined: Examination, room: Path) -> Section:
    """The evidence."""
    found = examined.diagnosis
    concerned = {robot for one in found.named for robot in one.robots}
    drawn = []
    if len(examined.errors):
        figures.draw_errors(examined.errors, concerned, room / "errors.png")
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
    windows = np.bincount(tracks.robot, minlength=len(tracks.robots))
    errors = _errors(examined.errors)
    rows = []
    for k, robot in enumerate(tracks.robots):
        names = [one.term.cause.name for one in found.named if robot in one.robots]
        left = [
            one.where for one in found.unexplained if one.robots == "all" or robot in one.robots
        ]
        rows.append(
            {
                "robot": found.names[robot],
                "named": ", ".join(names) or _of_robot(robot, examined),
                "unexplained": "; ".join(left) or None,
                "seconds of free motion": int(windows[k]),
                **errors.get(robot, {}),
            }
        )
    return Section("Robot by robot", tables=[PageTable.of(pd.DataFrame(rows))])


def _errors(table: pd.DataFrame) -> dict[int, dict[str, float]]:
    """By robot, its mean errors at the longest time ahead, by what they are called."""
    if not len(table):
        return {}
    seconds = table["seconds"].max()
    found: dict[int, dict[str, float]] = {}
    for one in table[table["seconds"] == seconds].itertuples():
        called = f"{one.kind} (mm in {seconds:g} s)"
        found.setdefault(int(one.robot), {})[called] = 1e3 * float(one.error)
    return found


def _of_robot(robot: int, examined: Examination) -> str:
    """What is said of a robot of which nothing is named."""
    found = examined.diagnosis
    if any(one.robots == "all" or robot in one.robots for one in found.unexplained):
        return "no known cause"
    return "cannot tell" if robot in found.untold else "nothing wrong"


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
