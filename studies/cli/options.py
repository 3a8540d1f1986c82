"""Options that several commands share, so that they mean the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

Out = Annotated[Path, typer.Option(help="Where to write; must not exist yet.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what is there.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")]
Jobs = Annotated[
    Optional[int],  # noqa: UP045 - typer reads this at run time
    typer.Option(help="Processes; all cores if absent."),
]
Scheduler = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(help="tcp://host:port of a Dask scheduler whose workers have this package."),
]
