"""What is wrong with sensors, lamps and nest is named from readings, and nothing else is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import InputError, PointModel, readings, replay
from realitygap.embedded_sim.senses import Senses
from realitygap.models import load_model
from realitygap.models.belief.catalogue import sense_causes
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.senses import Belief
from realitygap.models.log.measured import make_log
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.senses.diagnose import SenseExamination, diagnose_senses
from realitygap.models.naming.channels.senses.neighbours import Neighbours
from realitygap.models.naming.channels.senses.readings import Eye
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.health.reference import shipped_file
from realitygap.models.naming.health.senses import (
    beside,
    no_sense_reference,
    read_sense_reference,
    write_sense_reference,
)
from realitygap.models.naming.rules import Rules
from realitygap.reality.effects import catalogue

MODEL = load_model()
ROBOTS, SECONDS, STEP = 4, 60.0, 0.04
CENTRES = np.array([[0.25, 0.0], [-0.25, 0.05], [0.05, 0.25], [0.0, -0.28]])
REFERENCE = no_sense_reference("e-puck")
HEALTHY = Belief()


def table(
    beliefs: dict[int, Belief], *, everybody: Belief = HEALTHY, swing: float = 0.15
) -> pd.DataFrame:
    """Robots on loops past wall, lamp and nest whose sensors are as believed, with noise."""
    tables = MODEL.tables
    assert tables is not None
    random = np.random.default_rng(5)
    t = np.arange(0.0, SECONDS, STEP)
    frames = []
    for robot, (x, y) in enumerate(CENTRES.tolist()):
        turn = 0.25 + swing * np.sin(0.31 * t + robot)
        commands = np.column_stack([4.5 - turn, 4.5 + turn])
        start = np.array([[x + 0.27, y, np.pi / 2]])
        poses = replay(t, commands, [0, len(t)], start, drive=MODEL.drive).poses
        far = np.hypot(poses[:, 0], poses[:, 1])
        inside = np.minimum(1.0, 0.56 / far)
        poses[:, :2] *= inside[:, None]
        believed = beliefs.get(robot, everybody).of(MODEL)
        read = readings(poses, np.full(len(t), 2, dtype=np.int32), t, model=believed)
        scale = believed.senses.ps_noise
        wide = scale * np.hypot(0.159 * read.ps, 2.0)
        ps = np.rint(np.clip(read.ps + wide * random.standard_normal(read.ps.shape), 0, 4095))
        ls = np.rint(np.clip(read.ls + 5.0 * random.standard_normal(read.ls.shape), 0, 4095))
        centre_x, centre_y, radius = believed.nest
        nest = np.hypot(poses[:, 0] - centre_x, poses[:, 1] - centre_y) < radius
        columns = {"robot": robot, "t": t, "cmd_left": commands[:, 0], "cmd_right": commands[:, 1]}
        frame = pd.DataFrame(columns).assign(**dict(zip("xy", poses.T[:2], strict=True)))
        frame = frame.assign(yaw=poses[:, 2], nest=nest, case="light-at-nest")
        sensors = dict(zip((*PS, *LS), np.hstack([ps, ls]).T, strict=True))
        frames.append(frame.assign(**sensors))
    return pd.concat(frames, ignore_index=True)


def examined(
    frame: pd.DataFrame, model: PointModel = MODEL, rules: Rules = Rules()
) -> SenseExamination:
    return diagnose_senses(make_log(frame, drive=model.drive), model, REFERENCE, rules=rules)


def names(found: SenseExamination) -> list[tuple[str, str, object]]:
    return [
        (one.term.cause.name, one.term.variant, "all" if one.whole_swarm else one.robots)
        for one in found.named
    ]


def with_senses(**changes: object) -> Belief:
    return Belief(senses=replace(Senses(), **changes))  # type: ignore[arg-type]


def test_nothing_is_named_where_everything_reads_as_simulated() -> None:
    assert names(examined(table({}))) == []


@pytest.mark.parametrize(
    ("name", "parameter", "value", "belief"),
    [
        ("ir_rotation", "angle", 0.05, with_senses(rotation=0.05)),
        ("ir_offset", "counts", 6.0, with_senses(ps_offset=(6.0,) * 8)),
        ("ir_noise", "scale", 2.0, with_senses(ps_noise=2.0)),
        ("light_gamma", "exponent", 1.05, with_senses(light_gamma=1.05)),
    ],
)
def test_a_fault_of_one_robot_is_named_for_it_with_its_value(
    name: str, parameter: str, value: float, belief: Belief
) -> None:
    found = examined(table({2: belief}))
    assert names(found) == [(name, "", (2,))]
    (told,) = (v for v in found.named[0].values if v.name == parameter)
    assert told.low <= value <= told.high
    assert not found.named[0].evidence.rivals


def test_a_gate_that_nothing_passes_names_nothing_in_the_senses() -> None:
    frame = table({2: with_senses(rotation=0.05)})
    assert names(examined(frame))
    assert names(examined(frame, rules=Rules(cause_gate=1e9))) == []


@pytest.mark.parametrize(
    ("name", "parameter", "value", "belief"),
    [
        ("lamp_intensity", "scale", 0.95, with_senses(lamp_intensity=0.95)),
        ("light_falloff", "exponent", 2.06, with_senses(light_exponent=2.06)),
        ("lamp_moved", "y", 0.02, with_senses(lamp_shift=(0.0, 0.02))),
        ("lamp_decay", "rate", 2e-3, with_senses(lamp_decay=2e-3)),
        ("second_lamp", "intensity", 0.1, with_senses(second_lamp=(-0.6, -0.3, 0.1))),
    ],
)
def test_a_fault_of_the_place_is_named_for_all_with_its_value(
    name: str, parameter: str, value: float, belief: Belief
) -> None:
    found = examined(table({}, everybody=belief))
    assert names(found) == [(name, "", "all")]
    (told,) = (v for v in found.named[0].values if v.name == parameter)
    assert told.low <= value <= told.high


def test_a_gain_of_all_infrared_is_the_walls_or_the_sensors_unless_robots_were_seen() -> None:
    found = examined(table({}, everybody=with_senses(wall_albedo=1.2)))
    one = found.named[0]
    candidates = {one.term.cause.name, *(t.cause.name for t in one.evidence.rivals)}
    assert candidates == {"wall_albedo", "ir_gain"}


def test_dead_sensors_are_named_one_by_one() -> None:
    frame = table({})
    frame.loc[frame["robot"] == 1, "ps1"] = 0.0
    frame.loc[frame["robot"] == 3, "ls2"] = 4095.0
    dead = [("ir_dead_sensor", "1", (1,)), ("ls_dead_sensor", "2", (3,))]
    assert names(examined(frame)) == dead


def test_a_nest_elsewhere_and_a_larger_one_are_told_apart() -> None:
    moved = examined(table({}, everybody=Belief(nest_shift=(0.0, 0.02))))
    assert names(moved) == [("nest_moved", "", "all")]
    larger = examined(table({}, everybody=Belief(nest_scale=1.1)))
    assert names(larger) == [("nest_radius", "", "all")]
    (scale,) = larger.named[0].values
    assert scale.low <= 1.1 <= scale.high


def test_missing_columns_are_told_with_the_causes_they_silence() -> None:
    frame = table({}).drop(columns=[*LS, "nest"])
    said = " ".join(examined(frame).not_checked)
    assert "no ls0..ls7: ambient_light" in said
    assert "no nest: nest_moved, nest_radius" in said
    assert "lamp" in said
    assert "no ps0" not in said


def test_a_model_without_tables_judges_no_sensor_and_says_so() -> None:
    found = examined(table({}), replace(MODEL, tables=None))
    assert names(found) == []
    assert any("no captured tables" in text for text in found.not_checked)


def test_a_robot_in_front_of_a_sensor_silences_that_sensor_alone() -> None:
    place = np.array([[[0.15, 0.0]]])
    hit = Neighbours(place).in_ray(np.array([[0.0, 0.0, 0.297]]), MODEL)
    assert hit[0].tolist() == [True] + [False] * 7


def test_a_robot_between_sensor_and_lamp_shades_it_unless_light_passes_above() -> None:
    pose = np.array([[0.0, 0.0, 0.0]])
    between = Neighbours(np.array([[[0.3, 0.0]]])).before_lamp(pose, (0.6, 0.0), MODEL)
    under = Neighbours(np.array([[[0.59, 0.0]]])).before_lamp(pose, (0.6, 0.0), MODEL)
    assert between[0, [0, 7]].all()
    assert not under.any()


def test_every_cause_leaves_the_belief_as_it_is_at_its_null() -> None:
    for cause in sense_causes().values():
        for variant in cause.variants if cause.parameters else ():
            null = np.array([p.coordinate(p.null) for p in cause.parameters])
            told = cause.believed(HEALTHY, null, variant)
            assert told.of(MODEL).nest == MODEL.nest, cause.name
            height = told.senses.lamp_height
            assert height in (None, MODEL.lamp_height), cause.name
            assert replace(told.senses, lamp_height=None) == Senses(), cause.name


def test_names_and_parameters_are_those_of_the_effects() -> None:
    effects = {n: e for n, e in catalogue().items() if e.kind != "motion"}
    assert sorted(effects) == sorted(sense_causes())
    for name, effect in effects.items():
        cause = sense_causes()[name]
        told = {p.name for p in cause.parameters} | ({cause.word} if cause.word else set())
        assert told == set(effect.parameters), name
        assert cause.place == (not effect.per_robot), name
        assert set(cause.confusable_with) <= {*effects, "tracker_yaw_offset"}, name


def test_an_extended_model_senses_as_named_for_the_robots_concerned() -> None:
    file = read_model_file()
    gain = NamedCause(
        name="ir_gain", robots=(3,), word="1", parameters={"scale": ParameterValue(value=0.8)}
    )
    lamp = NamedCause(name="lamp_intensity", parameters={"scale": ParameterValue(value=1.1)})
    extension = {"extension": {"causes": (gain, lamp)}}
    extended = file.model_validate({**file.model_dump(exclude_none=True), **extension})
    assert extended.point_model(robot=3).senses.ps_gain[1] == pytest.approx(0.8)
    assert extended.point_model(robot=2).senses.ps_gain == Senses().ps_gain
    assert extended.point_model().senses.lamp_intensity == pytest.approx(1.1)


def test_the_shipped_reference_is_of_the_shipped_robot_and_reads_back_the_same(
    tmp_path: Path,
) -> None:
    motion = shipped_file(read_model_file().name)
    assert motion is not None
    shipped = read_sense_reference(beside(motion))
    assert shipped.command.startswith("realitygap reference")
    write_sense_reference(shipped, tmp_path / "again.json")
    assert read_sense_reference(tmp_path / "again.json") == shipped


def test_a_file_that_is_no_reference_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.json").write_text('{"model": 1}', encoding="utf-8")
    with pytest.raises(InputError, match=r"bad\.json"):
        read_sense_reference(tmp_path / "bad.json")


def test_without_a_reference_a_part_of_a_count_is_no_offset() -> None:
    log = make_log(table({}), drive=MODEL.drive)
    assert names(diagnose_senses(log, MODEL, None)) == []


def test_readings_that_a_robot_may_shade_from_a_second_lamp_are_left_out() -> None:
    sight = look(make_log(table({}), drive=MODEL.drive), MODEL)
    eye = Eye(sight.of(0), MODEL)
    x, y = sight.neighbours.place[0, 1]  # beyond a robot, as the first row's robot sees it
    away = np.array([x, y]) - sight.poses[0, :2]
    behind = np.array([x, y]) + 0.6 * away / np.hypot(*away)
    before = eye.usable(HEALTHY)
    lost = before & ~eye.usable(with_senses(second_lamp=(*behind.tolist(), 0.1)))
    far = np.hypot(*(eye.sight.poses[:, :2] - behind).T) > 0.4  # not what is left out near the lamp
    assert lost[far, 8:].any()
    assert not lost[:, :8].any()
    assert lost[:, 8:].mean() < 0.5
    assert (eye.sight.free == before).all(), "the log's own view must stay as it is"


def test_a_cause_of_the_place_is_named_for_all_whose_robots_are_few() -> None:
    frame = table({}, everybody=with_senses(lamp_intensity=0.9))
    alone = examined(frame[frame["robot"] == 0])
    assert names(alone) == [("lamp_intensity", "", "all")]


def test_a_reference_of_another_schema_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "old.json").write_text('{"schema_version": 1, "model": "e"}', encoding="utf-8")
    with pytest.raises(InputError, match=r"schema_version: got 1, expected 2; make it anew"):
        read_sense_reference(tmp_path / "old.json")
