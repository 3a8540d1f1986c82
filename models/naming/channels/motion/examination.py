"""A diagnosis of motion and what it was drawn from."""

from __future__ import annotations

from dataclasses import dataclass, field

import pandas as pd

from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.diagnosis import Diagnosis
from realitygap.models.naming.findings import Identified
from realitygap.models.naming.health.reference import Reference

KINDS = ("model as it was", "of a healthy robot", "extended model")


@dataclass(frozen=True, eq=False, kw_only=True)
class Examination:
    """A diagnosis and what it was drawn from, for what is claimed of it and for the report."""

    tracks: Tracks
    model: ModelFile
    reference: Reference
    identified: Identified
    diagnosis: Diagnosis
    errors: pd.DataFrame = field(default_factory=pd.DataFrame)
    """Per `robot`, `seconds` ahead and `kind` of `KINDS` the mean `error` (m) of the predicted
    position, as in the diagnosis' gain."""
