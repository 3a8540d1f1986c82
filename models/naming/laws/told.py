"""Laws of a diagnosis: looked for where something is unexplained, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pandas as pd

from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.claims.ahead import Ahead
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.laws.found import FoundLaw
from realitygap.models.naming.laws.room import LawRoom
from realitygap.models.naming.laws.search import hunted
from realitygap.models.naming.laws.useful import useful


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
