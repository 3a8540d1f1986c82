"""The two evolutionary operators against the paper's text."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.breeding import next_controllers, next_environment, random_genes, third
from realitygap.embedded_sim.genome import READINGS, reading

DEFAULT = READINGS["default"]


def generator(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(READINGS)))
def test_genes_stay_in_their_range_under_every_reading(seed: int, name: str) -> None:
    random = generator(seed)
    genomes = random_genes((10, 2), random)
    genomes = next_controllers(genomes, random.random(10), READINGS[name], random)
    s0 = next_environment(random.random((5, 2)) * 0.99, READINGS[name], random)
    assert genomes.min() >= 0.0
    assert genomes.max() <= 0.99
    assert 0.0 <= s0 <= 0.99


@given(st.integers(0, 2**32 - 1))
def test_the_best_six_survive_and_the_worst_four_are_overwritten_by_the_best(seed: int) -> None:
    random = generator(seed)
    genomes, fitness = random_genes((10, 2), random), random.random(10)
    ranked = genomes[np.argsort(-fitness)]
    after = next_controllers(genomes, fitness, DEFAULT, random)
    assert (after[:6] == ranked[:6]).all()
    exact = next_controllers(genomes, fitness, replace(DEFAULT, controller_sd=0.0), random)
    assert (exact[6:] == ranked[:4]).all()  # without mutation the children are their parents


def test_each_gene_of_a_child_mutates_with_probability_a_fifth() -> None:
    random = generator(1)
    changed = []
    for _ in range(2000):
        genomes, fitness = random_genes((10, 2), random), random.random(10)
        ranked = genomes[np.argsort(-fitness)]
        changed.append(next_controllers(genomes, fitness, DEFAULT, random)[6:] != ranked[:4])
    assert np.mean(changed) == pytest.approx(0.2, abs=0.012)  # 4 s.d. of 16 000 draws


def test_a_population_never_loses_its_best_controller() -> None:
    random = generator(2)
    genomes = random_genes((10, 2), random)
    best = 0.0
    for _ in range(50):
        fitness = genomes.sum(axis=1)
        assert fitness.max() >= best
        best = fitness.max()
        genomes = next_controllers(genomes, fitness, DEFAULT, random)


def test_s0_descends_from_the_fittest_pair() -> None:
    random = generator(3)
    pairs = np.array([[0.1, 5.0], [0.8, 50.0], [0.4, 20.0]])
    children = [next_environment(pairs, DEFAULT, random) for _ in range(4000)]
    # clamped at 0.99, a normal of s.d. 0.2 about 0.8 loses 0.017 of its mean
    assert np.mean(children) == pytest.approx(0.8 - 0.0217, abs=0.012)


def test_a_robot_alone_has_no_selection_pressure_on_s0() -> None:
    """With one pair, its fitness changes nothing: the same draws give the same child."""
    poor = next_environment(np.array([[0.5, 0.0]]), DEFAULT, generator(4))
    rich = next_environment(np.array([[0.5, 500.0]]), DEFAULT, generator(4))
    assert poor == rich


def test_neutral_reading_draws_the_parent_regardless_of_fitness() -> None:
    random = generator(5)
    pairs = np.array([[0.0, 0.0], [0.99, 100.0]])
    low = [next_environment(pairs, READINGS["neutral"], random) < 0.5 for _ in range(2000)]
    assert np.mean(low) == pytest.approx(0.5, abs=0.05)


def test_ties_are_drawn_by_lot() -> None:
    random = generator(6)
    pairs = np.array([[0.0, 0.0], [0.99, 0.0]])
    low = [next_environment(pairs, DEFAULT, random) < 0.5 for _ in range(2000)]
    assert np.mean(low) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize(
    ("gene", "expected"),
    [(0.0, 0), (0.32, 0), (0.33, 1), (0.65, 1), (0.66, 2), (0.99, 2)],
)
def test_genes_map_to_thirds_as_in_figures_4_and_5(gene: float, expected: int) -> None:
    assert third(gene) == expected


@pytest.mark.parametrize(
    ("name", "inside", "below", "above"),
    [("default", 0.5, 0.0, 0.99), ("wrap", 0.5, 0.79, 0.21), ("reflect", 0.5, 0.2, 0.78)],
)
def test_bounding_rules_bring_genes_back_as_named(
    name: str, inside: float, below: float, above: float
) -> None:
    bounded = READINGS[name].bound(np.array([0.5, -0.2, 1.2]))
    assert bounded == pytest.approx([inside, below, above])


def test_an_unknown_reading_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match="did you mean literal"):
        reading("litteral")
