"""Extensions: nothing at their nulls, refused where they cannot be meant, robot by robot."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim import Behaviour, Drive, InputError, evaluate, readings, replay
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import ModelFile, load_model, read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import motions, replay_believed
from realitygap.models.gap.replay import replay_log
from realitygap.models.gap.whole import measure_gap
from realitygap.models.log.measured import MeasuredLog, make_log
from tests.models.small import arena_log, driven_log, random_commands

EPUCK = read_model_file("epuck")
MINIMAL = load_model("epuck")
DEAD = ("ir_dead_sensor", "ls_dead_sensor")
TERMS = [
    (name, variant)
    for name, cause in every_cause().items()
    if name not in DEAD
    for variant in cause.variants
]


def named(name: str, *values: float, word: str = "", robots: object = "all") -> NamedCause:
    cause: Cause = every_cause()[name]
    given_values = values or tuple(p.null for p in cause.parameters)
    return NamedCause(
        name=name,
        word=word or cause.variants[0],
        robots=robots,
        parameters={
            p.name: ParameterValue(value=value)
            for p, value in zip(cause.parameters, given_values, strict=True)
        },
    )


def extended(*causes: NamedCause) -> ModelFile:
    return EPUCK.model_copy(update={"extension": Extension(causes=causes)})


def test_only_a_dead_sensor_has_no_null() -> None:
    assert [n for n, cause in every_cause().items() if not cause.parameters] == list(DEAD)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.sampled_from(TERMS), min_size=1, max_size=len(TERMS)), st.integers(0, 2**31))
def test_at_its_null_an_extension_is_the_minimal_model_bit_for_bit(
    terms: list[tuple[str, str]], seed: int
) -> None:
    file = extended(*(named(name, word=variant) for name, variant in terms))
    model = file.point_model(MINIMAL.tables)
    random = np.random.default_rng(seed)
    genomes, scenarios = random.uniform(0.0, 0.99, (12, 2)), random.integers(0, 3, 12)
    seeds = random.integers(0, 2**32, (12, 4), dtype=np.uint32)
    one, other = (
        evaluate(genomes, scenarios, seeds, model=m, behaviour=Behaviour())
        for m in (model, MINIMAL)
    )
    assert one.fitness.tobytes() == other.fitness.tobytes()
    assert one.deposits.tobytes() == other.deposits.tobytes()
    poses, t = random.uniform(-0.5, 0.5, (50, 3)), random.uniform(0.0, 600.0, 50)
    lamps = random.integers(0, 3, 50)
    read, plain = (readings(poses, lamps, t, model=m) for m in (model, MINIMAL))
    assert (read.ps.tobytes(), read.ls.tobytes()) == (plain.ps.tobytes(), plain.ls.tobytes())
    commands, start = random_commands(random, 200), np.zeros((1, 3))
    driven, minimal = (
        replay(np.arange(200) * 0.04, commands, [0, 200], start, drive=m.drive).poses
        for m in (model, MINIMAL)
    )
    assert driven.tobytes() == minimal.tobytes()
    assert file.motion(3) == EPUCK.motion(3)


@pytest.mark.parametrize(("name", "variant"), TERMS)
def test_every_term_alone_is_the_minimal_model_at_its_null(name: str, variant: str) -> None:
    file = extended(named(name, word=variant))
    assert file.motion() == EPUCK.motion()
    model = file.point_model(MINIMAL.tables)
    assert (model.senses, model.nest) == (MINIMAL.senses, MINIMAL.nest) or (
        name == "lamp_height" and model.senses.lamp_height == MINIMAL.lamp_height
    )


CAUSE = {
    "name": '"motor_lag"',
    "robots": "[1]",
    "time_constant": "{ value = 0.1, low = 0.05, high = 0.2, unit = 's' }",
}


@pytest.mark.parametrize(
    ("key", "text", "field", "said"),
    [
        ("name", '"motor_lagg"', "causes.0.name", "did you mean motor_lag"),
        ("robots", '"al"', "causes.0.robots", 'or "all"'),
        ("robots", "[]", "causes.0.robots", "robot numbers"),
        ("robots", "[-1]", "causes.0.robots", "robot numbers"),
        ("robots", "[1.5]", "causes.0.robots", "robot numbers"),
        ("robots", "[1, 1]", "causes.0.robots", "each robot once"),
        ("robot", "[1]", "causes.0.robot", "did you mean robots"),
        ("word", '"left"', "causes.0.word", "for motor_lag"),
        ("time_constant", "{ value = 99.0 }", "parameters.time_constant", "-0.1 to 1 s"),
        ("time_constant", "{ value = nan }", "parameters.time_constant", "-0.1 to 1 s"),
        ("time_constant", "{ value = 0.1, unit = 'ms' }", "time_constant.unit", "'s'"),
        ("time_constant", "{ value = 0.1, low = 2.0, high = 1.0 }", "low", "at most high"),
        ("time_constant", "{ value = 0.1, error = 1.0 }", "error", "one of value, low"),
        ("time_constant", "{ value = 'slow' }", "time_constant.value", "number"),
        ("time_constant", "{ low = 0.1 }", "time_constant.value", "must be there"),
        ("seconds", "{ value = 0.1 }", "parameters", "one of time_constant"),
    ],
)
def test_a_hand_edited_extension_is_refused_in_one_line_with_what_is_valid(
    key: str, text: str, field: str, said: str, tmp_path: Path
) -> None:
    lines = {**CAUSE, key: text}
    head = "\n".join(f"{k} = {lines[k]}" for k in ("name", "robots", "robot", "word") if k in lines)
    body = "\n".join(f"{k} = {lines[k]}" for k in ("time_constant", "seconds") if k in lines)
    path = tmp_path / "m.toml"
    path.write_text(
        'name = "x"\n[robot]\nwheel_radius = 0.02\naxle = 0.05\nbody_radius = 0.03\n'
        "wheel_speed_max = 6.0\n[extension]\nlog = 'abc'\n[[extension.causes]]\n"
        f"{head}\n[extension.causes.parameters]\n{body}\n"
    )
    with pytest.raises(InputError) as refusal:
        read_model_file(path)
    assert field in refusal.value.field
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_lamp_cannot_be_one_robots() -> None:
    with pytest.raises(ValueError, match="belongs to the place"):
        named("lamp_moved", 0.1, 0.0, robots=(3,))


def test_a_limit_at_infinity_is_the_null_and_can_be_written() -> None:
    assert named("motor_saturation", math.inf, word="left").parameters["limit"].value == math.inf
    with pytest.raises(ValueError, match="time_constant"):
        named("motor_lag", math.inf)


def log_of(drives: dict[int, Drive]) -> MeasuredLog:
    """Robots with drives of their own, the tracker's noise on top."""
    parts = []
    for robot, drive in drives.items():
        frame = driven_log(
            10 + robot, robots=1, rows=2500, drive=drive, position_noise=5e-4, heading_noise=5e-3
        )
        parts.append(frame.assign(robot=robot))
    return make_log(pd.concat(parts, ignore_index=True), drive=Drive())


def test_every_robot_of_a_log_is_replayed_as_the_extension_believes_of_it() -> None:
    wide = Drive(axle=0.053 * 1.1)
    log = log_of({0: Drive(), 4: wide})
    file = extended(named("wheel_separation", 1.1, robots=(4,)))
    replayed = replay_believed(log, motions(log, file))
    edge = log.start[1]
    assert np.array_equal(replayed[:edge], replay_log(log, Drive())[:edge])
    assert np.array_equal(replayed[edge:], replay_log(log, wide)[edge:])


def test_a_gap_is_measured_against_each_robots_own_model() -> None:
    log = log_of({0: Drive(), 1: Drive(), 4: Drive(wheel_radius=(0.0200, 0.0210))})
    in_the_open = EPUCK.model_copy(update={"arena": None})
    model = in_the_open.point_model()
    ratio = named("wheel_radius_mismatch", 1.05, robots=(4,))
    told = in_the_open.model_copy(update={"extension": Extension(causes=(ratio,))})
    before, after = measure_gap(log, in_the_open, model), measure_gap(log, told, told.point_model())
    wrong = before.horizons.set_index(["horizon", "robot"])["heading_median"]
    right = after.horizons.set_index(["horizon", "robot"])["heading_median"]
    assert wrong["1 s", 4] > 5 * right["1 s", 4]
    assert right["1 s", 4] == pytest.approx(right["1 s", 0], rel=0.25)
    assert right["1 s", 0] == wrong["1 s", 0]


def test_a_marker_that_is_off_is_taken_off_before_sensors_are_predicted() -> None:
    frame = arena_log(5, robots=2, rows=2000, sensors=MINIMAL.tables)
    turned = frame["robot"] == 1
    frame.loc[turned, "yaw"] += 0.6
    log = make_log(frame, drive=Drive())
    file = extended(named("tracker_yaw_offset", 0.6, robots=(1,)))
    model = EPUCK.point_model(MINIMAL.tables)

    def error(believed: ModelFile, robot: int) -> float:
        gap = measure_gap(log, believed, model)
        light = next(g for g in gap.sensors if g.kind == "ls")
        mine = light.table["robot"].to_numpy() == robot
        return float(np.abs(light.residual[mine]).mean())

    assert error(file, 1) < 0.5 * error(EPUCK, 1)
    assert error(file, 1) == pytest.approx(error(EPUCK, 0), rel=0.2)
    assert error(file, 0) == pytest.approx(error(EPUCK, 0), rel=0.02)


def test_a_gap_uses_each_robots_own_senses() -> None:
    frame = arena_log(6, robots=2, rows=2000, sensors=MINIMAL.tables)
    columns = [f"ps{k}" for k in range(8)]
    frame.loc[frame["robot"] == 1, columns] *= 0.5
    log = make_log(frame, drive=Drive())
    file = extended(named("ir_gain", 0.5, word="all", robots=(1,)))
    model = EPUCK.point_model(MINIMAL.tables)
    sizes = []
    for believed in (EPUCK, file):
        infrared = next(g for g in measure_gap(log, believed, model).sensors if g.kind == "ps")
        mine = infrared.table["robot"].to_numpy() == 1
        seen = infrared.predicted[mine] > 50
        sizes.append(float(np.abs(infrared.residual[mine][seen]).mean()))
    assert sizes[1] < 0.5 * sizes[0]


def test_a_robot_that_a_log_does_not_have_is_refused() -> None:
    log = log_of({0: Drive(), 4: Drive()})
    file = extended(named("wheel_separation", 1.1, robots=(3,)))
    with pytest.raises(InputError, match=r"m.toml: extension.causes.0.robots: got 3.*0, 4"):
        measure_gap(log, file, file.point_model(), name="m.toml")


def test_what_the_extension_says_is_no_fault_any_more() -> None:
    from realitygap.models.naming.channels.motion.diagnose import diagnose

    log = log_of({0: Drive(), 1: Drive(wheel_radius=(0.0200, 0.0210))})
    in_the_open = EPUCK.model_copy(update={"arena": None})
    ratio = named("wheel_radius_mismatch", 1.05, robots=(1,))
    told = in_the_open.model_copy(update={"extension": Extension(causes=(ratio,))})
    assert [one.robots for one in diagnose(log, in_the_open, None).diagnosis.named] == [(1,)]
    assert diagnose(log, told, None).diagnosis.named == ()
    assert told.motion(1) != Motion(drive=Drive())
