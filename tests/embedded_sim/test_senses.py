"""Terms of the sensors' and the lamp's model: nulls that change nothing, and laws that hold."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import SENSOR_ANGLES, PointModel, Senses, readings
from realitygap.models import load_model

OPPOSITE, NO_LIGHT, AT_NEST = 0, 1, 2
NOMINAL = load_model()
RISE = NOMINAL.lamp_height - NOMINAL.sensor_height


def believing(**terms: object) -> PointModel:
    return replace(NOMINAL, senses=Senses(**terms))


def lit(model: PointModel, poses: object, scenario: int = AT_NEST, t: object = None) -> np.ndarray:
    """(rows, 8) counts below the nominal dark."""
    rows = len(np.atleast_2d(poses))
    read = readings(np.atleast_2d(poses), [scenario] * rows, t, model=model)
    return NOMINAL.tables.ls_dark - read.ls


def facing(distance: float) -> list[float]:
    """Pose whose front-right sensor faces the lamp at the nest from so far (centre to lamp)."""
    return [0.6 - distance, 0.0, -SENSOR_ANGLES[0]]


def test_null_terms_leave_every_reading_bit_for_bit() -> None:
    random = np.random.default_rng(1)
    poses = np.column_stack([random.uniform(-0.4, 0.4, (200, 2)), random.uniform(-3, 3, 200)])
    null = believing(
        ps_gain=(1.0,) * 8, lamp_height=0.10, light_exponent=2.0, lamp_decay=0.0, rotation=0.0
    )
    for scenario in (OPPOSITE, NO_LIGHT, AT_NEST):
        minimal = readings(poses, [scenario] * 200, model=NOMINAL)
        same = readings(poses, [scenario] * 200, np.arange(200.0), model=null)
        assert (minimal.ps == same.ps).all()
        assert (minimal.ls == same.ls).all()


@pytest.mark.parametrize("distance", [0.2, 0.5, 0.9])
@pytest.mark.parametrize(
    ("height", "exponent"), [(0.2, 2.0), (0.05, 2.0), (0.10, 2.3), (0.15, 1.8)]
)
def test_another_height_or_exponent_follows_the_law_of_light(
    distance: float, height: float, exponent: float
) -> None:
    way = distance - NOMINAL.body_radius
    then = math.hypot(way, RISE)
    now = math.hypot(way, height - NOMINAL.sensor_height)
    changed = lit(believing(lamp_height=height, light_exponent=exponent), facing(distance))[0, 0]
    expected = lit(NOMINAL, facing(distance))[0, 0] * then**3 / now ** (1.0 + exponent)
    assert changed == pytest.approx(expected, rel=0.02)


@given(st.floats(0.2, 3.0))
def test_intensity_scales_what_the_lamp_adds(scale: float) -> None:
    changed = lit(believing(lamp_intensity=scale), facing(0.4))
    assert changed == pytest.approx(scale * lit(NOMINAL, facing(0.4)), rel=1e-12)


def test_ambient_light_is_a_share_of_the_reading_at_half_a_metre() -> None:
    added = lit(believing(ambient_light=0.5), [0.0, 0.0, 0.0], NO_LIGHT)[0]
    assert added == pytest.approx(0.5 * lit(NOMINAL, facing(0.5))[0, 0], rel=0.02)


def test_a_lamp_that_decays_loses_its_share_with_time_and_never_goes_negative() -> None:
    rows = [facing(0.4)] * 3
    faded = lit(believing(lamp_decay=0.01), rows, AT_NEST, [0.0, 50.0, 500.0])[:, 0]
    full = lit(NOMINAL, facing(0.4))[0, 0]
    assert faded == pytest.approx([full, 0.5 * full, 0.0], abs=1e-9)


def test_a_second_lamp_reads_as_the_first_would_there() -> None:
    second = believing(second_lamp=(-0.6, 0.0, 0.7))
    pose = [-0.1, 0.1, 0.3]
    assert lit(second, pose, NO_LIGHT) == pytest.approx(0.7 * lit(NOMINAL, pose, OPPOSITE))
    both = lit(NOMINAL, pose, AT_NEST) + 0.7 * lit(NOMINAL, pose, OPPOSITE)
    assert lit(second, pose, AT_NEST) == pytest.approx(both)


def test_a_shifted_lamp_reads_as_the_robot_shifted_the_other_way() -> None:
    moved = lit(believing(lamp_shift=(0.02, -0.05)), [0.1, 0.1, 0.5])
    assert moved == pytest.approx(lit(NOMINAL, [0.08, 0.15, 0.5]), rel=1e-9)


def test_a_turned_ring_reads_as_a_turned_robot() -> None:
    turned = believing(rotation=0.1)
    here, there = [[0.5, 0.1, 0.4]], [[0.5, 0.1, 0.5]]
    for field in ("ps", "ls"):
        changed = getattr(readings(here, [AT_NEST], model=turned), field)
        assert changed == pytest.approx(getattr(readings(there, [AT_NEST], model=NOMINAL), field))


def test_response_keeps_dark_and_full_scale_and_bends_between() -> None:
    bent = believing(light_gamma=1.2)
    full = NOMINAL.tables.counts_max
    for distance in (0.2, 0.5):
        light = full - NOMINAL.tables.ls_dark + lit(NOMINAL, facing(distance))[0, 0]
        read = full - readings([facing(distance)], [AT_NEST], model=bent).ls[0, 0]
        assert read == pytest.approx(full * (light / full) ** 1.2, rel=0.02)


def test_gains_offsets_and_albedo_act_on_the_infrared() -> None:
    pose = [[0.53, 0.0, 0.2]]
    nominal = readings(pose, [NO_LIGHT], model=NOMINAL).ps[0]
    gain = tuple(0.5 if k == 0 else 1.0 for k in range(8))
    offset = tuple(30.0 if k == 3 else 0.0 for k in range(8))
    changed = readings(
        pose,
        [NO_LIGHT],
        model=believing(ps_gain=gain, ps_offset=offset, wall_albedo=0.8),
    ).ps[0]
    assert changed == pytest.approx(0.8 * nominal * gain + offset)
    centre = readings([[0, 0, 0]], [NO_LIGHT], model=believing(ps_offset=offset)).ps[0]
    assert centre.tolist() == list(offset)


def test_dead_sensors_read_nothing() -> None:
    dead = tuple(0.0 if k == 0 else 1.0 for k in range(8))
    read = readings([facing(0.06)], [AT_NEST], model=believing(ps_gain=dead, ls_gain=dead))
    assert read.ps[0, 0] == 0.0
    assert read.ls[0, 0] == NOMINAL.tables.counts_max
    alive = readings([facing(0.06)], [AT_NEST], model=NOMINAL)
    assert read.ls[0, 1:].tolist() == alive.ls[0, 1:].tolist()


def test_a_dead_light_sensor_does_not_see_the_room_either_as_a_covered_one_in_reality() -> None:
    dead = tuple(0.0 if k == 3 else 1.0 for k in range(8))
    read = readings([[0, 0, 0]], [NO_LIGHT], model=believing(ls_gain=dead)).ls[0]
    assert read[3] == NOMINAL.tables.counts_max > NOMINAL.tables.ls_dark
    assert set(np.delete(read, 3)) == {NOMINAL.tables.ls_dark}


def test_past_the_end_of_the_table_light_falls_by_the_law_that_is_believed() -> None:
    away = 1.0
    poses = [facing(d) for d in (0.7, 0.9)]
    for exponent in (2.0, 1.9):
        far = lit(believing(lamp_shift=(away, 0.0), light_exponent=exponent), poses).max(axis=1)
        rim = NOMINAL.body_radius
        sensor = np.hypot(np.array([1.7, 1.9]) - rim, RISE)  # from lamp to the sensor that faces it
        fallen = (sensor[1] / sensor[0]) ** (exponent + 1.0) * (1.7 - rim) / (1.9 - rim)
        assert far[0] / far[1] == pytest.approx(fallen, rel=0.01)


def test_a_table_that_is_continued_says_the_same_as_before_within_its_reach() -> None:
    random = np.random.default_rng(2)
    poses = np.column_stack([random.uniform(-0.4, 0.4, (200, 2)), random.uniform(-3, 3, 200)])
    shift = (-0.1, 0.3)
    captured = replace(NOMINAL, lamps=(None, None, (0.6 + shift[0], shift[1])))
    continued = believing(lamp_shift=(-0.1, 0.3), second_lamp=(3.0, 3.0, 0.0))
    np.testing.assert_allclose(lit(continued, poses), lit(captured, poses), atol=1e-3)


def test_infrared_falls_with_the_cosine_of_the_angle_at_which_a_ray_meets_the_wall() -> None:
    tables = NOMINAL.tables
    cosine = np.linspace(0.0, 1.0, tables.ps_counts.shape[2])
    even = np.ascontiguousarray(
        np.broadcast_to(1000.0 * cosine, tables.ps_counts.shape), np.float32
    )
    model = replace(NOMINAL, tables=replace(tables, ps_counts=even))
    x, radius = 0.5, NOMINAL.arena_radius
    for turned in (0.0, 0.4, 0.8):
        read = readings([[x, 0.0, turned - SENSOR_ANGLES[0]]], [NO_LIGHT], model=model).ps[0, 0]
        assert read == pytest.approx(1000.0 * math.sqrt(1.0 - (x * math.sin(turned) / radius) ** 2))
