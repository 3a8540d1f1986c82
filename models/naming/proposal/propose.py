"""From an ambiguous diagnosis to the manoeuvre that would settle it."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim import PointModel, Tables
from realitygap.models.belief.senses import SenseCause
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.diagnosis import alternatives
from realitygap.models.naming.findings import Named
from realitygap.models.naming.proposal import motion, senses
from realitygap.models.naming.proposal.ground import Ground, ground
from realitygap.models.naming.proposal.menu import Proposal


def with_proposal(
    examined: WholeExamination, log: MeasuredLog, tables: Tables | None
) -> WholeExamination:
    """The examination with a manoeuvre proposed for the first ambiguous cause that one settles.

    Args:
        examined: Of motion, and of the senses where the log has any.
        log: Of which; where the model has no arena it shows how much room there is.
        tables: Captured, of the model; None: its sensors are not modelled.
    """
    found, place = examined.diagnosis, ground(examined.model, log)
    model = examined.model.point_model(tables)
    said = []
    for one in found.named:
        if not alternatives(one):
            continue
        proposal = _proposal(examined, one, model, place)
        if proposal is not None and proposal.promises(found.rules.promising):
            return replace(examined, diagnosis=replace(found, proposal=proposal))
        said.append(_no_help(one, proposal, place))
    missed = (*found.not_checked, *said)
    return replace(examined, diagnosis=replace(found, not_checked=missed))


def _proposal(
    examined: WholeExamination, named: Named, model: PointModel, place: Ground
) -> Proposal | None:
    if not isinstance(named.term.cause, SenseCause):
        return motion.propose(examined, named, place)
    return senses.propose(examined.senses, named, model, place, examined.diagnosis.rules)


def _no_help(named: Named, proposal: Proposal | None, place: Ground) -> str:
    """That no manoeuvre settles it, in words."""
    rivals = " and ".join((named.term.cause.name, *alternatives(named)))
    if proposal is None:
        return (
            f"no manoeuvre of the menu that could tell {rivals} apart can be driven or predicted "
            f"within {place.radius:.2g} m, which is all the room known"
        )
    best = proposal.best
    return (
        f"no manoeuvre of the menu separates {rivals}: the best, {best.name}, by "
        f"{best.separation:.1f} standard deviations"
    )
