"""`realitygap gap`: what the simulation gets wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from studies.cli import app


@app.command()
def gap(
    log: Annotated[Path, typer.Argument(help="Measured log, or the directory of a run.")],
    out: Annotated[Path, typer.Option(help="Directory to write.")],
    model: Annotated[
        str | None, typer.Option(help="Model file, or the name of a shipped robot.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing directory.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing.")] = False,
) -> None:
    """Show what the simulation gets wrong: replay a measured log through the point model.

    Example: realitygap gap runs/one --out gaps/one
    """
    from models.log import read_log
    from models.modelfile import load_model
    from studies.output import check_free, whole_directory

    check_free(out, force=force)
    point = load_model(model, sensors="ignored")
    measured = read_log(log, drive=point.drive)
    from studies.gap_report import write_gap

    with whole_directory(out, force=force) as part:
        report = write_gap(measured, point, part)
    if not quiet:
        for row in report["horizons"]:
            typer.echo(
                f"{row['horizon']:>6}: {1000 * row['position_median_m']:.2f} mm, "
                f"{row['heading_median_rad']:.4f} rad over {row['windows']} windows"
            )
        typer.echo(f"{out / 'gap.json'}: written")
