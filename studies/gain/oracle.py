"""The model that knows what was hidden: effects' true values as an extension.

An effect and the cause it is named as share their name and keys; nothing else is known of one
another, so this is the one place where they meet, after the fact.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from embedded_sim.errors import InputError
from models.catalogue import every_cause
from models.extension import Extension, NamedCause, ParameterValue
from models.modelfile import ModelFile
from reality.effects import parse_effects

TRUTH = "truth.json"


def hidden_by(effects: Sequence[str], robots: int) -> list[dict[str, Any]]:
    """The entries of `truth.json` that SPECs make.

    Raises:
        InputError: a SPEC that cannot be hidden.
    """
    return [dict(one.truth()) for one in parse_effects(tuple(effects), robots)]


def hidden_in(run: Path) -> list[dict[str, Any]] | None:
    """What a run's `truth.json` says; None where there is none, as in a lab."""
    path = run / TRUTH
    if not path.is_file():
        return None
    try:
        return list(json.loads(path.read_text(encoding="utf-8"))["effects"])
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(str(path), "something else", "the truth.json of a run") from None


def concerned(hidden: Sequence[dict[str, Any]]) -> set[int] | None:
    """Robots that something was hidden in; None: all of them."""
    if any(one["robots"] == "all" for one in hidden):
        return None
    return {int(robot) for one in hidden for robot in one["robots"]}


def oracle(plain: ModelFile, hidden: Sequence[dict[str, Any]]) -> ModelFile | None:
    """The model with the true parameters; None where the catalogue of causes lacks an effect, or
    knows no term for it."""
    causes = []
    for one in hidden:
        cause = every_cause().get(str(one["name"]))
        if cause is None or not cause.identifiable:
            return None
        values = dict(one["parameters"])
        word = str(values.pop(cause.word)) if cause.word else cause.variants[0]
        try:
            causes.append(
                NamedCause(
                    name=cause.name,
                    robots="all" if one["robots"] == "all" else tuple(one["robots"]),
                    word=word,
                    parameters={
                        key: ParameterValue(value=float(value)) for key, value in values.items()
                    },
                )
            )
        except ValidationError:
            return None  # a size that no model would believe
    return plain.model_copy(update={"extension": Extension(causes=tuple(causes))})
