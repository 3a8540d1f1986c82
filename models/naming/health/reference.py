"""The healthy reference: what healthy robots do beyond the model, and how much they differ.

Made from logs of robots known to be sound. It holds the inherent motion, how robots and whole
swarms differ in every coefficient that may differ (`engine.health`), and the gates: how much
deviance something must take off beyond what such differences would. What is named later is what
changed.

The inherent motion is what every healthy robot does that the minimal model leaves out: finite
torque, slip, a lag. Its six numbers are fitted together on healthy logs: speed and turn scale
(slip, effective axle), latency, lag, the wheels' acceleration, and how far ahead of the axle the
point lies that does not slip sideways. They are no fault, and no cause of the catalogue is taken
for one. A negative latency is how a motor that answers in steps looks to a continuous model.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.errors import quoted
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import ALL, Cause, Parameter
from realitygap.models.belief.motion import Motion
from realitygap.models.log.files import Finite, Refused, read_json, write_json
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.rules import Rules

ACCELERATION = 200.0
"""rad/s^2 to start from: what 4 m/s^2 is on 20 mm wheels. No rule: where a fit begins."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    scale, axle, latency, lag, acceleration, centre = (float(v) for v in values)
    drive = motion.drive
    left, right = drive.wheel_radius
    limits = (min(drive.acceleration[0], acceleration), min(drive.acceleration[1], acceleration))
    changed = replace(
        drive,
        wheel_radius=(left * scale, right * scale),
        axle=drive.axle * axle,
        time_constant=max(0.0, drive.time_constant + lag),
        acceleration=limits,
    )
    return replace(
        motion,
        drive=changed,
        motor_delay=motion.motor_delay + latency,
        lever=(motion.lever[0] + centre, motion.lever[1]),
    )


INHERENT = Cause(
    name="inherent",
    meaning="what healthy robots do that the minimal model leaves out",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.2, high=1.5, step=1e-3, link="factor"),
        Parameter(name="axle", unit="1", null=1.0, low=0.3, high=10.0, step=1e-3, link="factor"),
        Parameter(name="latency", unit="s", null=0.0, low=-0.1, high=0.5, step=1e-3),
        Parameter(name="lag", unit="s", null=0.0, low=0.0, high=2.0, step=1e-3),
        Parameter(
            name="acceleration",
            unit="rad/s^2",
            null=ACCELERATION,
            low=1.0,
            high=1e5,
            step=2e-2,
            link="factor",
        ),
        Parameter(name="centre", unit="m", null=0.0, low=-0.02, high=0.02, step=5e-4),
    ),
    change=_change,
    variants=(ALL,),
)


DIRECTORY = Path(__file__).parent / "references"
HOME = "pybullet"
WORLDS = (HOME, "mujoco")
"""Whose healthy robots there are shipped references of: of either engine's world."""
SCHEMA = 2
"""Of the file. No rule."""
LIKE = 0.01
"""Relative difference of two logs' steps that is none: written times are rounded. No rule."""


class Column(Finite):
    """What healthy robots get for one coefficient (`motion.columns`), in its unit."""

    mean: float
    """Beyond the inherent motion."""
    sd: float
    """Between robots, their own uncertainty taken off."""
    swarm_sd: float
    """Between whole swarms (runs)."""


class Spreads(Finite):
    """How healthy robots differ in every coefficient that was measured."""

    model: str
    """Name in the model file it was made with."""
    robots: int
    swarms: int
    """Healthy robots and runs it was made from."""
    columns: dict[str, Column] = Field(default_factory=dict)
    """By name of a coefficient."""
    causes: tuple[str, ...] = ()
    """Names among them that vary jointly,"""
    correlation: tuple[tuple[float, ...], ...] = ()
    """and their correlation between robots, row by row."""
    gates: Gates = Gates()
    recorder: str = ""
    """What recorded the logs it was made from (`MeasuredLog.recorder`), where all say the same,"""
    step: float = 0.0
    """and s between their rows."""
    command: str = ""
    """What made it."""
    schema_number: ClassVar[int]
    """Of files that this program reads."""

    @model_validator(mode="before")
    @classmethod
    def _of_this_schema(cls, values: Any) -> Any:
        """Refuse a reference of another program before its keys are."""
        ours = cls.schema_number
        if isinstance(values, dict) and values.get("schema_version", ours) != ours:
            expected = f"{ours}; make it anew with `realitygap reference`"
            raise Refused("schema_version", quoted(values["schema_version"]), expected)
        return values

    @model_validator(mode="after")
    def _related(self) -> Self:
        """Refuse correlations of other names."""
        square = [len(row) for row in self.correlation]
        if square != [len(self.causes)] * len(self.causes):
            expected = f"{len(self.causes)} rows of as many numbers, one per name in causes"
            raise Refused("correlation", f"rows of {square} numbers", expected)
        for name in self.causes:
            if name not in self.columns:
                raise Refused("causes", repr(name), "names in columns")
        return self

    def recorded_like(self, recorder: str, step: float) -> bool:
        """Whether a log is known to be recorded as the reference's were, rows `step` s apart."""
        return bool(recorder) and recorder == self.recorder and abs(step - self.step) < LIKE * step

    def knows(self, names: Iterable[str]) -> npt.NDArray[np.bool_]:
        """Which coefficients were measured in healthy robots; all, where health is not asked for.

        A whole dose (`motion.columns`) is known where its term's coefficients are; a term
        that has none, such as a limit, is: healthy robots show nothing of it.
        """
        listed = list(names)
        unknown = {n.partition(".")[0] for n in listed if "@" not in n and n not in self.columns}
        known = [
            n.partition("@")[0] not in unknown if "@" in n else n in self.columns for n in listed
        ]
        return np.array([not self.robots or one for one in known])

    def knows_flexible(self, key: str) -> bool:
        """Whether what a channel gets for a quantity was measured."""
        return not self.robots or any(n == key or n.startswith(f"{key} ") for n in self.columns)

    @cached_property
    def learned(self) -> Health:
        """The distribution of healthy robots."""
        names = tuple(self.columns)
        sd = np.array([one.sd for one in self.columns.values()])
        related = np.eye(len(names))
        at = [names.index(name) for name in self.causes]
        if at:
            related[np.ix_(at, at)] = np.array(self.correlation)
        return Health(
            names=names,
            mean=np.array([one.mean for one in self.columns.values()]),
            covariance=related * sd[:, None] * sd,
            swarm=np.array([one.swarm_sd**2 for one in self.columns.values()]),
            robots=self.robots,
            swarms=self.swarms,
        )


class Reference(Spreads):
    """What is believed of healthy robots' motion."""

    schema_number: ClassVar[int] = SCHEMA
    schema_version: int = SCHEMA
    wheel_radius: float
    axle: float
    """m, of the model."""
    inherent: tuple[float, ...]
    """Coordinates of `INHERENT`."""
    inputs: tuple[dict[str, str], ...] = ()
    """The files it was made from: `option`, `file`, `sha256`."""

    @model_validator(mode="after")
    def _sized(self) -> Reference:
        """Refuse coordinates of other terms than ours."""
        if len(self.inherent) != len(INHERENT.parameters):
            expected = f"{len(INHERENT.parameters)} numbers"
            raise Refused("inherent", f"{len(self.inherent)} numbers", expected)
        return self

    def motion(self, believed: Motion) -> Motion:
        """A healthy robot's motion where the model believes another."""
        if not self.robots:
            return believed
        return INHERENT.applied(believed, np.array(self.inherent))

    def knows_term(self, term: Term) -> bool:
        """Whether all of a term's coefficients were measured."""
        if not term.cause.smooth or not all(np.isfinite(p.null) for p in term.cause.parameters):
            return True
        return bool(self.knows(f"{term.key}.{p.name}" for p in term.cause.parameters).all())


def write_reference(reference: Reference, path: Path) -> None:
    """Write as JSON, numbers at full precision."""
    write_json(reference, path)


def read_reference(path: Path) -> Reference:
    """Read a reference file.

    Raises:
        InputError: there is no such file, or it is not a reference.
    """
    what = "a healthy reference of `realitygap reference`, or none"
    return read_json(Reference, path, what, field="--reference")


def world_of(recorder: str) -> str:
    """The world that recorded a log, or the usual one where that is none of ours."""
    recorded = recorder.removeprefix("reality ")
    return recorded if recorded in WORLDS else HOME


def shipped_file(model: str, *, world: str = HOME, manoeuvres: bool = False) -> Path | None:
    """The reference that comes with the package for a model of this name; None: there is none.

    Args:
        model: Name in the model file.
        world: Whose healthy robots: a name in `WORLDS`.
        manoeuvres: Rather that of robots which stop and reverse, where there is one.
    """
    folders = (DIRECTORY / world / "manoeuvres", DIRECTORY / world)[not manoeuvres :]
    files = (path for folder in folders for path in folder.glob("*.json"))
    return next((path for path in files if path.stem == model), None)


def shipped_reference(
    model: str, *, world: str = HOME, manoeuvres: bool = False
) -> Reference | None:
    """The same, read."""
    path = shipped_file(model, world=world, manoeuvres=manoeuvres)
    return None if path is None else read_reference(path)


def no_reference(model: str, drive: Drive, rules: Rules = Rules()) -> Reference:
    """What is believed where nobody measured healthy robots: the minimal model, no spread."""
    return Reference(
        model=model,
        wheel_radius=float(np.mean(drive.wheel_radius)),
        axle=drive.axle,
        robots=0,
        swarms=0,
        inherent=(0.0,) * len(INHERENT.parameters),
    )
