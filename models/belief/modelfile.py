"""Model files: what a simulator believes about one kind of robot, its arena and its lamps.

A model file is TOML with the tables `[robot]`, `[arena]`, `[lamps]`, `[sensors]` and `[extension]`
(`belief.extension`); only `[robot]` must be there. Units are SI, axes REP-103. Robots we ship are
known by name (`SHIPPED`).
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from realitygap.embedded_sim import Drive, InputError, PointModel, Tables
from realitygap.embedded_sim.errors import nearest
from realitygap.models.belief.extension import Extension
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.tables import load_tables
from realitygap.models.log.files import Refused, Table, checked
from realitygap.models.log.opened import toml_values

ROBOTS = Path(__file__).parent / "robots"
SHIPPED = tuple(sorted(path.stem for path in ROBOTS.glob("*.toml")))
"""Names of the model files that come with the package."""
DEFAULT = "epuck"

Length = Annotated[float, Field(gt=0.0, le=100.0, allow_inf_nan=False)]
"""m; nothing in an arena of wheeled robots is longer than 100 m."""
Coordinate = Annotated[float, Field(ge=-100.0, le=100.0, allow_inf_nan=False)]
Sensing = Literal["required", "declared", "ignored"]
ROOM = 0.01
"""Share of a robot's reach by which the nest must leave it free at its far side, our choice: then
0.06 % of the places drawn for food are outside it at least, of some 100 000 that C draws."""


class RobotSection(Table):
    """`[robot]`: a body on two wheels."""

    wheel_radius: Length
    """m."""
    axle: Length
    """m between the wheels' ground contacts."""
    body_radius: Length
    """m."""
    wheel_speed_max: Annotated[float, Field(gt=0.0, le=1000.0)]
    """rad/s; only judges whether a log's commands are plausible: the point model does not clip."""
    drive_kind: Literal["differential", "skid"] = "differential"
    """`skid`: wheels that slip sideways in every turn; then slip and effective axle are told, and
    no other radius or separation of the wheels."""


class Circle(Table):
    """A circle on the floor."""

    x: Coordinate
    y: Coordinate
    radius: Length


class Point(Table):
    """A place on the floor."""

    x: Coordinate
    y: Coordinate


_NOMINAL = PointModel()


class Arena(Table):
    """`[arena]`: a circular wall about the origin, the nest, and the food."""

    radius: Length = _NOMINAL.arena_radius
    nest: Circle = Circle(x=_NOMINAL.nest[0], y=_NOMINAL.nest[1], radius=_NOMINAL.nest[2])
    food_items: Annotated[int, Field(ge=1, le=32)] = _NOMINAL.food_items
    food_radius: Length = _NOMINAL.food_radius


class Lamps(Table):
    """`[lamps]`: where the lamp stands when it is on, by scenario."""

    opposite: Point | None = None
    at_nest: Point | None = None


class Sensors(Table):
    """`[sensors]`: the captured tables."""

    tables: Annotated[Path, Field(strict=False)]
    """An .npz of `realitygap capture`, relative to the model file."""


class ModelFile(Table):
    """A whole model file."""

    name: Annotated[str, Field(min_length=1)]
    robot: RobotSection
    arena: Arena | None = None
    """Absent: motion in the open; the wall is not modelled and place means nothing."""
    lamps: Lamps = Lamps()
    sensors: Sensors | None = None
    """Absent: only motion is modelled."""
    extension: Extension | None = None
    """Absent: the minimal model."""

    @model_validator(mode="after")
    def _possible(self) -> ModelFile:
        """Refuse places where no robot fits, no food does, or that an extension makes so."""
        arena, body = self.arena, self.robot.body_radius
        if arena is not None:
            if arena.radius <= body:
                raise Refused(
                    "arena.radius", f"{arena.radius:g}", f"more than body_radius, {body:g} m"
                )
            nest = arena.nest
            most = _largest_nest(nest.x, nest.y, arena.radius - body)
            if nest.radius > most:
                raise Refused("arena.nest.radius", f"{nest.radius:g}", _room(most))
        if self.extension is not None:
            for robot in (None, *self.extension.robots):
                self._believable(robot)
        return self

    def _believable(self, robot: int | None) -> None:
        """Refuse what the causes of an extension add up to for a robot, where C would refuse it."""
        try:
            self.motion(robot).drive.struct()
            model = self.point_model(robot=robot)
            model.senses.check()
        except InputError as error:
            raise Refused(f"extension: {error.field}", error.got, error.expected) from None
        x, y, radius = model.nest
        most = _largest_nest(x, y, model.arena_radius - model.body_radius)
        if self.arena is not None and radius > most:
            raise Refused("extension: nest radius", f"{radius:g}", _room(most))

    def motion(self, robot: int | None = None) -> Motion:
        """How a robot moves and is seen; None: what the whole swarm has in common."""
        radius, axle = self.robot.wheel_radius, self.robot.axle
        minimal = Motion(drive=Drive(wheel_radius=(radius, radius), axle=axle))
        if self.extension is None:
            return minimal
        motion = self.extension.applied(minimal, robot)
        if not motion.drive.laws:
            return motion
        body = self.robot.body_radius
        reach = 0.0 if self.arena is None else self.arena.radius - body
        return motion.driving(reach=reach, body=body)

    @property
    def nominal_drive(self) -> Drive:
        """The drive without any extension: by it a lab turns body commands into wheel speeds."""
        return self.model_copy(update={"extension": None}).motion().drive

    def point_model(self, tables: Tables | None = None, *, robot: int | None = None) -> PointModel:
        """The constant model that C reads, with captured sensor tables or motion alone.

        Args:
            tables: Captured.
            robot: Whose, where an extension concerns some robots only; None: what all have.
        """
        body, arena = self.robot, self.arena or Arena()
        places = (self.lamps.opposite, None, self.lamps.at_nest)
        opposite, none, at_nest = (None if p is None else (p.x, p.y) for p in places)
        minimal = PointModel(
            drive=self.motion(robot).drive,
            tables=tables,
            body_radius=body.body_radius,
            arena_radius=arena.radius,
            nest=(arena.nest.x, arena.nest.y, arena.nest.radius),
            food_items=arena.food_items,
            food_radius=arena.food_radius,
            lamps=(opposite, none, at_nest),
        )
        return minimal if self.extension is None else self.extension.sensed(robot).of(minimal)

    def of_robots(self, robots: int, tables: Tables, name: str) -> list[PointModel]:
        """What each robot of a swarm believes.

        Args:
            robots: How many.
            tables: Captured.
            name: What to call the file in an error.

        Raises:
            InputError: the extension names a robot that does not exist.
        """
        if self.extension is not None:
            self.extension.check_robots(range(robots), name)
        if self.extension is None or not self.extension.robots:
            return [self.point_model(tables)] * robots
        return [self.point_model(tables, robot=robot) for robot in range(robots)]


def _largest_nest(x: float, y: float, reach: float) -> float:
    """m: radius of the largest nest at (x, y) that leaves room for food within `reach` (m)."""
    return math.hypot(x, y) + (1.0 - ROOM) * reach


def _room(most: float) -> str:
    return f"at most {math.floor(1e4 * most) / 1e4:g} m, so that food finds room outside the nest"


def find_model_file(source: Path | str | None = None) -> Path:
    """The path of a model file given as a path or as the name of a shipped robot.

    Raises:
        InputError: there is no such file and no such robot.
    """
    path = Path(DEFAULT if source is None else source)
    if str(path) in SHIPPED and not os.path.isfile(path):
        return ROBOTS / f"{path}.toml"
    if os.path.lexists(path):  # whatever it is, its reader says what is wrong with it
        return path
    got = f"{path}: no such file" if path.suffix or path.name != str(path) else path
    raise InputError("model", got, f"a model file (.toml) or {nearest(str(path), SHIPPED)}")


def read_model_file(source: Path | str | None = None) -> ModelFile:
    """Read and validate a model file; the default is the shipped e-puck.

    Raises:
        InputError: no such file, broken TOML, unknown or missing keys, values out of range.
    """
    path = find_model_file(source)
    return checked(ModelFile, toml_values(path, "a model file (TOML)"), path, "a model file")


def load_model(source: Path | str | None = None, *, sensors: Sensing = "required") -> PointModel:
    """The point model of a model file or shipped robot; the default is the e-puck.

    Args:
        source: A path, or one of `SHIPPED`.
        sensors: `required`: captured tables must be there; `declared`: read them if the file names
            any; `ignored`: motion alone.

    Raises:
        InputError: the file cannot be used, its sensor tables are needed and cannot be read, or
            its extension does not concern all robots alike.
    """
    model, tables = _read(source, sensors)
    own = [] if model.extension is None else model.extension.robots
    if own:
        raise InputError("model", f"an extension of robots {own} alone", "one model for all robots")
    return model.point_model(tables)


def load_models(source: Path | str | None, robots: int) -> list[PointModel]:
    """What each robot of a swarm believes, with sensors: one point model per robot.

    Raises:
        InputError: as `load_model`; or the file's extension names a robot that does not exist.
    """
    model, tables = _read(source, "required")
    assert tables is not None
    return model.of_robots(robots, tables, find_model_file(source).name)


def _read(source: Path | str | None, sensors: Sensing) -> tuple[ModelFile, Tables | None]:
    """A model file and, where they are asked for, its captured tables."""
    path = find_model_file(source)
    model = read_model_file(path)
    if sensors == "ignored" or (sensors == "declared" and model.sensors is None):
        return model, None
    if model.sensors is None:
        raise InputError(
            f"{path.name}: sensors", "nothing", 'a table [sensors] with tables = "..."'
        )
    return model, load_tables(path.parent / model.sensors.tables)
