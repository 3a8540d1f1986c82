"""The continuous genome: what its genes stand for, in simulation and on the robot."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Behaviour, evaluate
from realitygap.embedded_sim.breeding import Bred, CoEvolution, next_controllers
from realitygap.embedded_sim.genome import CONTINUOUS, PAPER, READINGS
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.onboard import Swarm
from realitygap.models import load_model

AT_NEST = 2
NOMINAL = Behaviour()


def seeds(trials: int) -> np.ndarray:
    return np.random.default_rng(3).integers(0, 2**32, (trials, 4), dtype=np.uint32)


@given(st.lists(st.floats(0.0, 0.99), min_size=7, max_size=7))
def test_genes_stand_for_constants_within_their_ranges(genes: list[float]) -> None:
    values = CONTINUOUS.values(np.array(genes))
    for gene in CONTINUOUS.continuous:
        assert gene.low * 0.999999 <= values[gene.name] <= gene.high * 1.000001
    assert all(type(value) is float for value in values.values())


def test_the_papers_controller_is_within_reach_of_every_gene() -> None:
    paper = {
        "avoid_threshold_scale": 1.0,
        "avoid_speed": NOMINAL.avoid_speed,
        "light_gain": NOMINAL.light_gain,
        "search_curvature": NOMINAL.search_curvature,
        "cruise_speed": NOMINAL.cruise_speed,
    }
    assert {gene.name for gene in CONTINUOUS.continuous} == set(paper)
    for gene in CONTINUOUS.continuous:
        assert gene.low < paper[gene.name] < gene.high


def test_the_papers_genome_leaves_the_controller_as_it_is() -> None:
    assert PAPER.behaviour(np.array([0.9, 0.5]), NOMINAL) is NOMINAL


def test_every_trial_runs_with_its_own_constants() -> None:
    """A batch of two behaviours gives what each gives alone, bit for bit."""
    slow = CONTINUOUS.behaviour(np.array([0.9, 0.5, 0.3, 0.5, 0.3, 0.4, 0.2]), NOMINAL)
    genomes, scenarios = np.tile([0.9, 0.5], (20, 1)), [AT_NEST] * 20
    model = load_model()
    behaviours = [slow, NOMINAL] * 10
    mixed = evaluate(genomes, scenarios, seeds(20), model=model, behaviour=behaviours).fitness
    for k, behaviour in enumerate((slow, NOMINAL)):
        alone = evaluate(genomes, scenarios, seeds(20), model=model, behaviour=behaviour).fitness
        assert mixed[k::2].tolist() == alone[k::2].tolist()
    assert mixed[0::2].mean() < 0.5 * mixed[1::2].mean()  # 2 rad/s instead of 6


def test_as_many_behaviours_as_trials_are_expected() -> None:
    with pytest.raises(ValueError, match="behaviour: got 3, expected one or 2"):
        evaluate([[0.5, 0.5]] * 2, [1, 1], seeds(2), model=load_model(), behaviour=[NOMINAL] * 3)


class Slow:
    """A breeder whose second robot drives slowly."""

    def start(self, robot: int) -> Bred:
        genes = np.array([0.5, 0.5, 0.3, 0.5, 0.3, 0.4, 0.0])
        behaviour = CONTINUOUS.behaviour(genes, NOMINAL) if robot else None
        return Bred((0.5, 0.5), 0.5, 0.0, behaviour)

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        return self.start(robot)


def test_a_robot_drives_with_the_constants_of_its_genome() -> None:
    swarm = Swarm(
        np.random.SeedSequence(1), breeder=Slow(), behaviour=NOMINAL, start_steps=np.zeros(2, int)
    )
    nothing = np.zeros(2, dtype=np.uint8)
    swarm.step(0, np.zeros((2, 8)), np.full((2, 8), 4000.0), nothing, nothing)
    assert np.abs(swarm.commands).max(axis=1) == pytest.approx([NOMINAL.cruise_speed, 1.0])


def test_continuous_genes_mutate_in_small_steps_and_the_papers_as_before() -> None:
    random = np.random.default_rng(4)
    genomes, fitness = np.full((10, 7), 0.5), np.arange(10.0)[::-1]
    children = [
        next_controllers(genomes, fitness, READINGS["default"], random, CONTINUOUS)[6:]
        for _ in range(1000)
    ]
    changes = np.abs(np.concatenate(children) - 0.5)
    # P(|N(0, 0.2)| < 0.1) = 0.383, P(|N(0, 2)| < 0.1) = 0.040; a fifth of 4000 mutate
    for gene, small in zip(range(7), [0.040] * 2 + [0.383] * 5, strict=True):
        mutated = changes[:, gene][changes[:, gene] > 0]
        assert np.mean(mutated < 0.1) == pytest.approx(small, abs=0.07)


def test_twenty_generations_in_simulation_breed_better_constants() -> None:
    """Judged on trials that evolution has not seen, over four robots."""
    model, random = load_model(), np.random.SeedSequence(5)
    breeder = CoEvolution(
        random.spawn(4),
        models=[model] * 4,
        behaviour=NOMINAL,
        reading=READINGS["literal"],  # S0 stays as it is while controllers are bred
        trials=4,
        genome=CONTINUOUS,
    )
    breeder._s0[:] = [0.9] * 4

    def mean_fitness(bred: list[Bred]) -> float:
        return float(
            np.mean(
                [
                    evaluate(
                        np.tile(one.genome[:2], (100, 1)),
                        [AT_NEST] * 100,
                        seeds(100),
                        model=model,
                        behaviour=one.behaviour or NOMINAL,
                    ).fitness.mean()
                    for one in bred
                ]
            )
        )

    first = [breeder.start(robot) for robot in range(4)]
    for _ in range(20):
        last = []
        for robot in range(4):
            last.append(breeder.breed(robot, np.array([[0.9, 1.0]])))
            breeder._s0[robot] = 0.9
    assert all(len(one.genome) == 7 for one in last)
    assert mean_fitness(last) > 1.3 * mean_fitness(first)
