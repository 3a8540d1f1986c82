"""`realitygap gap`: what the simulation gets wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Out, Quiet, Seed
from realitygap.studies.cli.say import say

EXAMPLE = """Example: realitygap gap out/run1 --out out/gap1"""


@app.command(epilog=EXAMPLE)
def gap(
    log: Annotated[Path, typer.Argument(help="Measured log, or the directory of a run or study.")],
    out: Out,
    model: Model = None,
    seed: Seed = 0,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Show what the simulation gets wrong: replay a measured log through the point model.

    Writes gap.json, tidy tables and figures. A directory with generations.parquet (a run's or a
    study's) adds the gap between simulated and real fitness; without samples, that is all.
    """
    from realitygap.models.gap import measure_gap
    from realitygap.models.log import SAMPLES, read_log
    from realitygap.models.modelfile import find_model_file, load_common, read_model_file
    from realitygap.studies.fitness_gap.by_third import coevolution_gap
    from realitygap.studies.fitness_gap.generations import find_generations, read_generations
    from realitygap.studies.gap_report import write_coevolution, write_gap
    from realitygap.studies.output import whole_directory
    from realitygap.studies.progress import Stages
    from realitygap.studies.provenance import file_read, log_read, model_read

    file = read_model_file(model)
    point = load_common(model, sensors="declared")
    inputs = model_read(model)
    generations = find_generations(log)
    with (
        whole_directory(out, force=force, holds=("gap.json",)) as part,
        Stages("gap", quiet) as shown,
    ):
        evolved = None
        if generations is not None:
            shown.begin("fitness in simulation and reality")
            evolved = coevolution_gap(read_generations(generations))
            inputs.insert(0, file_read("LOG", generations))
        if evolved is not None and not (log / SAMPLES).exists():
            report = write_coevolution(evolved, part, inputs=inputs)
        else:
            shown.begin("reading the log")
            # commands become wheel speeds as in the lab: an extension tells of the robots
            nominal = file.nominal_drive
            measured = read_log(log, drive=nominal, fastest=file.robot.wheel_speed_max)
            inputs.insert(0, log_read("LOG", log))
            shown.begin("replaying it and judging what is left")
            found = measure_gap(measured, file, point, seed=seed, name=find_model_file(model).name)
            shown.begin("writing tables and figures")
            report = write_gap(
                measured, found, part, name=file.name, coevolution=evolved, inputs=inputs
            )
    if not quiet:
        for line in report["summary"]:
            say(line)
        say(f"{out / 'gap.json'}: written")
