"""The report of a diagnosis: one self-contained page for whoever must repair a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim.laws import Atom
from realitygap.models.belief.law_values import value
from realitygap.models.belief.law_words import SYMBOLS, equation, size_in_words
from realitygap.models.belief.senses import SenseCause
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.named import Names
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.diagnosis import Diagnosis
from realitygap.models.naming.laws.found import FoundLaw
from realitygap.studies.diagnosis import figures, sense_figures, tables
from realitygap.studies.diagnosis.box import verdict_box
from realitygap.studies.diagnosis.evidence import SenseEvidence
from realitygap.studies.diagnosis.figures import draw_curves
from realitygap.studies.diagnosis.next_experiment import next_section
from realitygap.studies.diagnosis.tracks import shown_paths, track_figures, worst_tracks
from realitygap.studies.inputs.model import Model
from realitygap.studies.pages.drawing import themed
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.plumbing.rooms import scratch

ABOUT = (
    "Where no listed cause explains what is seen, an equation is looked for that does: one form, "
    "an amplitude for each robot. It is stated if it takes error off blocks of the log that it was "
    "not fitted to, half as much again as any decoy does: quantities of another time or of another "
    "robot. What the log's other robots show as well is no law of one."
)
NO_OTHERS = (
    "No other robots of this log could be asked for the same law, so that a habit of healthy "
    "robots cannot be told from it."
)
CURVES = "What was seen where no shape was found: how the amplitude follows the quantity."
POINTS = 200


def law_section(laws: Sequence[FoundLaw], names: Names, room: Path) -> list[Section]:
    """The section; nothing where there are no laws."""
    if not laws:
        return []
    rows = [
        {
            "law": equation(one.channel, one.atoms or (Atom(one.of, "curve"),)),
            "robots": "all" if one.whole_swarm else ", ".join(names[k] for k in one.robots),
            "a (95 % interval)": "; ".join(
                f"robot {names[robot]}: {size_in_words(one.channel, *amount)}"
                for robot, amount in one.amounts.items()
            ),
            "it may mean": one.reading if one.shape else f"{one.reading}; shape not found",
            "could also be": "; ".join(one.instead) or None,
            "in extended.toml": "yes" if one.exported else one.why,
            "deviance taken off, held out": f"{one.gain:.0f}",
            "of the best curve": f"{one.ceiling:.0f}",
            "of the best decoy": f"{one.decoy:.0f}",
        }
        for one in laws
    ]
    words = "; ".join(f"{symbol} is {meaning}" for symbol, meaning in SYMBOLS.items())
    alone = [NO_OTHERS] if any(not one.compared for one in laws) else []
    curves = [one for one in laws if one.atoms and one.atoms[0].form == "curve"]
    drawn = []
    if curves:
        draw_curves([_points(one) for one in curves], room / "laws.png")
        drawn.append(Picture(room / "laws.png", CURVES))
    texts = [ABOUT, *alone, f"In equations {words}; [...] is 1 where it holds, else 0."]
    return [Section("Laws", texts, tables=[PageTable.of(pd.DataFrame(rows))], figures=drawn)]


def _points(law: FoundLaw) -> tuple[str, str, np.ndarray, np.ndarray]:
    atom = law.atoms[0]
    at = np.linspace(atom.parameters[0], atom.parameters[1] - 1e-9, POINTS)
    size = max((one.value for one in law.amounts.values()), key=abs)
    return law.channel, atom.of, at, size * value(atom, {atom.of: at})


BEFORE_AFTER = (
    "How far the predicted position is off in mm, against how far ahead is predicted in s{whom}. "
    "Held out: no value was fitted to what is judged."
)
RIVALS = (
    "{name}: the deviance that it takes off the errors (dark), and what other causes take off in "
    "its stead. The further it is ahead of them, the surer the name."
)
ALONE = " No other cause came near enough to be tried."
WHOLE_TRACK = (
    "Robot {name} of run {run}: where it was seen, and where its commands should have taken it, "
    "begun anew at a measured pose every {seconds:g} s. Yellow: the worst stretch."
)
ENLARGED = (
    "The worst stretch, {seconds:g} s from the dot on{touched}: the model as it was ends "
    "{predicted} mm off{corrected}."
)
PROFILES = (
    "Deviance (twice the negative log likelihood, no unit) against the named value; the shaded "
    "band is the 95 % interval, which also holds how much healthy robots differ."
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
COUNTED = {"infrared": "ps", "light": "ls"}
"""Channels of what is unexplained in readings, and the kind of sensor that each is of."""
SENSED = (*COUNTED, "nest")
"""Those that are not of motion."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings:
    """What a page is made of."""

    examined: WholeExamination
    log: MeasuredLog
    extended: Model
    command: str
    following: Sequence[str] = ()
    """Commands that perform what is proposed."""


def write_report(shown: Findings, path: Path) -> None:
    """Write the page."""
    examined = shown.examined
    found = examined.diagnosis
    with scratch() as room, themed():
        sections = [
            *law_section(found.laws, found.names, room),
            *next_section(found.proposal, shown.following, room, found.rules.promising),
            *_tracks(shown, room),
            *_evidence(shown, room),
            tables.gain_section(examined),
            *tables.calibration_section(found.calibration, found.names),
            tables.robots_section(examined),
            tables.not_checked_section(examined, shown.log.frame.columns),
            tables.found_section(examined),
            tables.can_tell_section(examined),
            tables.would_have_shown_section(examined),
            _left(examined, room),
            Section("Where this comes from", found.notes, commands=[shown.command], folded=True),
        ]
        # the page reads the pictures when it is written, within the room's life
        write_page(path, "Diagnosis", verdict_box(found), sections)


def _tracks(shown: Findings, room: Path) -> list[Section]:
    """Measured, predicted and corrected tracks over one another."""
    found = shown.examined.diagnosis
    seen = worst_tracks(shown.log, shown.examined.model, shown.extended.file, moved(found))
    if seen is None:
        return []
    whole, enlarged = room / "track.png", room / "worst.png"
    track_figures(seen, whole, enlarged)
    off = {name: f"{1e3 * value:.0f}" for name, value in seen.off.items()}
    corrected = f", the extended one {off['corrected']} mm" if len(shown_paths(seen)) > 2 else ""
    touched = "" if seen.free else " (it met the wall or a robot)"
    words = {"name": found.names[seen.robot], "run": seen.run, "seconds": seen.seconds}
    captions = (
        WHOLE_TRACK.format(**words),
        ENLARGED.format(**words, predicted=off["predicted"], corrected=corrected, touched=touched),
    )
    drawn = [Picture(p, c, wide=False) for p, c in zip((whole, enlarged), captions, strict=True)]
    return [Section("Where the robot went", figures=drawn)]


def moved(found: Diagnosis) -> set[int]:
    """Robots in whose motion something is wrong; empty: in none, or in all."""
    moving = [one for one in found.named if not isinstance(one.term.cause, SenseCause)]
    left = [one for one in found.unexplained if one.channel not in SENSED]
    named = {robot for one in moving for robot in one.robots}
    return named | {robot for one in left if one.robots != "all" for robot in one.robots}


def _evidence(shown: Findings, room: Path) -> list[Section]:
    """Of every cause in its own channel, with its rivals; of motion in any case."""
    examined = shown.examined
    found, drawn = examined.diagnosis, []
    robots = moved(found)
    if len(examined.errors) and (robots or not found.named):
        figures.draw_errors(examined.errors, robots, room / "errors.png")
        whom = f", of the robots concerned ({len(robots)})" if robots else ", mean of all robots"
        caption = BEFORE_AFTER.format(whom=whom)
        drawn.append(Picture(room / "errors.png", caption, wide=False))
    drawn += [Picture(path, caption, wide=False) for path, caption in _sensed(shown, room)]
    for k, one in enumerate(found.named):
        figures.draw_rivals(one, room / f"rivals{k}.png")
        caption = RIVALS.format(name=one.term.cause.name)
        caption += "" if len(figures.rival_bars(one)) > 1 else ALONE
        drawn.append(Picture(room / f"rivals{k}.png", caption, wide=False))
    return [Section("The evidence", figures=drawn)] if drawn else []


def _sensed(shown: Findings, room: Path) -> list[tuple[Path, str]]:
    """Pictures of what is wrong in the senses, in their own channels."""
    found = shown.examined.diagnosis
    sensed = [one for one in found.named if isinstance(one.term.cause, SenseCause)]
    left = [one for one in found.unexplained if one.channel in COUNTED]
    if not sensed and not left:
        return []
    evidence = SenseEvidence(shown.examined, shown.extended.tables)
    each = (evidence.draw(one, room / f"sensed{k}") for k, one in enumerate(sensed))
    drawn = [picture for pictures in each for picture in pictures]
    for k, one in enumerate([] if sensed else left):
        concerned = found.robots if one.robots == "all" else one.robots
        drawn += evidence.counts(concerned, COUNTED[one.channel], "", room / f"left{k}")
    return drawn


def _left(examined: WholeExamination, room: Path) -> Section:
    """Profiles, and what is left."""
    drawn = []
    if figures.profiled(examined):
        figures.draw_profiles(examined, room / "profiles.png")
        drawn.append(Picture(room / "profiles.png", PROFILES))
    figures.draw_left(examined, room / "left.png")
    drawn.append(Picture(room / "left.png", LEFT))
    table = sense_figures.far_from_health(examined.senses)
    if len(table):
        sense_figures.draw_left(table, room / "left_senses.png")
        drawn.append(Picture(room / "left_senses.png", LEFT_IN_SENSES))
    return Section("What is left after everything found", figures=drawn, folded=True)
