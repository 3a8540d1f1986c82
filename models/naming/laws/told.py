"""Laws of a diagnosis: looked for where something is unexplained, and nowhere else.

The extended model may hold those that the simulator knows and that do no harm. A law is kept if its
robots are in the mean predicted better at 1, 5 or 20 s, in place or heading, and worse at none of
them, whether by chance or not. Against chance it has been proved on blocks that it was not fitted
to; its amplitude here is that of the whole log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pandas as pd

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.laws import SIMULATED
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.extended import as_written
from realitygap.models.belief.extension import NamedCause
from realitygap.models.belief.law_tables import WrittenLaw
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.blocks import better
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.claims.ahead import KEYS, Ahead, together
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.laws.found import FoundLaw, law_table
from realitygap.models.naming.laws.room import LawRoom
from realitygap.models.naming.laws.search import hunted
from realitygap.models.naming.rules import Rules

UNDRAWN = "no shape and no curve of one quantity: not exported"
UNKNOWN = "its phase is another in every run: not exported"
TOO_LONG = "the simulator has no clock since a robot left rest: not exported"
HARMS = "the model with it predicts worse at {}: not exported"
USELESS = "the model with it predicts nothing better 1, 5 or 20 s ahead: not exported"
DIVERGES = "the model with it leaves the finite numbers: not exported"

Sizes = list[dict[str, FloatArray]]


def useful(
    ahead: Ahead,
    model: ModelFile,
    causes: Sequence[NamedCause],
    laws: Sequence[FoundLaw],
    rules: Rules,
) -> tuple[FoundLaw, ...]:
    """The laws, each with what it gains and whether it is exported.

    Args:
        ahead: The log's windows.
        model: What was believed before.
        causes: What is exported beside.
        laws: As found, the strongest first.
        rules: What is better and what is worse.
    """
    kept: list[WrittenLaw] = []
    found = []
    for law in laws:
        why = _unknown(law)
        if why:
            found.append(replace(law, exported=False, why=why))
            continue
        table = law_table(law)
        robots = list(law.amounts)
        before = _sizes(ahead, as_written(model, causes, kept), robots)
        try:
            after = _sizes(ahead, as_written(model, causes, [*kept, table]), robots)
        except Diverged:
            found.append(replace(law, exported=False, why=DIVERGES))
            continue
        one = _judged(law, ahead, before, after, rules)
        found.append(one)
        kept += [table] if one.exported else []
    return tuple(found)


def _unknown(law: FoundLaw) -> str:
    """Why the simulator cannot have a law; empty: it can."""
    if not law.atoms:
        return UNDRAWN
    unknown = {atom.of for atom in law.atoms} - SIMULATED
    return "" if not unknown else (TOO_LONG if "since" in unknown else UNKNOWN)


def _sizes(ahead: Ahead, file: ModelFile, robots: Sequence[int]) -> Sizes:
    """Of each robot, by key, how far a model is off."""
    return [
        ahead.sizes(robot, ahead.replay(robot, lambda r, part: file.motion(r))) for robot in robots
    ]


def _judged(law: FoundLaw, ahead: Ahead, before: Sizes, after: Sizes, rules: Rules) -> FoundLaw:
    won, errors = {}, {}
    for name in KEYS:
        less, more = together(before, name), together(after, name)
        one = better(less, more, ahead.block(name, law.amounts))
        if one is not None:
            won[name] = one
            errors[name] = (float(less.mean()), float(more.mean()))
    harmed = [name for name, one in won.items() if one.share < -rules.harm_margin]
    why = HARMS.format(", ".join(harmed)) if harmed else ""
    if not why and not any(one.share > rules.harm_margin for one in won.values()):
        why = USELESS
    return replace(law, errors=errors, exported=not why, why=why)


def with_laws(examined: Examination, log: MeasuredLog, table: pd.DataFrame) -> Examination:
    """The examination with laws of what its motion leaves unexplained; nothing is asked else.

    Args:
        examined: With what it claims of causes.
        log: Of which.
        table: The log's conditions.
    """
    state = examined.identified.state
    identified = replace(examined.identified, state=None)
    said = examined.diagnosis
    if state is not None and said.unexplained:
        laws = _laws(LawRoom(state, said.named), said.unexplained)
        causes = [written(one, one.values) for one in said.named if one.exported]
        if laws:
            laws = useful(Ahead(log, table), examined.model, causes, laws, said.rules)
        said = replace(said, laws=laws)
    return replace(examined, identified=identified, diagnosis=said)


@one_thread
def _laws(room: LawRoom, left: Sequence[Unexplained]) -> tuple[FoundLaw, ...]:
    """Robot by robot, or of all together where all are meant."""
    known = room.state.tracks.robots
    if any(one.robots == "all" for one in left):
        groups = [list(range(len(known)))]
    else:
        every = {robot for one in left for robot in one.robots}
        groups = [[k] for k, robot in enumerate(known) if robot in every]
    found, done = [], set[int]()
    for group in groups:
        if done & set(group):
            continue
        for one in hunted(room, group):
            found.append(one.told)
            done |= {known.index(robot) for robot in one.told.robots}
    return tuple(found)
