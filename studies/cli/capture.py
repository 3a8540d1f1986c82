"""`realitygap capture`: the sensor tables of the embedded simulator."""

from __future__ import annotations

from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Out, Quiet, Seed

EXAMPLE = """Example: realitygap capture --out epuck.npz"""


@app.command(epilog=EXAMPLE)
def capture(
    out: Out,
    seed: Seed = 0,  # of the shipped table
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read."""
    import numpy as np

    from realitygap.models import load_tables, save_tables
    from realitygap.reality.capture import capture as drive_protocol
    from realitygap.studies.output import readable, whole_file
    from realitygap.studies.progress import Progress

    with (
        whole_file(out, force=force, ours=readable(load_tables)) as part,
        Progress("capture", 1.0, quiet) as shown,
    ):
        save_tables(drive_protocol(np.random.SeedSequence(seed), shown.reach), part)
    shown.say(f"sensor tables in {out}")
