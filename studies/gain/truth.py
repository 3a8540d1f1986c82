"""What was hidden, where somebody knows: from SPECs, or from the `truth.json` beside a run."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.opened import json_values, parsing
from realitygap.reality.effects import HiddenEffect, catalogue
from realitygap.reality.effects.spec import parse, spec_of
from realitygap.studies.hidden.shares import oracle

TRUTH = "truth.json"
EXPECTED = "the truth.json of a run"
ANY = 10**9
"""More robots than a run can have: which of them there are is not in the file."""


def hidden_in(run: Path) -> tuple[HiddenEffect, ...] | None:
    """What a run's `truth.json` says; None where there is none, as in a lab, or where it tells of
    something that no catalogue lists.

    Raises:
        InputError: it is no such file.
    """
    path = run / TRUTH
    if not os.path.lexists(path):
        return None
    told = json_values(path, EXPECTED)
    with parsing(str(path), EXPECTED):
        effects = list(told["effects"])
        if any(one["name"] not in catalogue() for one in effects):
            return None
        try:
            return tuple(parse(spec_of(one), catalogue(), ANY) for one in effects)
        except InputError as error:
            raise InputError(str(path), error, EXPECTED) from None


def told(hidden: Sequence[HiddenEffect]) -> str:
    """What is hidden as one line, the same for the same."""
    return json.dumps([one.truth() for one in hidden], sort_keys=True)


def concerned(hidden: Sequence[HiddenEffect]) -> set[int] | None:
    """Robots that something was hidden in; None: all of them."""
    if any(not one.robots for one in hidden):
        return None
    return {robot for one in hidden for robot in one.robots}


def true_model(plain: ModelFile, hidden: Sequence[HiddenEffect]) -> ModelFile | None:
    """The model with the true parameters; None where the point model has no term for an effect, or
    none of that size."""
    causes = [every_cause().get(one.effect.name) for one in hidden]
    if any(cause is None or not cause.identifiable for cause in causes):
        return None
    try:
        return plain.model_copy(update={"extension": oracle(hidden)})
    except ValidationError:
        return None
