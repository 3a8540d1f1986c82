"""Curves of one's own sensors: what is measured stands in the table, and the rest is said."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from realitygap.embedded_sim import InputError
from realitygap.models import load_model, load_tables
from realitygap.models.belief.curves import read_curve, tables_of
from tests.helpers import realitygap
from tests.models.small import shared_data

SHIPPED = load_model().tables
DISTANCES = np.linspace(0.0, 0.12, 25)
INCIDENCES = np.radians([0, 30, 60])


def law(distance, incidence=0.0):
    return 4.0e3 * np.cos(incidence) ** 2 * np.exp(-distance / 0.03)


def write(room, name="ir.csv", **columns):
    pd.DataFrame(columns).to_csv(room / name, index=False)
    return room / name


def grid(*axes):
    return [part.ravel() for part in np.meshgrid(*axes, indexing="ij")]


def axis(tables):
    return tables.ps_range * np.linspace(0.0, 1.0, tables.ps_counts.shape[1]) ** 2


def refusal(*args):
    with pytest.raises(InputError) as caught:
        tables_of(*args)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_curve_before_the_wall_becomes_the_infrared_of_all_sensors(tmp_path):
    path = write(tmp_path, distance_mm=1e3 * DISTANCES, counts=law(DISTANCES))
    found, notes = tables_of([path], SHIPPED)
    assert found.ps_range == pytest.approx(0.12)
    cosines = np.linspace(0, 1, found.ps_counts.shape[2])
    want = law(axis(found))[:, None] * cosines
    for sensor in found.ps_counts:
        assert np.allclose(sensor, want, atol=15)  # straight lines between readings 5 mm apart
    assert np.array_equal(found.ls_counts, SHIPPED.ls_counts)
    assert [note.split(":")[0] for note in notes] == ["infrared"] * 3 + ["no curve of light"]


def test_incidence_that_was_measured_takes_the_cosines_place(tmp_path):
    distance, angle = grid(DISTANCES, np.degrees(INCIDENCES))
    counts = law(distance, np.radians(angle))
    path = write(tmp_path, distance=distance, **{"incidence [deg]": angle}, counts=counts)
    found, notes = tables_of([path], SHIPPED)
    assert not any("incidence" in note for note in notes)
    for k, cosine in enumerate(np.linspace(0, 1, 11)):
        known = np.cos(INCIDENCES)[::-1]
        square = np.interp(cosine, [0, *known], [0, *(known**2)])
        assert np.allclose(found.ps_counts[0, :, k], law(axis(found)) * square, atol=15)


def test_each_sensor_may_have_a_curve_and_a_noise_of_its_own_readings(tmp_path):
    rng = np.random.default_rng(np.random.SeedSequence(3))
    sensor, distance, _ = grid(np.arange(8), DISTANCES, np.arange(40))
    counts = (1 + sensor) * law(distance) * (1 + 0.1 * rng.uniform(-1, 1, len(sensor)))
    path = write(tmp_path, sensor=sensor.astype(int), distance=distance, counts=counts)
    found, notes = tables_of([path], SHIPPED)
    assert np.allclose(found.ps_counts[3, :, -1], 4 * law(axis(found)), rtol=0.06, atol=30)
    assert found.ps_noise == pytest.approx(0.1, rel=0.5)
    assert found.counts_max >= counts.max()
    assert not any("noise" in note for note in notes)


@pytest.mark.parametrize("turn", [0.0, 2 * np.pi])
def test_a_ring_of_light_keeps_the_shipped_fall_with_distance(tmp_path, turn):
    bearing = np.radians(np.arange(-180, 180, 5))
    light = np.maximum(np.cos(bearing), 0) ** 3
    shifted = np.where(bearing < 0, bearing + turn, bearing)  # a whole turn is the same
    path = write(tmp_path, bearing=shifted, light=500 * light)
    found, notes = tables_of([path], SHIPPED)
    assert np.allclose(found.ls_counts, np.outer(SHIPPED.ls_counts.max(axis=1), light), atol=1)
    assert any("no distance" in note for note in notes)
    assert any("no curve of infrared" in note for note in notes)


def test_light_by_distance_is_kept_with_its_reach(tmp_path):
    bearing, distance = grid(np.radians(np.arange(-180, 180, 5)), np.linspace(0.1, 2.0, 60))
    light = 100 * np.maximum(np.cos(bearing), 0) / distance
    path = write(tmp_path, bearing_deg=np.degrees(bearing), distance=distance, light=light)
    found, _ = tables_of([path], SHIPPED)
    assert found.ls_range == pytest.approx(2.0)
    nodes = 2.0 * np.linspace(0, 1, found.ls_counts.shape[0]) ** 2
    ahead = found.ls_counts[nodes > 0.1, found.ls_counts.shape[1] // 2]
    assert np.allclose(ahead, 100 / nodes[nodes > 0.1], rtol=0.05)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"distance": [0.1, 0.2], "colour": [1, 2]}, "no counts among distance, colour"),
        ({"light": [1, 2], "distance": [1, 2]}, "no bearing"),
        ({"distance": [11, 110], "counts": [5, 1]}, "as distance_mm"),
        ({"distance": [0.01, 0.02], "counts": [5, -1]}, "ir.csv: counts: got -1"),
        ({"distance": [0.01, 0.02], "counts": [5, None]}, "empty or infinite"),
        ({"distance": [0.01, 0.01], "counts": [5, 1]}, "one value in every row"),
        ({"distance": [0.01, 0.02], "counts": ["a", 1]}, "got a, expected numbers"),
        ({"distance [s]": [0.01, 0.02], "counts": [5, 1]}, "got s, expected one of m, cm, mm"),
        ({"distance": [0.1, 0.2], "counts": [5, 1], "incidence": [0, 45]}, "incidence_deg"),
        ({"distance": [0.1, 0.2], "counts": [5, 1], "sensor": [0, 9]}, "from 0 to 7"),
        ({"distance": [0.1, 0.2], "counts": [5, 1], "sensor": [0, 0]}, "of sensor 1, 2, 3"),
        ({"bearing": [0, 90], "light": [5, 1]}, "bearing_deg"),
        ({"bearing": [0, 1], "light": [0, 0]}, "no light at all"),
        ({"distance": [0.1], "counts": [1]}, "1 rows"),
    ],
)
def test_what_is_no_curve_is_refused_in_one_line(tmp_path, columns, said):
    assert said in refusal([write(tmp_path, **columns)], SHIPPED)


def test_two_curves_of_one_kind_are_refused(tmp_path):
    path = write(tmp_path, distance=DISTANCES, counts=law(DISTANCES))
    assert "a second curve of infrared" in refusal([path, path], SHIPPED)


def test_the_command_writes_tables_that_a_model_takes(tmp_path):
    path = write(tmp_path, distance=DISTANCES, counts=law(DISTANCES))
    out = tmp_path / "mine.npz"
    done = realitygap("capture", "--from", path, "--out", out)
    assert done.returncode == 0, done.stderr
    assert "the shipped e-puck's table is kept" in done.stdout
    model = rg.new_model(wheel_radius=0.02, axle=0.05) + '[sensors]\ntables = "mine.npz"\n'
    (tmp_path / "m.toml").write_text(model)
    assert rg.Model.load(tmp_path / "m.toml").tables.ps_range == pytest.approx(0.12)
    assert np.array_equal(load_tables(out).ps_counts, tables_of([path], SHIPPED)[0].ps_counts)
    bad = realitygap("capture", "--from", tmp_path / "m.toml", "--out", tmp_path / "b.npz")
    assert (bad.returncode, bad.stderr.count("\n")) == (2, 1)
    assert not (tmp_path / "b.npz").exists()


def test_a_real_thymios_curve_is_taken_as_its_authors_measured_it(tmp_path):
    source = shared_data("thymio_ir") / "proximity_sensor02_readings_darkness.csv"
    raw = pd.read_csv(source, header=None, index_col=0)
    long = raw.stack().rename("counts").reset_index()
    long["distance_cm"] = long[0].str.removesuffix("cm").astype(float)
    long[["distance_cm", "counts"]].to_csv(tmp_path / "thymio.csv", index=False)
    found, _ = tables_of([tmp_path / "thymio.csv"], SHIPPED)
    curve = read_curve(tmp_path / "thymio.csv").table.groupby("distance")["counts"].median()
    assert found.ps_range == pytest.approx(0.11)
    at = np.interp(curve.index, axis(found), found.ps_counts[0, :, -1])
    assert np.abs(at - curve.to_numpy()).max() < 0.05 * curve.max()
    assert (found.ps_noise < 0.05).all()
