"""What the study runs: per alteration the same seeds under three models and fixed controllers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.inputs.model import Model
from realitygap.studies.paper.conditions import run_seed
from realitygap.studies.run.experiment import (
    FIXED_GENOMES,
    GenomeName,
    Minutes,
    Robots,
    RunConfig,
    Seed,
    Trials,
)
from realitygap.studies.run.settings import checked
from realitygap.studies.transfer.alterations import Alteration

ModelKind = Literal["minimal", "extended", "oracle"]
MODELS: tuple[ModelKind, ...] = ("minimal", "extended", "oracle")
TRIALS = 16
"""60 s trials per genome. One has a standard deviation of 20 to 35 s on means of 16 s (search) to
64 s (the best controller), so that the best of ten single trials is mostly luck. Of 16 the mean has
5 to 9 s: enough to tell what pays three times as much, as the best of nine does. Our choice."""
LOG_MINUTES = 4.0
"""Minutes of the log that is diagnosed: four generations of ten robots; our choice."""


class TransferConfig(BaseModel):
    """Everything the study's results depend on."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    study: Literal["transfer"] = "transfer"
    alterations: Annotated[tuple[Alteration, ...], Field(min_length=1)]
    runs: Annotated[int, Field(ge=1, le=10_000)] = 10
    """Paired runs of each model."""
    bars: Annotated[int, Field(ge=0, le=10_000)] = 3
    """Runs of each of the three fixed controllers, on the first of the same seeds."""
    minutes: Minutes = 20.0
    log_minutes: Minutes = LOG_MINUTES
    robots: Robots = 10
    seed: Seed = 0
    engine: EngineName = DEFAULT
    rays: RaysName = DEFAULT_RAYS
    trials: Trials = TRIALS
    genome: GenomeName = "paper"
    extended: str | None = None
    """A given extended model; None: diagnosed from a log recorded in the altered reality."""
    extended_hash: str | None = None
    """SHA-256 over that file and its sensor tables: a study is resumed with the same only."""


@dataclass(frozen=True)
class TransferRun:
    """One run."""

    name: str
    alteration: Alteration
    controller: str
    """The model on board, or a fixed controller."""
    index: int
    config: RunConfig
    model: Mapping[str, Any] | None = field(default=None, hash=False)
    """What the model on board is made from; None: it is the shipped one, or there is none."""

    @property
    def made_from(self) -> dict[str, Any]:
        """All that its files are a function of but the program."""
        return {
            "config": self.config.model_dump(mode="json"),
            "effects": self.effects,
            "model": self.model,
        }

    @property
    def cost(self) -> float:
        """All runs of a kind are equal, so that they are done in the plan's order."""
        return self.config.minutes * self.config.robots

    @property
    def effects(self) -> tuple[str, ...]:
        """What is hidden in it."""
        return self.alteration.effects


def plan(study: TransferConfig) -> tuple[TransferRun, ...]:
    """All runs: first pairs of the minimal and the extended model, then the bars, then the oracle.

    A study that is stopped early so has whole pairs.
    """
    runs = []
    for index in range(study.runs):
        for one in study.alterations:
            runs += [_run(study, one, model, index) for model in ("minimal", "extended")]
    for index in range(min(study.bars, study.runs)):
        for one in study.alterations:
            runs += [_run(study, one, controller, index) for controller in FIXED_GENOMES]
    for index in range(study.runs):
        runs += [_run(study, one, "oracle", index) for one in study.alterations]
    return tuple(runs)


def _run(study: TransferConfig, one: Alteration, controller: str, index: int) -> TransferRun:
    fixed = controller in FIXED_GENOMES
    return TransferRun(
        name=f"{one.name}.{controller}-{index:02d}",
        alteration=one,
        controller=controller,
        index=index,
        config=RunConfig(
            case=one.case,
            controller=controller if fixed else "coevolution",
            minutes=study.minutes,
            robots=study.robots,
            seed=run_seed(study.seed, f"transfer.{one.name}", index),
            samples=False,
            trials=1 if fixed else study.trials,
            genome="paper" if fixed else study.genome,
            engine=study.engine,
            rays=study.rays,
        ),
        model=model_origin(study, one, controller),
    )


def model_origin(study: TransferConfig, one: Alteration, kind: str) -> dict[str, Any] | None:
    """What the extended or the oracle's model of an alteration is made from; None: neither."""
    if kind == "oracle":
        return {"oracle": one.effects, "robots": study.robots}
    if kind != "extended":
        return None
    if study.extended is not None:
        return {"given": study.extended_hash}
    log = log_config(study, one)
    return {"diagnosed": one.effects, "config": log.model_dump(mode="json")}


def log_config(study: TransferConfig, one: Alteration) -> RunConfig:
    """The run whose log is diagnosed: the minimal model on board, a seed of its own."""
    return RunConfig(
        case=one.case,
        minutes=study.log_minutes,
        robots=study.robots,
        seed=run_seed(study.seed, f"transfer.{one.name}.log", 0),
        engine=study.engine,
        rays=study.rays,
    )


def transfer_config(**values: Any) -> TransferConfig:
    """The study's configuration.

    Raises:
        InputError: the first value that cannot be used, or the given model.
    """
    config = checked(TransferConfig, values)
    if config.extended is None:
        return config
    model = Model.load(config.extended)
    model.on_board(config.robots)  # refused now, before anything is written
    assert model.path is not None
    path = str(model.path.resolve())
    return config.model_copy(update={"extended": path, "extended_hash": model.digest})
