"""What kind of motion a log holds: what foraging makes robots do, or manoeuvres.

Health depends on it. Robots that stop and reverse show other small departures from the point model
than robots that always go ahead or turn, so that each kind is compared with its own healthy robots.
"""

from __future__ import annotations

import numpy as np

from realitygap.models.log.measured import MeasuredLog

RARELY = 0.02
"""Share of a run's rows, from each robot's first motion on, in which robots stand or reverse. Our
choice: foraging controllers do neither, manoeuvres of the menu do both in 3 % of their time and
more."""


def manoeuvres(log: MeasuredLog) -> bool:
    """Whether any run of a log holds manoeuvres."""
    ahead = log.commands.sum(axis=1)
    still = np.hypot(log.commands[:, 0], log.commands[:, 1]) == 0.0
    moved = np.zeros(len(still), dtype=np.bool_)
    for begin, end in zip(log.start[:-1], log.start[1:], strict=True):
        moved[begin:end] = np.maximum.accumulate(~still[begin:end])
    odd = moved & (still | (ahead < 0.0))
    runs = np.unique(log.frame["run"].astype(str), return_inverse=True)[1]
    share = np.bincount(runs, odd) / np.maximum(np.bincount(runs, moved), 1)
    return bool((share > RARELY).any())
