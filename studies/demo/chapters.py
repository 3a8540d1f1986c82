"""The eight chapters of the demo, each a function of the seed."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from realitygap.models.log.measured import SAMPLES
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.blind.examiner import LOG
from realitygap.studies.blind.record import diagnose
from realitygap.studies.blind.scoring import score
from realitygap.studies.blind.trials import Trial
from realitygap.studies.demo.hide import draw, run_seed, seal, unseal
from realitygap.studies.demo.story import (
    Size,
    Story,
    food_line,
    gap_line,
    named_line,
)
from realitygap.studies.gain.measure import gain
from realitygap.studies.plumbing.execution import Workers, completed
from realitygap.studies.plumbing.progress import Progress
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.altered import MODEL, AlteredRun, Files, keep, read_files, run_altered
from realitygap.studies.run.experiment import ANONYMOUS, FIXED_GENOMES, RunConfig

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


def tell(
    seed: int,
    size: Size,
    out: Path,
    workers: Workers,
    *,
    engine: EngineName = DEFAULT,
    rays: RaysName = DEFAULT_RAYS,
    quiet: bool,
) -> Story:
    """Live through the story and leave its files in `out`.

    Leaves sealed.json, before/ and after/ (the first run of each), diagnosis/ and gain/.

    Raises:
        RuntimeError: a run failed, or the sealed file was changed.
    """
    story = Story(seed, size, draw(seed), engine, rays)
    with _chapter(1, quiet) as shown:
        story.digest = seal(story.secret, _config(story, 0), out / "sealed.json")
        shown.say(f"    something is hidden in reality; sealed as {story.digest[:16]}…")
    with _chapter(2, quiet, size.pairs + len(FIXED_GENOMES)) as shown:
        _first_runs(story, workers, shown.reach)
        keep(_without_truth(story.before[0]), out / "before")
        shown.say(f"    {food_line('the minimal model', story.food(story.before))}")
    with _chapter(3, quiet) as shown:
        shown.say(f"    {gap_line(story.before)}")
    with _chapter(4, quiet) as shown:
        _name(story, out)
        shown.say(f"    {named_line(story)}")
    with _chapter(5, quiet) as shown:
        shown.say(f"    the model with what was named: {MODEL} in diagnosis/")
    with _chapter(6, quiet, size.pairs) as shown:
        _second_runs(story, out, workers, shown.reach)
        keep(_without_truth(story.after[0]), out / "after")
        shown.say(f"    {food_line('the extended model', story.food(story.after))}")
    with _chapter(7, quiet) as shown:
        _gain(story, out, workers, shown.reach)
    with _chapter(8, quiet) as shown:
        story.truth = unseal(out / "sealed.json", story.digest)
        story.score = score(_trial(story), story.diagnosis)
        shown.say(f"    {story.verdict}")
    return story


@contextmanager
def _chapter(number: int, quiet: bool, total: float = 1.0) -> Iterator[Progress]:
    """Names a chapter of `total` parts as it begins."""
    name = f"{number}/{len(CHAPTERS)} {CHAPTERS[number - 1]}"
    with Progress(name, total, quiet) as shown:
        shown.say(f"{name} …")
        yield shown
        shown.reach(total)


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
        engine=story.engine,
        rays=story.rays,
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
    with scratch() as given:
        samples = pq.read_table(pa.BufferReader(story.before[0][SAMPLES]))
        samples = samples.filter(pc.field("t") < 60.0 * story.size.log_minutes)
        run = samples.schema.get_field_index("run")
        nobody = pa.array([ANONYMOUS] * len(samples))
        # the file goes on saying what recorded it, which a table of pandas would not
        pq.write_table(samples.set_column(run, "run", nobody), given / LOG)
        story.diagnosis, error = diagnose(given)
        story.failure = error or ""
        if story.diagnosis is not None:
            shutil.copytree(given / "diagnosis", out / "diagnosis")


def _gain(story: Story, out: Path, workers: Workers, reach: Callable[[float], None]) -> None:
    """Predictions in fresh runs, which nothing was named from."""
    if story.diagnosis is None:
        return
    story.gain = gain(
        out / "after" / SAMPLES,
        out / "diagnosis" / MODEL,
        effects=story.secret.effects,
        runs=story.size.held_out,
        minutes=story.size.held_out_minutes,
        seed=run_seed(story.seed, story.size.pairs),
        engine=story.engine,
        rays=story.rays,
        jobs=workers.jobs,
        out=out / "gain",
        reach=reach,
    )


def _trial(story: Story) -> Trial:
    """The story as the blind battery sees it: what was hidden, to be scored alike."""
    return Trial(
        0, "single", 60.0 * story.size.log_minutes, _config(story, 0), (story.secret.hidden,)
    )
