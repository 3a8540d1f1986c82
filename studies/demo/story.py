"""The eight chapters of the demo, each a function of the seed."""

from __future__ import annotations

import io
import json
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from models.log import SAMPLES
from studies.altered import MODEL, AlteredRun, Files, keep, read_files, run_altered
from studies.blind.record import COMMAND, LOG, diagnose
from studies.blind.scoring import Score, score
from studies.blind.trials import Trial
from studies.demo.hide import Secret, draw, run_seed, seal, unseal
from studies.execution import Workers, completed
from studies.experiment import FIXED_GENOMES, RunConfig
from studies.fitness_gap.by_third import coevolution_gap
from studies.gain.measure import Gain, GainRequest, measure_gain
from studies.gain.report import write_gain
from studies.progress import Progress

CHAPTERS = (
    "hide",
    "co-evolve",
    "show the gap",
    "name the cause",
    "extend the model",
    "co-evolve again",
    "measure the gain",
    "unseal and compare",
)


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
    digest: str = ""
    before: list[Files] = field(default_factory=list)
    after: list[Files] = field(default_factory=list)
    fixed: dict[str, Files] = field(default_factory=dict)
    diagnosis: dict[str, Any] | None = None
    """Of `diagnosis.json`; None: the diagnosis failed."""
    failure: str = ""
    gain: Gain | None = None
    truth: dict[str, Any] = field(default_factory=dict)
    score: Score | None = None

    def food(self, runs: list[Files]) -> list[float]:
        """Items per minute of each run."""
        return [len(table(run, "deposits")) / self.size.minutes for run in runs]

    @property
    def bars(self) -> dict[str, float]:
        """Items per minute of the fixed controllers."""
        return {name: self.food([run])[0] for name, run in self.fixed.items()}


def table(run: Files, name: str) -> pd.DataFrame:
    """A run's table."""
    return pd.read_parquet(io.BytesIO(run[f"{name}.parquet"]))


def tell(seed: int, size: Size, out: Path, workers: Workers, *, quiet: bool) -> Story:
    """Live through the story and leave its files in `out`.

    Leaves sealed.json, before/ and after/ (the first run of each), diagnosis/ and gain/.

    Raises:
        RuntimeError: a run failed, or the sealed file was changed.
    """
    story = Story(seed, size, draw(seed))
    chapters = _Chapters(quiet)
    with chapters.next() as shown:
        story.digest = seal(story.secret, _config(story, 0), out / "sealed.json")
        shown.say(f"something is hidden in reality; sealed as {story.digest[:16]}…")
    with chapters.next(size.pairs + len(FIXED_GENOMES)) as shown:
        _first_runs(story, workers, shown.reach)
        keep(_without_truth(story.before[0]), out / "before")
        shown.say(_food_line("the minimal model", story.food(story.before)))
    with chapters.next() as shown:
        shown.say(gap_line(story.before))
    with chapters.next() as shown:
        _name(story, out)
        shown.say(_named_line(story))
    with chapters.next() as shown:
        shown.say(f"the model with what was named: {MODEL} in diagnosis/")
    with chapters.next(size.pairs) as shown:
        _second_runs(story, out, workers, shown.reach)
        keep(_without_truth(story.after[0]), out / "after")
        shown.say(_food_line("the extended model", story.food(story.after)))
    with chapters.next(1.0) as shown:
        _gain(story, out, workers, shown.reach)
    with chapters.next() as shown:
        story.truth = unseal(out / "sealed.json", story.digest)
        story.score = score(_trial(story), story.diagnosis)
        shown.say(verdict_line(story))
    return story


class _Chapters:
    """Names each chapter as it begins."""

    def __init__(self, quiet: bool) -> None:
        self._quiet, self._names = quiet, iter(enumerate(CHAPTERS, start=1))

    @contextmanager
    def next(self, total: float = 1.0) -> Iterator[_Shown]:
        """The next chapter, of `total` parts."""
        number, name = next(self._names)
        with Progress(f"{number}/{len(CHAPTERS)} {name}", total, self._quiet) as progress:
            if not self._quiet:
                progress.say(f"{number}/{len(CHAPTERS)} {name} …")
            yield _Shown(progress, self._quiet)
            progress.reach(total)


class _Shown:
    """How far a chapter is, and what came of it."""

    def __init__(self, progress: Progress, quiet: bool) -> None:
        self._progress, self._quiet = progress, quiet
        self.reach = progress.reach

    def say(self, text: str) -> None:
        """A line for the person watching."""
        if not self._quiet:
            self._progress.say(f"    {text}")


def _config(story: Story, index: int, controller: str = "coevolution") -> RunConfig:
    """Of the run with a number; the first is logged."""
    return RunConfig(
        case=story.secret.case,
        controller=controller,
        minutes=story.size.minutes,
        robots=story.size.robots,
        seed=run_seed(story.seed, index),
        trials=story.size.trials if controller == "coevolution" else 1,
        samples=index == 0 and controller == "coevolution",
    )


def _first_runs(story: Story, workers: Workers, reach: Callable[[float], None]) -> None:
    """Co-evolution with the minimal model, and the fixed controllers, all in altered reality."""
    effects = story.secret.effects
    tasks = {f"{k}": AlteredRun(_config(story, k), effects) for k in range(story.size.pairs)} | {
        name: AlteredRun(_config(story, 0, name), effects) for name in FIXED_GENOMES
    }
    done = _all(tasks, workers, reach)
    story.before = [done[f"{k}"] for k in range(story.size.pairs)]
    story.fixed = {name: done[name] for name in FIXED_GENOMES}


def _second_runs(story: Story, out: Path, workers: Workers, reach: Callable[[float], None]) -> None:
    """The same seeds with the extended model on board; without one, the minimal model again."""
    found = out / "diagnosis"
    model = read_files(found) if found.is_dir() else None
    tasks = {
        f"{k}": AlteredRun(_config(story, k), story.secret.effects, model)
        for k in range(story.size.pairs)
    }
    done = _all(tasks, workers, reach)
    story.after = [done[f"{k}"] for k in range(story.size.pairs)]


def _all(
    tasks: Mapping[str, AlteredRun], workers: Workers, reach: Callable[[float], None]
) -> dict[str, Files]:
    """Every run by name."""
    done: dict[str, Files] = {}
    names = list(tasks)
    with closing(completed(run_altered, list(tasks.values()), workers)) as finished:
        for one in finished:
            name = names[list(tasks.values()).index(one.task)]
            if one.value is None:
                raise RuntimeError(f"run {name}: {one.error}")
            done[name] = one.value
            reach(len(done))
    return done


def _without_truth(run: Files) -> Files:
    """A run's files without its truth, which stays sealed."""
    return {name: content for name, content in run.items() if name != "truth.json"}


def _name(story: Story, out: Path) -> None:
    """Diagnose as the command line does, in a process that has the log alone."""
    with tempfile.TemporaryDirectory(prefix="realitygap-") as scratch:
        given = Path(scratch)
        samples = table(story.before[0], "samples")
        samples = samples[samples["t"] < 60.0 * story.size.log_minutes]
        samples.to_parquet(given / LOG, index=False)
        story.diagnosis, error = diagnose(given, COMMAND)
        story.failure = error or ""
        if story.diagnosis is not None:
            shutil.copytree(given / "diagnosis", out / "diagnosis")


def _gain(story: Story, out: Path, workers: Workers, reach: Callable[[float], None]) -> None:
    """Predictions in fresh runs, which nothing was named from."""
    if story.diagnosis is None:
        return
    request = GainRequest(
        logs=(out / "after" / SAMPLES,),
        extended=str(out / "diagnosis" / MODEL),
        effects=story.secret.effects,
        runs=story.size.held_out,
        minutes=story.size.held_out_minutes,
        seed=run_seed(story.seed, story.size.pairs),
        jobs=workers.jobs,
    )
    story.gain = measure_gain(request, reach)
    (out / "gain").mkdir()
    write_gain(story.gain, out / "gain")


def _trial(story: Story) -> Trial:
    """The story as the blind battery sees it: what was hidden, to be scored alike."""
    return Trial(
        0, "single", 60.0 * story.size.log_minutes, _config(story, 0), (story.secret.hidden,)
    )


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


def _food_line(model: str, food: list[float]) -> str:
    each = ", ".join(f"{one:.1f}" for one in food)
    return f"with {model} on board the swarm brings home {each} items per minute"


def _named_line(story: Story) -> str:
    if story.diagnosis is None:
        return f"the diagnosis gave no answer: {story.failure}"
    names = [str(cause["name"]) for cause in story.diagnosis["causes"]]
    return f"{story.diagnosis['verdict'].replace('_', ' ')}: {', '.join(names) or 'nothing'}"


def verdict_line(story: Story) -> str:
    """What was hidden, and whether it was found."""
    found, hidden = story.score, story.secret.hidden
    assert found is not None
    hid = f"hidden was {hidden.name}"
    if found.exact:
        return f"{hid}: rightly named, and nothing else"
    if found.right[0]:
        return f"{hid}: rightly named, but {', '.join(found.wrong) or 'more'} was named beside it"
    if found.among[0]:
        return f"{hid}: among the candidates that the log could not tell apart"
    return f"{hid}: not named"


def as_json(story: Story) -> dict[str, Any]:
    """The content of `demo.json`."""
    found = story.score
    assert found is not None
    causes = [] if story.diagnosis is None else story.diagnosis["causes"]
    return {
        "schema": 1,
        "seed": story.seed,
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


def write_json(story: Story, path: Path) -> None:
    """Write `demo.json`."""
    path.write_text(json.dumps(as_json(story), indent=1, allow_nan=False) + "\n", encoding="utf-8")
