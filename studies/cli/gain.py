"""`realitygap gain`: what naming a cause is worth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.options import MOST_RUNS, Force, Jobs, Minutes, Out, Quiet, Seed, within
from realitygap.studies.cli.say import say

EXAMPLE = (
    "Example: realitygap gain --log out/odd --extended out/odd-diagnosis/extended.toml "
    "--effect wheel_radius_mismatch:ratio=1.02,robot=3 --out out/odd-gain"
)


@app.command(epilog=EXAMPLE)
def gain(
    log: Annotated[
        list[Path],
        typer.Option(help="Measured log or run; repeatable. Held out unless it was named from."),
    ],
    extended: Annotated[str, typer.Option(help="The extended.toml of a diagnosis.")],
    out: Out,
    effect: Annotated[
        list[str] | None,
        typer.Option(help="What was hidden: fresh runs are recorded with it; repeatable."),
    ] = None,
    healthy: Annotated[
        list[Path] | None,
        typer.Option(help="Log of sound robots, for the level that can be reached; repeatable."),
    ] = None,
    transfer: Annotated[
        Path | None,
        typer.Option(help="Directory of a finished `study transfer`: the gain in food, beside."),
    ] = None,
    runs: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Fresh runs to record.")
    ] = 6,
    minutes: Minutes = 2.0,
    seed: Seed = 0,
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Measure the gain: how well an extended model predicts runs that nothing was named from.

    Errors by channel and horizon of the minimal model, of healthy robots, of the extended model
    and, where the truth is known, of the true parameters. Writes gain.json, errors.parquet and
    report.html. The gain in food is measured by `realitygap study transfer`.
    """
    from realitygap.studies.gain.measure import GainFailed, measure_gain
    from realitygap.studies.gain.report import write_gain
    from realitygap.studies.gain.request import GainRequest
    from realitygap.studies.output import whole_directory
    from realitygap.studies.progress import Progress

    request = GainRequest(
        logs=tuple(log),
        extended=extended,
        effects=tuple(effect or ()),
        healthy=tuple(healthy or ()),
        transfer=transfer,
        runs=runs,
        minutes=minutes,
        seed=seed,
        jobs=jobs,
    )
    try:
        with whole_directory(out, force=force, holds=("gain.json",)) as part:
            with Progress("gain", 1.0, quiet) as shown:
                found = measure_gain(request, shown.reach)
            lines = write_gain(found, part)
    except GainFailed as error:
        say(f"realitygap: {error}", err=True)
        raise typer.Exit(1) from None
    if not quiet:
        for line in lines:
            say(line)
        say(f"{out / 'report.html'}: written")
