"""The demo's story: what its chapters found, in words and as `demo.json`."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.blind.scoring import Score
from realitygap.studies.demo.hide import Secret
from realitygap.studies.fitness_gap.generations import coevolution_gap
from realitygap.studies.gain.result import GainResult
from realitygap.studies.run.altered import Files


@dataclass(frozen=True, kw_only=True)
class Size:
    """How long the story is."""

    minutes: float = 10.0
    """Simulated, of each co-evolution."""
    pairs: int = 3
    """Co-evolutions before and after, on the same seeds."""
    robots: int = 10
    trials: int = 16
    """Embedded trials per genome: see `studies.transfer.plan.TRIALS`."""
    log_minutes: float = 4.0
    """From the beginning of the first run: what is diagnosed."""
    held_out: int = 3
    """Fresh runs in which predictions are judged."""
    held_out_minutes: float = 2.0


@dataclass
class Story:
    """What the chapters found, in their order."""

    seed: int
    size: Size
    secret: Secret
    engine: EngineName = DEFAULT
    rays: RaysName = DEFAULT_RAYS
    digest: str = ""
    before: list[Files] = field(default_factory=list)
    after: list[Files] = field(default_factory=list)
    fixed: dict[str, Files] = field(default_factory=dict)
    diagnosis: dict[str, Any] | None = None
    """Of `diagnosis.json`; None: the diagnosis failed."""
    failure: str = ""
    gain: GainResult | None = None
    truth: dict[str, Any] = field(default_factory=dict)
    score: Score | None = None

    def food(self, runs: list[Files]) -> list[float]:
        """Items per minute of each run."""
        return [len(table(run, "deposits")) / self.size.minutes for run in runs]

    @property
    def bars(self) -> dict[str, float]:
        """Items per minute of the fixed controllers."""
        return {name: self.food([run])[0] for name, run in self.fixed.items()}

    @property
    def verdict(self) -> str:
        """What was hidden, and whether it was found."""
        found, hidden = self.score, self.secret.hidden
        assert found is not None
        hid = f"hidden was {hidden.name}"
        if found.exact:
            return f"{hid}: rightly named, and nothing else"
        if found.right[0]:
            return (
                f"{hid}: rightly named, but {', '.join(found.wrong) or 'more'} was named beside it"
            )
        if found.among[0]:
            return f"{hid}: among the candidates that the log could not tell apart"
        return f"{hid}: not named"


def table(run: Files, name: str) -> pd.DataFrame:
    """A run's table."""
    return pd.read_parquet(io.BytesIO(run[f"{name}.parquet"]))


def gap_line(runs: list[Files]) -> str:
    """What simulators promised and reality paid."""
    generations = pd.concat([table(run, "generations") for run in runs], ignore_index=True)
    found = coevolution_gap(generations)
    if found is None:
        return "no generation was finished"
    told = found.report
    return (
        f"a controller was promised {told['fitness_sim']:.0f} s by the simulator that bred it and "
        f"earned {told['fitness_real']:.0f} s in reality"
    )


def food_line(model: str, food: list[float]) -> str:
    """Items per minute of each run with a model on board."""
    each = ", ".join(f"{one:.1f}" for one in food)
    return f"with {model} on board the swarm brings home {each} items per minute"


def named_line(story: Story) -> str:
    """What the diagnosis answered."""
    if story.diagnosis is None:
        return f"the diagnosis gave no answer: {story.failure}"
    names = [str(cause["name"]) for cause in story.diagnosis["causes"]]
    return f"{story.diagnosis['verdict'].replace('_', ' ')}: {', '.join(names) or 'nothing'}"


def as_json(story: Story) -> dict[str, Any]:
    """The content of `demo.json`."""
    found = story.score
    assert found is not None
    causes = [] if story.diagnosis is None else story.diagnosis["causes"]
    return {
        "schema": 1,
        "seed": story.seed,
        "engine": story.engine,
        "rays": story.rays,
        "sealed_sha256": story.digest,
        "hidden": story.truth,
        "diagnosis": {
            "verdict": found.verdict,
            "causes": causes,
            "right": found.exact,
            "named": found.right[0],
            "candidate": found.among[0],
            "wrong": list(found.wrong),
        },
        "food": {
            "unit": "items per minute",
            "before": story.food(story.before),
            "after": story.food(story.after),
            "fixed": story.bars,
        },
        "prediction": [] if story.gain is None else story.gain.content["errors"],
    }
