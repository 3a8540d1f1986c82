"""What a log's readings and answers would have shown: per cause, the size from which it is seen."""

from __future__ import annotations

import numpy as np

from realitygap.models.belief.catalogue import sense_causes, withheld
from realitygap.models.naming.channels.senses.identify import SensesFound
from realitygap.models.naming.channels.senses.terms import NO_COMMANDS
from realitygap.models.naming.diagnosis import Detectable


def detectable_in(found: SensesFound) -> tuple[Detectable, ...]:
    """Every cause with a number, by name; of single sensors and robots the worst."""
    robots = found.state.tracks.robots
    result = []
    for name, cause in sense_causes().items():
        if not cause.parameters or cause.kind == "nest" or withheld(name):
            continue
        keys = [f"{name}/{word}" if word else name for word in cause.variants]
        sizes = [found.least[key] for key in keys if key in found.least]
        # where the last number is a strength, the others only say of what
        which = -1 if cause.starts(NO_COMMANDS) else 0
        p = cause.parameters[which]
        if sizes:
            each = np.max([one[:, which] for one in sizes], axis=0)  # (robots,); NaN is the worst
            worst = int(np.argmax(np.where(np.isnan(each), np.inf, each)))
            far = float(each[worst])
        else:
            worst, far = 0, np.nan
        inside = far <= p.bounds[1]
        result.append(
            Detectable(
                cause=name,
                parameter=p.name,
                unit=p.unit,
                null=p.null,
                size=abs(p.value(far) - p.null) if inside else None,
                robot=None if cause.place else robots[worst],
            )
        )
    return tuple(result)
