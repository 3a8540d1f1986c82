"""`realitygap model`: models of robots."""

from __future__ import annotations

import tomllib
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.outcome import Outcome, command, say_all

models = typer.Typer(no_args_is_help=True, help="Model files of robots.")
app.add_typer(models, name="model")


@models.callback()
def _group() -> None:
    """Model files of robots."""


@command(models, epilog="Example: realitygap model new --wheel-radius 0.033 --axle 0.16 > tb3.toml")
def new(
    wheel_radius: Annotated[float, typer.Option(help="m.")],
    axle: Annotated[float, typer.Option(help="m between the wheels' ground contacts.")],
    body_radius: Annotated[
        float | None, typer.Option(help="m; a circle that holds the wheels if absent.")
    ] = None,
    wheel_speed_max: Annotated[
        float | None, typer.Option(help="rad/s; 1 m/s of the rim if absent.")
    ] = None,
    name: Annotated[str, typer.Option(help="Of the robot.")] = "my robot",
) -> Outcome:
    """Print a model file for a robot on two wheels; --model takes it."""
    text = rg.new_model(
        wheel_radius=wheel_radius,
        axle=axle,
        body_radius=body_radius,
        wheel_speed_max=wheel_speed_max,
        name=name,
    )
    lines = text.rstrip("\n").split("\n")
    return Outcome(tomllib.loads(text), show=lambda: say_all(lines))
