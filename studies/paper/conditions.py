"""What a study runs: conditions, runs, and the seed of each run."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from realitygap.reality import constants as k
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.inputs.model import Model
from realitygap.studies.run.experiment import Case, Controller, Minutes, Robots, RunConfig, Seed
from realitygap.studies.run.settings import checked

StudyName = Literal["paper", "readings"]

LAMP_RANGE = 0.8
"""m at which the nominal lamp's contrast fades: `reality.constants.LAMP_POWER` says why."""


@dataclass(frozen=True)
class Condition:
    """A case, a controller, and what is read differently from the default."""

    name: str
    label: str
    """As figures and tables call it."""
    case: Case
    controller: Controller
    variant: str = "default"
    """Which reading of the paper, or which lamp."""
    changes: dict[str, Any] = field(default_factory=dict, hash=False)
    """Fields of `RunConfig` that the variant sets."""
    paired_with: str = ""
    """Key of the condition whose runs have the same seeds; empty: seeds of its own."""

    @property
    def key(self) -> str:
        """Unique among all studies' conditions; runs are named after it and seeded with it."""
        return self.name if self.variant == "default" else f"{self.variant}.{self.name}"


def _as_dense(robots: int) -> dict[str, Any]:
    """So many robots in an arena in which ten would be as dense, its lamp seen as far across it."""
    wider = float(np.sqrt(robots / 10.0))
    return {
        "robots": robots,
        "arena_radius": k.ARENA_RADIUS * wider,
        "lamp_range": LAMP_RANGE * wider,
    }


PAPER = (
    Condition("no-light", "No light", "no-light", "coevolution"),
    Condition("at-nest", "Light at nest", "light-at-nest", "coevolution"),
    Condition("opposite", "Light opposite nest", "light-opposite-nest", "coevolution"),
    Condition("at-nest-to-opposite", "At nest → opposite", "at-nest-to-opposite", "coevolution"),
    Condition("opposite-to-at-nest", "Opposite → at nest", "opposite-to-at-nest", "coevolution"),
    Condition("fixed-search", "Fixed search", "no-light", "search"),
    Condition("fixed-positive", "Fixed positive", "light-at-nest", "positive-phototaxis"),
    Condition("fixed-negative", "Fixed negative", "light-opposite-nest", "negative-phototaxis"),
)
"""The eight conditions in the order of the paper's Fig. 6 (sections III-I, IV-A)."""

MIXTURE = (
    Condition(
        *("fixed-to-and-fro", "Fixed to and fro", "light-at-nest", "to-and-fro"),
        paired_with="fixed-positive",
    ),
    Condition(
        *("fixed-mixture", "Fixed mixture", "light-at-nest", "half-to-and-fro"),
        paired_with="fixed-positive",
    ),
    Condition(
        *("fixed-mixture-7-3", "Fixed mixture 7:3", "light-at-nest", "most-to-and-fro"),
        paired_with="fixed-positive",
    ),
)
"""With light at the nest mostly two controllers evolve, that of `fixed-positive` and `to-and-fro`:
the second alone, half of each, and seven of the second with three of the first, on the seeds of the
first alone. Not the paper's: they ask why co-evolution collects more than the fixed positive
controller."""

SIZED = tuple(
    replace(PAPER[4], variant=f"robots{robots}", changes=_as_dense(robots))
    for robots in (5, 20, 40)
)
"""Other numbers of robots, after whose relocation the light is useful again."""

STUDIED = (*PAPER, *MIXTURE)
COEVOLVED = PAPER[:5]
LABELS = {condition.name: condition.label for condition in STUDIED}


class StudyConfig(BaseModel):
    """Everything a study's results depend on."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    study: StudyName = "paper"
    runs: Annotated[int, Field(ge=1, le=10_000)] = 10
    """Of each condition; until decided, of a batch."""
    until_decided: bool = False
    """Batches are added to conditions whose claims are open."""
    minutes: Minutes = 60.0
    robots: Robots = 10
    seed: Seed = 0
    engine: EngineName = DEFAULT
    rays: RaysName = DEFAULT_RAYS
    model: str | None = None
    """Model file on board; None: the shipped nominal e-puck."""
    model_hash: str | None = None
    """SHA-256 over that file and its sensor tables: a study is resumed with the same model only."""


@dataclass(frozen=True)
class PlannedRun:
    """One run of a study."""

    name: str
    condition: Condition
    index: int
    config: RunConfig
    model_hash: str | None = None
    """As the study's."""

    @property
    def made_from(self) -> dict[str, Any]:
        """All that its files are a function of but the program."""
        return {"config": self.config.model_dump(mode="json"), "model_hash": self.model_hash}

    @property
    def cost(self) -> float:
        """Expected computing time in any unit: co-evolution adds about a tenth to the physics."""
        return (
            self.config.minutes
            * self.config.robots
            * (1.1 if self.condition.controller == "coevolution" else 1.0)
        )


def run_seed(study_seed: int, condition: str, index: int) -> int:
    """The seed of one run, whatever other conditions and runs the study has.

    An integer below 2**32, so that `realitygap run --seed` repeats the run.
    """
    purpose = (zlib.crc32(condition.encode()), index)
    sequence = np.random.SeedSequence(study_seed, spawn_key=purpose)
    return int(sequence.generate_state(1, np.uint32)[0])


def plan(
    study: StudyConfig, conditions: Iterable[Condition], runs: Mapping[str, int] | None = None
) -> tuple[PlannedRun, ...]:
    """All runs of a study, by condition and index.

    Args:
        study: What is run.
        conditions: Under which.
        runs: Of each condition, by key; the study's `runs` if absent.
    """
    return tuple(
        PlannedRun(
            name=f"{condition.key}-{index:02d}",
            condition=condition,
            index=index,
            config=RunConfig(
                case=condition.case,
                controller=condition.controller,
                minutes=study.minutes,
                seed=run_seed(study.seed, condition.paired_with or condition.key, index),
                samples=False,
                model=study.model,
                engine=study.engine,
                rays=study.rays,
                **{"robots": study.robots, **condition.changes},
            ),
            model_hash=study.model_hash,
        )
        for condition in conditions
        for index in range(study.runs if runs is None else runs[condition.key])
    )


def study_config(**values: Any) -> StudyConfig:
    """A study's configuration.

    Raises:
        InputError: the first value that cannot be used, or the model.
    """
    config = checked(StudyConfig, values)
    if config.model is None:
        return config
    model = Model.load(config.model)
    model.on_board(config.robots)  # refused now, not in every worker
    assert model.path is not None
    path = str(model.path.resolve())
    return config.model_copy(update={"model": path, "model_hash": model.digest})
