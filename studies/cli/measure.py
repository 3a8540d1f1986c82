"""`realitygap measure`: what the documents say of this program, measured again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    MOST_RUNS,
    Engine,
    Force,
    Jobs,
    Minutes,
    Out,
    Quiet,
    Rays,
    Seed,
    StudyOut,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command, resumable, say

measure = typer.Typer(
    name="measure",
    help="What this program's own documents say of it, measured again.",
    no_args_is_help=True,
    rich_markup_mode="rich",
)
app.add_typer(measure)


@command(measure, epilog="Example: realitygap measure bench --out out/bench.json")
def bench(
    out: Out,
    minutes: Minutes = 5.0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Time reality, bare physics and the embedded simulator in one process."""
    from realitygap.studies.measure.bench import bench
    from realitygap.studies.plumbing.progress import Progress

    with Progress("bench", 1.0, quiet) as shown:
        reach = shown.reach
        found = bench(out, minutes=minutes, engine=engine, rays=rays, force=force, reach=reach)
    notes = [f"{name}: {value:.4g}" for name, value in found.items() if isinstance(value, float)]
    notes.append(f"the time of {found['robots']} robots co-evolving for {minutes:g} min goes to")
    notes += [f"  {part}: {100.0 * share:.1f} %" for part, share in found["shares"].items()]
    fast = found["co_evolution_times_real_time"]
    line = f"{found['robots']} robots co-evolve {fast:.3g} times as fast as time"
    return Outcome(found, line, out, notes)


@command(measure, epilog="Example: realitygap measure scaling --out out/scaling")
def scaling(
    out: Out,
    minutes: Minutes = 1.0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """How a run's cost grows with robots (runs of --minutes) and with minutes, with a figure."""
    from realitygap.studies.measure.scaling import scaling
    from realitygap.studies.plumbing.progress import Progress

    with Progress("runs", 1.0, quiet) as shown:
        reach = shown.reach
        table = scaling(out, minutes=minutes, engine=engine, rays=rays, force=force, reach=reach)
    notes = table.to_string(index=False).splitlines()
    return Outcome(table, f"{len(table)} runs timed", out, notes)


@command(measure, epilog="Example: realitygap measure convergence")
def convergence() -> Outcome:
    """Print whether the physics is converged: its settings against finer ones (Markdown)."""
    from realitygap.studies.measure.convergence import convergence

    text = convergence()
    return Outcome({"markdown": text}, show=lambda: typer.echo(text, nl=False))


@command(measure, epilog="Example: realitygap measure inherent-gap --out out/inherent-gap")
def inherent_gap(
    out: Out,
    seeds: Annotated[int, typer.Option(callback=within(2, MOST_RUNS), help="Runs.")] = 24,
    minutes: Minutes = 2.0,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """What the world does that the point model does not, with nothing hidden: tables, a figure."""
    from realitygap.studies.measure.inherent_gap import inherent_gap
    from realitygap.studies.plumbing.progress import Progress

    with Progress("runs", 1.0, quiet) as shown:
        inherent_gap(out, seeds=seeds, minutes=minutes, force=force, reach=shown.reach)
    return Outcome(out / "inherent-gap.json", f"{seeds} runs with nothing hidden", out)


@command(measure, epilog="Example: realitygap measure ambiguous --trials 6 --out out/ambiguous.csv")
def ambiguous(
    out: Out,
    trials: Annotated[int, typer.Option(callback=within(1, MOST_RUNS), help="Of each pair.")] = 6,
    seed: Seed = 1,
    only: Annotated[
        list[str] | None, typer.Option(help="Pair of causes, repeatable; all if absent.")
    ] = None,
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Whether the proposed manoeuvre settles what a log left open (docs/next-experiment.md)."""
    from realitygap.studies.measure.ambiguous import ambiguous

    table = ambiguous(
        out,
        trials=trials,
        seed=seed,
        only=only or (),
        jobs=jobs,
        force=force,
        say=(lambda line: None) if quiet else say,
    )
    asked = table[table["ambiguous"]]
    counted = asked.groupby("pair")["right"].agg(["sum", "count"])
    line = f"{asked['right'].sum()} of {len(asked)} ambiguous logs settled rightly"
    return Outcome(table, line, out, counted.to_string().splitlines())


@command(measure, epilog="Example: realitygap measure real --data DATA --out out/real")
def real(
    out: Out,
    data: Annotated[
        Path | None,
        typer.Option(help="Folder of logs; REALITYGAP_DATA if absent."),
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Beginning of a data set's name, repeatable.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Real robots' logs: what is named, and how later runs are predicted beside rivals."""
    from realitygap.studies.measure.real_pages import INDEX, real

    table = real(
        out,
        data=data,
        only=tuple(only or ()),
        force=force,
        begin=(lambda line: None) if quiet else say,
    )
    page = (out / INDEX).read_text(encoding="utf-8")
    notes = [line for line in page.splitlines() if line.startswith("|")]
    return Outcome(table, f"{table['data'].nunique()} data sets measured", out / INDEX, notes)


@command(
    measure, epilog="Example: realitygap measure healthy-scores out/healthy/* --out scores.png"
)
def healthy_scores(
    log: Annotated[list[Path], typer.Argument(help="Runs of healthy e-pucks, equally many each.")],
    out: Out,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """How scores are distributed in healthy logs: a figure, and shares beyond some distances."""
    from realitygap.studies.measure.healthy_scores import healthy_scores

    lines = healthy_scores(log, out, force=force)
    *notes, line = lines
    return Outcome({"lines": lines}, line, out, notes)


@command(measure, epilog="Example: realitygap measure gain --runs 2 --minutes 1 --out out/gains")
def gain(
    out: StudyOut,
    times: Annotated[float, typer.Option(help="Sizes in bars of the blind battery.")] = 2.0,
    runs: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Held-out runs of each reality.")
    ] = 6,
    minutes: Minutes = 2.0,
    draws: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Times every effect is drawn.")
    ] = 1,
    seed: Seed = 0,
    jobs: Jobs = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Effect, repeatable; all that have a term if absent.")
    ] = None,
    quiet: Quiet = False,
) -> Outcome:
    """Hide every effect, name it from one log, extend the model, measure on held-out runs.

    Writes catalogue.csv and catalogue.md; resumes like `study paper`.
    """
    from realitygap.studies.measure.gain_table import measure_gains

    with resumable():
        table = measure_gains(
            out,
            times=times,
            runs=runs,
            minutes=minutes,
            draws=draws,
            seed=seed,
            jobs=jobs,
            only=only or (),
            say=(lambda line: None) if quiet else say,
        )
    *notes, line = table.strip().splitlines()
    return Outcome(out / "catalogue.csv", line, out / "catalogue.md", notes)
