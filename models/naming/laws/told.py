"""Laws of a diagnosis: looked for where something is unexplained, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.laws.found import FoundLaw
from realitygap.models.naming.laws.search import LawRoom, hunted


def with_laws(examined: Examination) -> Examination:
    """The examination with laws of what its motion leaves unexplained; nothing is asked else."""
    state = examined.identified.state
    identified = replace(examined.identified, state=None)
    said = examined.diagnosis
    if state is not None and said.unexplained:
        said = replace(said, laws=_laws(state, said.unexplained))
    return replace(examined, identified=identified, diagnosis=said)


@one_thread
def _laws(state: State, left: Sequence[Unexplained]) -> tuple[FoundLaw, ...]:
    """Robot by robot, or of all together where all are meant."""
    known = state.tracks.robots
    if any(one.robots == "all" for one in left):
        groups = [list(range(len(known)))]
    else:
        every = {robot for one in left for robot in one.robots}
        groups = [[k] for k, robot in enumerate(known) if robot in every]
    room, found, done = LawRoom(state), [], set[int]()
    for group in groups:
        if done & set(group):
            continue
        for one in hunted(room, group):
            found.append(one.told)
            done |= {known.index(robot) for robot in one.told.amounts}
    return tuple(found)
