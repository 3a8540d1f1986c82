"""The embedded simulator forages: fitness, determinism, sensors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from embedded_sim import (
    SENSOR_ANGLES,
    Behaviour,
    Diverged,
    Drive,
    PointModel,
    Senses,
    evaluate,
    readings,
)
from models import load_model

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
    null = Drive(acceleration=(math.inf, math.inf), speed_limit=(math.inf, math.inf))
    model = replace(load_model(), drive=null, senses=Senses(lamp_height=0.10))
    assert (forage(POSITIVE, AT_NEST, 50, model) == forage(POSITIVE, AT_NEST, 50)).all()


def test_a_slow_motor_or_a_late_command_costs_food() -> None:
    nominal = forage(POSITIVE, AT_NEST).mean()
    slow = replace(load_model(), drive=Drive(speed_limit=(2.0, 2.0)))
    late = replace(load_model(), drive=Drive(latency=1.0))
    assert forage(POSITIVE, AT_NEST, model=slow).mean() < 0.7 * nominal
    assert forage(POSITIVE, AT_NEST, model=late).mean() < 0.9 * nominal


def test_a_diverging_model_is_an_error_that_names_the_trial() -> None:
    broken = replace(load_model(), drive=Drive(wheel_radius=(math.nan, 0.02)))
    with pytest.raises(Diverged, match="trial 0, step 0"):
        forage(SEARCH, AT_NEST, 2, broken)


@pytest.mark.parametrize(
    "change", [{"food_items": 33}, {"nest": (0.5, 0.0, 2.0)}, {"drive": Drive(latency=9.0)}]
)
def test_models_that_cannot_be_run_are_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="expected at most"):
        forage(SEARCH, NO_LIGHT, 1, replace(load_model(), **change))


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
