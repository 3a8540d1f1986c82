"""What is beyond health: how much of an error chance and healthy differences do not explain."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, stdtrit

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.files import Finite
from realitygap.models.naming.rules import Rules


class Gates(Finite):
    """What is beyond health: deviance taken off beyond what its differences would, and errors."""

    cause: float = Rules.cause_gate
    """For a name."""
    flexible: float = Rules.flexible_gate
    """For what follows a measured quantity."""
    error: float = Rules.error_gate
    """For a prediction: times the median error that tracker noise leaves of a healthy robot by the
    healthy model, from which on an error is far above them."""
    margin: float = Rules.gate_margin
    """Times the farthest healthy robot's, where that is more."""

    def under(self, rules: Rules) -> Gates:
        """By other rules than the shipped ones: a gate that these set is where those set it."""
        found = {}
        for name, now in (
            ("cause", rules.cause_gate),
            ("flexible", rules.flexible_gate),
            ("error", rules.error_gate),
        ):
            kept, shipped = getattr(self, name), type(self).model_fields[name].default
            found[name] = now if kept == shipped else max(kept, now)
        return self.model_copy(update=found)

    def of(self, windows: int) -> Gates:
        """As seldom passed by chance where the noise was learned from so few windows."""
        few = {
            name: float(rare(float(np.sqrt(gate)), windows)) ** 2
            for name, gate in (("cause", self.cause), ("flexible", self.flexible))
        }
        return self.model_copy(update=few)


def rare(gate: float, blocks: npt.ArrayLike) -> FloatArray:
    """Standard errors over so many blocks that chance passes as rarely as a normal variable does a
    gate."""
    free = np.maximum(np.asarray(blocks, dtype=np.float64) - 1.0, 1.0)
    return np.asarray(-stdtrit(free, ndtr(-gate)))
