"""The whole story at once, and the files that it leaves."""

from __future__ import annotations

from pathlib import Path

from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.demo import chapters
from realitygap.studies.demo.report import write_report
from realitygap.studies.demo.story import Size, Story, as_json
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.provenance import write_json


def demo(
    out: Path | str,
    *,
    seed: int = 0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    jobs: int | None = None,
    force: bool = False,
    quiet: bool = True,
) -> Story:
    """Hide an effect, co-evolve, find it in the log alone, correct the simulator, co-evolve again.

    Args:
        out: Directory for report.html, demo.json, demo.png and what each chapter made.
        seed: Everything random follows from it.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        jobs: Processes; all cores if absent.
        force: Replace a demo that is there.
        quiet: Otherwise the story is told on standard error.

    Raises:
        InputError: `out` cannot be used.
        RuntimeError: a run failed, or the sealed file was changed.
    """
    workers, name = Workers.chosen(jobs, None), engine_name(engine)
    sight = rays_name(rays)
    with whole_directory(Path(out), force=force, holds=("demo.json", "run.json")) as part:
        story = chapters.tell(seed, Size(), part, workers, engine=name, rays=sight, quiet=quiet)
        write_json(part / "demo.json", as_json(story))
        write_report(story, part)
    return story
