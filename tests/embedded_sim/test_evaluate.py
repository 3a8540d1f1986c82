"""The embedded simulator forages: fitness, determinism, sensors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from realitygap.embedded_sim import (
    SENSOR_ANGLES,
    Behaviour,
    Drive,
    InputError,
    PointModel,
    Senses,
    evaluate,
    readings,
)
from realitygap.embedded_sim.simulator import FORMS, has_form
from realitygap.models import load_model

SEARCH, POSITIVE, NEGATIVE = (0.5, 0.5), (0.9, 0.5), (0.1, 0.5)
OPPOSITE, NO_LIGHT, AT_NEST = 0, 1, 2


def seeds(trials: int, seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    return random.integers(0, 2**32, (trials, 4), dtype=np.uint32)


def forage(
    genome: tuple[float, float], scenario: int, trials: int = 300, model: PointModel | None = None
) -> np.ndarray:
    return evaluate(
        np.tile(genome, (trials, 1)),
        np.full(trials, scenario),
        seeds(trials),
        model=model or load_model(),
        behaviour=Behaviour(),
    ).fitness


def test_fitness_is_the_time_left_at_each_deposit_summed() -> None:
    """Food everywhere, and a nest that covers all but a sliver: every other step is a deposit."""
    model = replace(load_model(), food_radius=3.0, nest=(0.5, 0.0, 1.05))
    result = evaluate(
        np.tile(SEARCH, (20, 1)), [NO_LIGHT] * 20, seeds(20), model=model, behaviour=Behaviour()
    )
    inside = result.deposits == 750
    assert inside.sum() >= 10
    by_hand = sum(60.0 - 0.04 * step for step in range(1, 1500, 2))
    assert result.fitness[inside] == pytest.approx(by_hand, rel=1e-12)


def test_no_food_lies_at_home() -> None:
    """Robots that cannot move, in a nest that covers all but a sliver: those by the sliver are
    paid, the others would be only for food in the nest."""
    model = replace(load_model(), drive=Drive(speed_limit=(0.0, 0.0)), nest=(0.5, 0.0, 1.05))
    paid = forage(SEARCH, NO_LIGHT, 300, replace(model, food_radius=0.1, food_items=32)) > 0.0
    assert 0.0 < paid.mean() < 0.2


def test_the_same_seeds_give_the_same_bits_and_others_do_not() -> None:
    arguments = {"model": load_model(), "behaviour": Behaviour()}
    genomes, scenarios = np.tile(POSITIVE, (50, 1)), np.full(50, AT_NEST)
    first = evaluate(genomes, scenarios, seeds(50), **arguments)
    again = evaluate(genomes, scenarios, seeds(50), **arguments)
    other = evaluate(genomes, scenarios, seeds(50, 1), **arguments)
    assert (first.fitness == again.fitness).all()
    assert (first.fitness != other.fitness).any()


def test_a_trial_does_not_depend_on_its_neighbours_in_the_batch() -> None:
    arguments = {"model": load_model(), "behaviour": Behaviour()}
    genomes = np.array([SEARCH, POSITIVE, NEGATIVE])
    whole = evaluate(genomes, [2, 1, 0], seeds(3), **arguments).fitness
    alone = [
        evaluate(genomes[i : i + 1], [2 - i], seeds(3)[i : i + 1], **arguments).fitness[0]
        for i in range(3)
    ]
    assert whole.tolist() == alone


def test_phototaxis_pays_where_the_lamp_makes_it_useful() -> None:
    assert forage(POSITIVE, AT_NEST).mean() > 2.0 * forage(SEARCH, AT_NEST).mean()
    assert forage(NEGATIVE, OPPOSITE).mean() > 1.5 * forage(SEARCH, OPPOSITE).mean()
    assert forage(POSITIVE, OPPOSITE).mean() < 0.5 * forage(SEARCH, OPPOSITE).mean()


def test_without_a_lamp_the_genes_make_no_difference() -> None:
    search, positive = forage(SEARCH, NO_LIGHT), forage(POSITIVE, NO_LIGHT)
    assert (search == positive).all()  # the same seeds, and nothing to see


def test_null_terms_leave_whole_evaluations_bit_for_bit() -> None:
    limits = dict.fromkeys(("acceleration", "speed_limit"), (math.inf, math.inf))
    null = Drive(turn_first=math.inf, start_delay=0.0, **limits)
    model = replace(load_model(), drive=null, senses=Senses(lamp_height=0.10))
    assert (forage(POSITIVE, AT_NEST, 50, model) == forage(POSITIVE, AT_NEST, 50)).all()


def test_a_slow_motor_or_a_late_command_costs_food() -> None:
    nominal = forage(POSITIVE, AT_NEST).mean()
    slow = replace(load_model(), drive=Drive(speed_limit=(2.0, 2.0)))
    late = replace(load_model(), drive=Drive(latency=1.0))
    assert forage(POSITIVE, AT_NEST, model=slow).mean() < 0.7 * nominal
    assert forage(POSITIVE, AT_NEST, model=late).mean() < 0.9 * nominal


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"food_items": 33}, "food_items: got 33, expected a number from 0 to 32"),
        ({"food_items": 2**40}, "food_items: got"),
        ({"nest": (0.5, 0.0, 2.0)}, "nest.radius: got 2, expected a number from 0 to 1.06"),
        ({"nest": (0.5, 0.0)}, "nest: got 2 numbers, expected 3 numbers"),
        ({"nest": (0.5, 0.0, 1.0649999999)}, "nest: got no place outside it in 100000 draws"),
        ({"arena_radius": 0.03}, "arena_radius: got 0.03"),
        ({"lamps": ((1e300, 0.0), None, None)}, "lamps: got 1e\\+300 m away"),
        ({"lamps": (None, None)}, "lamps: got 2 places"),
        ({"sensor_angles": (0.0,) * 7}, "sensor_angles: got 7 numbers, expected 8 numbers"),
        ({"drive": Drive(latency=9.0)}, "drive.latency: got 9, expected a number from 0 to 2.48"),
        ({"drive": Drive(wheel_radius=(math.nan, 0.02))}, r"drive.wheel_radius\[0\]: got nan"),
        ({"drive": Drive(acceleration=(0.0, 1.0))}, r"drive.acceleration\[0\]: got 0"),
        ({"senses": Senses(ps_gain=(1.0,))}, "senses.ps_gain: got 1 numbers, expected 8 numbers"),
        ({"senses": Senses(light_exponent=1e9)}, "senses: got light_exponent = 1000000000.0"),
        ({"senses": Senses(rotation=math.inf)}, "senses.rotation: got inf"),
    ],
)
def test_models_that_cannot_be_run_are_refused_by_the_name_of_the_field(
    change: dict[str, object], says: str
) -> None:
    model = replace(load_model(), **change)
    with pytest.raises(InputError, match=says):
        forage(SEARCH, AT_NEST, 2, model)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"cruise_speed": math.nan},
            "cruise_speed: got nan, expected a number from -1000000000000 to",
        ),
        ({"avoid_threshold": (200.0,)}, "behaviour.avoid_threshold: got 1 numbers"),
        ({"search_duration": (2.0, 0.4)}, r"behaviour.search_duration\[1\]: got 0.4"),
        ({"avoid_memory": 1e9}, "behaviour.avoid_memory: got 1e\\+?0?9|got 1000000000"),
        ({"light_gain": "much"}, "behaviour.light_gain: got"),
    ],
)
def test_controllers_that_cannot_be_run_are_refused_by_the_name_of_the_field(
    change: dict[str, object], says: str
) -> None:
    behaviour = replace(Behaviour(), **change)
    with pytest.raises(InputError, match=says):
        evaluate([SEARCH], [1], seeds(1), model=load_model(), behaviour=behaviour)


@pytest.mark.parametrize("field", ["ps_counts", "ls_counts", "ps_noise", "ps_range", "counts_max"])
def test_tables_of_another_shape_or_with_what_no_sensor_reads_are_refused(field: str) -> None:
    tables = load_model().tables
    was = getattr(tables, field)
    wrong = [np.full_like(was, math.nan), was[..., :1]] if np.ndim(was) else [math.nan, -math.inf]
    for value in wrong:
        model = replace(load_model(), tables=replace(tables, **{field: value}))
        with pytest.raises(InputError, match=f"tables.{field}"):
            readings([[0, 0, 0]], [0], model=model)


def test_tables_of_doubles_or_in_another_order_read_the_same() -> None:
    tables = load_model().tables
    other = replace(
        tables,
        ps_counts=np.asfortranarray(tables.ps_counts),
        ls_counts=tables.ls_counts.astype(np.float64),
    )
    poses, scenarios = [[0.5, 0.1, 0.3]], [AT_NEST]
    nominal = readings(poses, scenarios, model=load_model())
    same = readings(poses, scenarios, model=replace(load_model(), tables=other))
    assert same.ps.tobytes() == nominal.ps.tobytes()
    assert same.ls.tobytes() == nominal.ls.tobytes()


@pytest.mark.parametrize("turns", [-7.0, 0.6, 6.0, 1e6])
def test_an_angle_is_an_angle_however_many_turns_it_is(turns: float) -> None:
    """In every form: the ring's bearings stay inside the light's table."""
    results = []
    for rotation in (turns, math.remainder(turns, math.tau)):
        model = replace(load_model(), senses=Senses(rotation=rotation))
        for form in filter(has_form, FORMS):
            results.append(
                evaluate(
                    np.tile(POSITIVE, (20, 1)),
                    [AT_NEST] * 20,
                    seeds(20),
                    model=model,
                    behaviour=Behaviour(),
                    form=form,
                ).fitness
            )
    assert np.ptp(results, axis=0).max() == 0.0


@pytest.mark.parametrize(
    ("genomes", "scenarios", "rows"), [([[0.5]], [1], 1), ([SEARCH], [3], 1), ([SEARCH], [1], 2)]
)
def test_inputs_that_do_not_fit_are_refused(
    genomes: list[object], scenarios: list[int], rows: int
) -> None:
    with pytest.raises(ValueError, match="expected"):
        evaluate(
            np.array(genomes), scenarios, seeds(rows), model=load_model(), behaviour=Behaviour()
        )


def test_infrared_follows_the_captured_table_before_the_wall() -> None:
    model = load_model()
    assert model.tables is not None
    for distance in (0.005, 0.02, 0.05, 0.1):
        x = model.arena_radius - model.body_radius - distance
        counts = readings([[x, 0.0, -SENSOR_ANGLES[0]]], [NO_LIGHT], model=model).ps[0, 0]
        law = 3600.0 * (0.009 / (distance + 0.009)) ** 2
        assert counts == pytest.approx(law, rel=0.06, abs=2.0)


def test_infrared_is_zero_in_the_middle_and_symmetric_to_the_wall() -> None:
    model = load_model()
    predicted = readings([[0, 0, 1.0], [0.55, 0, 0.0]], [NO_LIGHT] * 2, model=model).ps
    assert not predicted[0].any()
    assert predicted[1, 0] == pytest.approx(predicted[1, 7], rel=0.1)


def test_light_is_brightest_in_the_sensor_that_faces_the_lamp() -> None:
    model = load_model()
    poses = [[0.2, 0.0, -angle] for angle in SENSOR_ANGLES]
    ls = readings(poses, [AT_NEST] * 8, model=model).ls
    assert [int(np.argmin(row)) for row in ls] == list(range(8))
    assert (readings(poses, [NO_LIGHT] * 8, model=model).ls == model.tables.ls_dark).all()


def test_light_keeps_its_order_all_the_way_round() -> None:
    """No jump anywhere on the circle of bearings: the table has no seam."""
    model = load_model()
    yaw = np.linspace(-np.pi, np.pi, 721)
    poses = np.column_stack([np.zeros((721, 2)), yaw])
    ls = readings(poses, np.full(721, AT_NEST), model=model).ls
    assert np.abs(np.diff(ls, axis=0)).max() < 5.0
    assert ls[0] == pytest.approx(ls[-1], abs=1e-6)
