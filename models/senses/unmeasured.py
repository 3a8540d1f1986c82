"""What a healthy reference of the senses has not measured, in words, as in motion."""

from __future__ import annotations

from collections.abc import Sequence

from realitygap.embedded_sim import PointModel
from realitygap.models.causes.withheld import withheld
from realitygap.models.identify.unmeasured import MEASURE, not_judged, not_named
from realitygap.models.log import MeasuredLog
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.glance import FITTED
from realitygap.models.senses.problem import Term
from realitygap.models.senses.quantities import QUANTITIES
from realitygap.models.senses.reference import SenseReference
from realitygap.models.senses.structure import CHANGES, Follow


def unmeasured_causes(
    log: MeasuredLog, model: PointModel, healthy: SenseReference
) -> tuple[str, ...]:
    """Causes that the log's columns could show and the reference says nothing of."""
    if model.tables is None:
        return ()
    causes = [
        cause
        for cause in sense_causes().values()
        if not withheld(cause.name) and any(name in log.frame for name in cause.columns)
    ]
    terms = [Term(c, variant) for c in causes if c.kind in FITTED for variant in c.variants]
    keys = [t.key for t in terms if not healthy.knows(t.key, swarm=t.cause.place)]
    names = {cause.name for cause in causes}
    if healthy.noise is None:
        keys += sorted({"ir_noise"} & names)
    said = [not_named(keys)] if keys else []
    if healthy.targets is None and {"ir_gain", "wall_albedo"} <= names:
        said.append(f"ir_gain and wall_albedo of all robots: not told apart; {MEASURE} does it")
    if healthy.clock is None and names:
        said.append(
            f"clock_offset by the sensors: not told from command_latency; {MEASURE} does it"
        )
    return tuple(said)


def unmeasured_structure(structure: Sequence[Follow], healthy: SenseReference) -> tuple[str, ...]:
    """What readings may follow of which the reference says nothing."""
    words = {
        f"{one.channel} reads more or less {CHANGES[one.change]} depending on "
        f"{QUANTITIES[one.quantity]}"
        for one in structure
        if healthy.health(one.key) is None
    }
    return (not_judged(words),) if words else ()
