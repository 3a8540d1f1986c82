import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import tomli_w
from pydantic import BaseModel

from realitygap.embedded_sim import Behaviour, InputError, PointModel, evaluate, readings
from realitygap.models.belief.modelfile import (
    SHIPPED,
    ModelFile,
    find_model_file,
    load_model,
    load_models,
    read_model_file,
)
from realitygap.models.belief.tables import save_tables
from tests.models.nested import Keys, leaves, replaced
from tests.models.small import tables

EPUCK = "[robot]\nwheel_radius = 0.02\naxle = 0.05\nbody_radius = 0.03\nwheel_speed_max = 6.0\n"


def test_the_default_model_file_says_what_the_point_model_holds_as_nominal():
    model, nominal = load_model(sensors="ignored"), PointModel()
    for name in (
        "drive",
        "body_radius",
        "arena_radius",
        "nest",
        "food_radius",
        "food_items",
        "lamps",
    ):
        assert getattr(model, name) == getattr(nominal, name), name


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_robot_loads_without_sensors(name):
    assert load_model(name, sensors="ignored").drive.axle > 0


def test_the_shipped_geometries_are_the_published_ones():
    axles = {name: load_model(name, sensors="ignored").drive.axle for name in SHIPPED}
    assert axles == {
        **{"epuck": 0.053, "optiodom": 0.2, "create": 0.258, "khepera3": 0.0885},
        **{
            "epuck2": 0.053,
            "thymio2": 0.094,
            "alphabot2": 0.085,
            "pioneer3dx": 0.33,
            "husky": 0.5708,
        },
        **{"turtlebot3_burger": 0.16, "turtlebot3_waffle": 0.287, "warthog": 1.08},
        **{"turtlebot4": 0.233, "create3": 0.233},
    }


@pytest.mark.parametrize("name", SHIPPED)
def test_every_figure_of_a_shipped_robot_has_its_unit_and_source(name):
    text = find_model_file(name).read_text().split("[robot]")[1].split("[")[0]
    lines = [line for line in text.splitlines() if "=" in line and not line.startswith(" ")]
    lines = [line for line in lines if not line.startswith("drive_kind")]
    assert len(lines) == 4
    for line in lines:
        assert re.search(r"# (m|rad/s); .{3,}|# m$", line), line


def test_motion_of_a_model_with_missing_tables_can_be_used_but_its_sensors_cannot(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text('name = "m"\n' + EPUCK + '[sensors]\ntables = "none.npz"\n')
    assert load_model(path, sensors="ignored").tables is None
    with pytest.raises(InputError, match=r"none\.npz"):
        load_model(path)


def test_tables_are_found_relative_to_the_model_file(tmp_path):
    (tmp_path / "captured").mkdir()
    save_tables(tables(), tmp_path / "captured" / "t.npz")
    path = tmp_path / "m.toml"
    path.write_text('name = "m"\n' + EPUCK + '[sensors]\ntables = "captured/t.npz"\n')
    loaded = load_model(path).tables
    assert loaded is not None
    assert np.array_equal(loaded.ps_counts, tables().ps_counts)


ARENA = "[arena]\n"
NEST = ARENA + "nest = {{ x = 0.5, y = 0, radius = {} }}\n"
CAUSE = """
[[extension.causes]]
name = "{name}"
parameters = {{ scale = {{ value = {value} }} }}
"""


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (ARENA + "radius = 0.03\n", "radius: got 0.03, expected more than body_radius, 0.03 m"),
        (NEST.format("1.0649999999"), "nest.radius: got 1.065, expected at most 1.0642 m"),
        (NEST.format("2.0"), "nest.radius: got 2, expected at most 1.0642 m"),
        (ARENA + 2 * CAUSE.format(name="nest_radius", value=5.0), "nest radius: got 5, expected"),
        (40 * CAUSE.format(name="wheel_radius_scale", value=3.0), "extension: drive.wheel_radius"),
        (400 * CAUSE.format(name="wall_albedo", value=10.0), "senses.wall_albedo: got inf"),
    ],
)
def test_places_and_sums_that_cannot_be_are_refused_when_the_file_is_read(tmp_path, text, says):
    path = tmp_path / "m.toml"
    path.write_text('name = "m"\n' + EPUCK + text)
    with pytest.raises(InputError) as refusal:
        read_model_file(path)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_the_largest_nest_that_a_refusal_names_would_do(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    shipped = find_model_file("epuck")
    tables = shipped.parents[1] / "captured" / "epuck.npz"
    arena = "[arena]\nnest = { x = 0.5, y = 0, radius = 1.0642 }\n"
    path.write_text('name = "m"\n' + EPUCK + arena + f'[sensors]\ntables = "{tables}"\n')
    trials = 50
    found = evaluate(
        np.full((trials, 2), 0.5),
        [1] * trials,
        np.arange(4 * trials).reshape(trials, 4),
        model=load_model(path),
        behaviour=Behaviour(),
    )
    assert np.isfinite(found.fitness).all()


WHOLE = """name = "m"
[robot]
wheel_radius = 0.02
axle = 0.05
body_radius = 0.03
wheel_speed_max = 6.0
drive_kind = "skid"
[arena]
radius = 1.1
food_items = 5
food_radius = 0.05
nest = { x = 0.5, y = 0.0, radius = 0.3 }
[lamps]
opposite = { x = 1.0, y = 0.0 }
at_nest = { x = 1.0, y = 0.0 }
[sensors]
tables = "epuck.npz"
[extension]
log = "x"
command = "y"
names = { alice = 3 }
[[extension.causes]]
name = "motor_saturation"
robots = [3]
word = "left"
[extension.causes.parameters]
limit = { value = 4.0, low = 3.9, high = 4.1, unit = "rad/s" }
[[extension.done_curve]]
robots = [3]
wheel = "left"
told = [-5.0, 5.0]
done = [-4.5, 4.5]
[[extension.calibration]]
name = "motor_lag"
robots = [3]
[extension.calibration.parameters]
time_constant = { value = 0.3, unit = "s" }
[[extension.laws]]
channel = "turn"
robots = [3]
unit = "rad/s"
amplitudes = [{ robot = 3, value = 0.1, low = 0.09, high = 0.11 }]
[[extension.laws.atoms]]
of = "heading"
form = "cosine"
parameters = [1.0, 0.5]
"""
"""Every key that a model file can have."""


NUMBERS = [keys for keys, value in leaves(tomllib.loads(WHOLE)) if isinstance(value, int | float)]


def keys_of(kind: type[BaseModel]) -> set[str]:
    """The keys of a table and of all tables in it."""
    return set(kind.model_fields).union(
        *(keys_of(inner) for f in kind.model_fields.values() for inner in tables_in(f.annotation))
    )


def tables_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from tables_in(inner)


def test_the_whole_model_file_has_every_key() -> None:
    there = {key for keys, _ in leaves(tomllib.loads(WHOLE)) for key in keys}
    assert keys_of(ModelFile) <= there


@pytest.mark.parametrize("keys", NUMBERS, ids=lambda keys: ".".join(map(str, keys)))
@pytest.mark.parametrize("value", [True, "1"])
def test_what_is_no_number_is_refused_wherever_a_model_file_has_one(
    tmp_path: Path, keys: Keys, value: object
) -> None:
    path = tmp_path / "m.toml"
    path.write_text(tomli_w.dumps(replaced(tomllib.loads(WHOLE), keys, value)))
    with pytest.raises(InputError) as refusal:
        read_model_file(path)
    named = keys[:-1] if "robots" in keys else keys
    assert refusal.value.field == f"m.toml: {'.'.join(map(str, named))}"
    assert refusal.value.got == repr(value)


def test_a_list_in_the_place_of_a_number_is_shown_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text('name = "m"\n' + EPUCK.replace("0.05", "[0.05, 1]"))
    with pytest.raises(InputError, match=r"robot\.axle: got \[0\.05, 1\], expected a valid number"):
        read_model_file(path)


def test_a_robot_without_an_arena_may_be_larger_than_the_nominal_one(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text('name = "m"\n' + EPUCK.replace("0.03", "0.7"))
    assert read_model_file(path).robot.body_radius == 0.7


def test_rings_turned_by_two_causes_are_turned_by_their_sum(tmp_path: Path) -> None:
    turned = [
        CAUSE.format(name="ir_rotation", value=value).replace("scale", "angle")
        for value in (3.0, 3.0, 6.0 - 2.0 * np.pi)
    ]
    read = []
    for causes in (turned[:2], turned[2:]):
        text = extended(tmp_path / "m.toml", [0]).read_text().split("[[extension")[0]
        (tmp_path / "m.toml").write_text(text + "".join(causes))
        model = load_model(tmp_path / "m.toml")
        read.append(readings([[0.3, 0.1, 0.4]], [2], model=model))
    assert read[0].ls == pytest.approx(read[1].ls, abs=1e-6)
    assert read[0].ps == pytest.approx(read[1].ps, abs=1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('name = "m"\n' + EPUCK + "axel = 0.1\n", "axle"),
        ('name = "m"\nrobto = 1\n' + EPUCK, "robot"),
        ('name = "m"\n', "robot"),
        ('name = "m"\n' + EPUCK.replace("0.05", "-1"), "axle"),
        ('name = "m"\n' + EPUCK.replace("0.05", "nan"), "axle"),
        ('name = "m"\n' + EPUCK.replace("0.05", '"wide"'), "axle"),
        ('name = "m"\n' + EPUCK + "[arena]\nnest = { x = 0, y = 0, raduis = 1 }\n", "radius"),
        ('name = "m"\n' + EPUCK + "[arena]\nfood_items = 99\n", "food_items"),
        ("name = [", "TOML"),
    ],
)
def test_a_broken_model_file_is_refused_in_one_line_that_names_the_key(tmp_path, text, says):
    path = tmp_path / "m.toml"
    path.write_text(text)
    with pytest.raises(InputError) as refusal:
        read_model_file(path)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_an_unknown_robot_is_refused_with_the_nearest_name():
    with pytest.raises(InputError, match="did you mean optiodom"):
        load_model("optidom")


def test_a_model_without_sensors_is_refused_where_sensors_are_needed():
    with pytest.raises(InputError, match="sensors"):
        load_model("create")
    assert load_model("create", sensors="declared").tables is None


EXTENDED = """
[[extension.causes]]
name = "wheel_separation"
robots = {robots}
parameters = {{ scale = {{ value = 1.1 }} }}
"""


def extended(path: Path, robots: object) -> Path:
    """The shipped e-puck with wider wheels in some robots."""
    shipped = find_model_file("epuck")
    text = shipped.read_text().replace("../captured", str(shipped.parents[1] / "captured"))
    path.write_text(text + EXTENDED.format(robots=robots))
    return path


def test_each_robot_believes_what_the_extension_says_of_it(tmp_path: Path) -> None:
    models = load_models(extended(tmp_path / "m.toml", [1, 3]), 4)
    assert [m.drive.axle for m in models] == pytest.approx([0.053, 0.0583, 0.053, 0.0583])
    alike = load_models(extended(tmp_path / "n.toml", '"all"'), 2)
    assert [m.drive.axle for m in alike] == pytest.approx([0.0583, 0.0583])


def test_an_extension_of_some_robots_is_never_taken_for_all_or_none(tmp_path: Path) -> None:
    path = extended(tmp_path / "m.toml", [1, 3])
    with pytest.raises(
        InputError, match=r"causes.0.robots: got 3, expected a robot: one of 0, 1, 2"
    ):
        load_models(path, 3)
    with pytest.raises(InputError, match="one model for all robots"):
        load_model(path)
