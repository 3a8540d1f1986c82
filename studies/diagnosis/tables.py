"""What the page of a diagnosis says in tables and lists."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
import pandas as pd

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.extension import NamedCause
from realitygap.models.log.named import Names
from realitygap.models.log.used import REASONS
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.channels.wheels.chosen import BOTH
from realitygap.models.naming.claims.ahead import KEYS
from realitygap.models.naming.diagnosis import Calibrated, alternatives
from realitygap.studies.diagnosis.words import (
    detectable_sentence,
    entry_text,
    follows_text,
    gain_row,
    untold_sentence,
    value_text,
    who,
)
from realitygap.studies.pages.page import PageTable, Section

CHECKED = (
    "Every cause of the catalogue was tried on every robot whose path differs from health at a "
    "first look, alone and together with others. A cause is named only if it lowers the error on "
    "parts of the log that it was not fitted to, and if its value lies further from health than "
    "any healthy robot's does."
)
GAIN = (
    "How far predictions are off, on parts of the log that no value was fitted to: the log is cut "
    "in two, by runs where there are several and else by time, and each part is predicted by a "
    "file with the values of the other. Before: the model as it was. Of a healthy robot: what the "
    "minimal model leaves of one under the same commands."
)
CALIBRATED = (
    "Something stays open of these robots, and the extended model predicts them with these values "
    "beside all that was named. They were fitted together, and by itself none means what its name "
    "says. Errors are means, without and with them; each half of the log is predicted with the "
    "values of the other."
)
CAN_TELL = (
    "Measured of the log before anything is asked of a robot, with what is made of it. None of it "
    "is a fault of a robot."
)
SHOWN = (
    "What this log would have shown of one cause alone, in the robot that shows it worst, with "
    "95 % probability."
)


def found_section(examined: Examination) -> Section:
    """Every cause: what it means, how large, how sure, what else it could be."""
    found = examined.diagnosis
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
    meanings = [f"{one.term.cause.name}: {one.term.cause.meaning}." for one in found.named]
    return Section("How it was found", [CHECKED], tables=tables, points=meanings, folded=True)


def gain_section(examined: Examination) -> Section:
    """What the extended model predicts better."""
    found = examined.diagnosis
    exported = any(one.exported for one in found.named)
    nothing = [] if exported else ["No named cause was added to the model: nothing is gained here."]
    rows = [gain_row(name, gain) for name, gain in found.gain.items()]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What the extended model gains", [GAIN, *nothing], tables=tables)


def calibration_section(calibrated: Sequence[Calibrated], names: Names) -> list[Section]:
    """Values that predict best where no name accounts for it; nothing where there are none."""
    if not calibrated:
        return []
    rows = [
        {
            "robot": names[one.robot],
            "values": "; ".join(_term_text(term) for term in one.terms),
            **{
                name.replace("_", " "): f"{before:.3g} to {after:.3g} {KEYS[name]}"
                for name, (before, after) in one.errors.items()
            },
        }
        for one in calibrated
    ]
    tables = [PageTable.of(pd.DataFrame(rows))]
    return [Section("Calibrated, which is no diagnosis", [CALIBRATED], tables=tables)]


def _term_text(term: NamedCause) -> str:
    """A term of a calibration: parameters with values and units, and of which wheel."""
    units = {one.name: one.unit for one in term.cause.parameters}
    word = f" ({term.word})" if term.word not in (ALL, BOTH) else ""
    told = (
        f"{name} {one.value:.4g} {units[name]}".removesuffix(" 1")
        for name, one in term.parameters.items()
    )
    return ", ".join(told) + word


def can_tell_section(examined: Examination) -> Section:
    """The pre-flight."""
    rows = [
        {"what": one.meaning, "value": entry_text(one), "what follows": follows_text(one)}
        for one in examined.diagnosis.preflight
    ]
    tables = [PageTable.of(pd.DataFrame(rows))]
    return Section("What this log can tell", [CAN_TELL], tables=tables, folded=True)


def would_have_shown_section(examined: Examination) -> Section:
    """What this log could tell."""
    found = examined.diagnosis
    told = [detectable_sentence(found.detectable)] if found.detectable else []
    if found.untold:
        told.append(f"So that not every robot can be called sound: {untold_sentence(found)}")
    rows = [
        {
            "robot": found.names[one.robot],
            "time (s)": round(one.seconds, 1),
            **{name.replace("_", " "): f"{100 * getattr(one, name):.1f} %" for name in REASONS},
        }
        for one in found.used
    ]
    tables = [PageTable.of(pd.DataFrame(rows))] if rows else []
    return Section("What would have shown", [SHOWN, *told], tables=tables, folded=True)


def robots_section(examined: Examination) -> Section:
    """One row per robot."""
    tracks, found = examined.tracks, examined.diagnosis
    windows = np.bincount(tracks.robot, minlength=len(tracks.robots))
    errors = _errors(examined.errors)
    rows = []
    for k, robot in enumerate(tracks.robots):
        mine = [one for one in found.named if robot in one.robots]
        names = [o.term.cause.name + ("" if o.exported else " (not exported)") for o in mine]
        left = [
            one.where for one in found.unexplained if one.robots == "all" or robot in one.robots
        ]
        rows.append(
            {
                "robot": found.names[robot],
                "named": ", ".join(names) or _of_robot(robot, examined),
                "unexplained": "; ".join(left) or None,
                "windows of free motion": int(windows[k]),
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


def not_checked_section(examined: WholeExamination, columns: Collection[str]) -> Section:
    """What this log cannot say; `columns` are those it has."""
    found = examined.diagnosis
    health = (
        f"Health was taken from a reference of {examined.reference.robots} healthy robots in "
        f"{examined.reference.swarms} runs ({examined.reference.model})."
        if found.reference
        else "There was no healthy reference."
    )
    names = {one.cause for one in found.detectable}
    names |= {one.term.cause.name for one in found.named}
    if examined.senses.found is not None:
        state = examined.senses.found.state
        names |= {one.term.cause.name for one in state.items if one.term is not None}
    tried = ", ".join(sorted(name for name in names if _logged(name, columns)))
    return Section(
        "What was not checked, and why", [f"{health} Tried: {tried}."], points=found.not_checked
    )


def _logged(name: str, columns: Collection[str]) -> bool:
    """Whether a log has anything in which a cause shows."""
    needed = set(every_cause()[name].columns) - {"case"}
    return not needed or not needed.isdisjoint(columns)
