"""The on-board programs: clocks, fitness in reality, what is heard and compared."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim import Behaviour, InputError, breeding
from realitygap.embedded_sim.breeding import Bred, CoEvolution, Fixed
from realitygap.embedded_sim.genome import READINGS
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.onboard import GENERATION_STEPS, Swarm
from realitygap.embedded_sim.simulator import Evaluation
from realitygap.models import load_model

SEARCH = Fixed((0.5, 0.5))


class Script:
    """A swarm fed a scripted virtual sensor, nothing near and no light."""

    def __init__(self, robots: int = 1, starts: list[int] | None = None, breeder=SEARCH) -> None:
        self.swarm = Swarm(
            np.random.SeedSequence(1),
            breeder=breeder,
            behaviour=Behaviour(),
            start_steps=np.array(starts or [0] * robots),
        )
        self.robots = robots
        self.ps, self.ls = np.zeros((robots, 8)), np.full((robots, 8), 4000.0)

    def run(self, steps: range, food: set[int] = frozenset(), nest: set[int] = frozenset()) -> None:
        for step in steps:
            on_food = np.full(self.robots, step in food, dtype=np.uint8)
            on_nest = np.full(self.robots, step in nest, dtype=np.uint8)
            self.swarm.step(step, self.ps, self.ls, on_food, on_nest)


def test_fitness_in_reality_is_eq_1_on_the_robots_own_clock() -> None:
    script = Script(starts=[25])  # switched on at 1 s
    script.run(range(GENERATION_STEPS + 26), food={50, 200}, nest={125, 525})
    (generation,) = script.swarm.generations
    # deposits 4 s and 20 s after it was switched on
    assert generation.fitness_real == pytest.approx((60.0 - 4.0) + (60.0 - 20.0))
    assert generation.deposits == 2
    assert script.swarm.deposits == [(0, 125, 50, 0), (0, 525, 200, 0)]


def test_food_is_dropped_only_on_the_nest_and_one_item_at_a_time() -> None:
    script = Script()
    script.run(range(100), food=set(range(10, 60)), nest={5, 40})
    assert script.swarm.deposits == [(0, 40, 10, 0)]
    assert script.swarm.carrying[0] == 1  # picked up again at 41


def test_robots_turn_over_on_their_own_clocks() -> None:
    script = Script(robots=2, starts=[0, 30])
    script.run(range(2 * GENERATION_STEPS + 31))
    closed = [(g.robot, g.generation, g.start_step, g.end_step) for g in script.swarm.generations]
    assert closed == [
        (0, 0, 0, 1500),
        (1, 0, 30, 1530),
        (0, 1, 1500, 3000),
        (1, 1, 1530, 3030),
    ]


def test_a_robot_not_yet_switched_on_stands_still() -> None:
    script = Script(robots=2, starts=[0, 30])
    script.run(range(30))
    assert script.swarm.commands[0].any()
    assert not script.swarm.commands[1].any()


class Listening:
    """A breeder that keeps the pairs it is shown."""

    def __init__(self) -> None:
        self.shown: list[FloatArray] = []

    def start(self, robot: int) -> Bred:
        return Bred((0.5, 0.5), robot / 100.0, 0.0)

    def breed(self, robot: int, pairs: FloatArray) -> Bred:
        self.shown.append(pairs)
        return self.start(robot)


def test_own_pair_comes_first_then_the_latest_of_each_robot_ten_in_all() -> None:
    listener = Listening()
    script = Script(robots=14, breeder=listener)
    script.run(range(1))
    heard = np.zeros((14, 14), dtype=np.uint8)
    for sender in range(1, 14):
        heard[:] = 0
        heard[0, sender] = 1
        script.swarm.hear(heard, sender)
        script.swarm.hear(heard, sender)  # twice: one pair each all the same
    script.run(range(1, GENERATION_STEPS + 1))
    first = listener.shown[0]
    assert first[:, 0] == pytest.approx([0.0] + [s / 100 for s in range(13, 4, -1)])
    assert listener.shown[1].shape == (1, 2)  # robot 1 heard nobody


def test_the_temporary_population_is_cleared_each_generation() -> None:
    listener = Listening()
    script = Script(robots=2, breeder=listener)
    script.run(range(1))
    script.swarm.hear(np.array([[0, 1], [1, 0]], dtype=np.uint8), 0)
    script.run(range(1, 2 * GENERATION_STEPS + 1))
    assert [len(pairs) for pairs in listener.shown] == [2, 2, 1, 1]


@pytest.mark.parametrize(("name", "moves"), [("default", True), ("literal", False)])
def test_the_reading_decides_which_s0_bred_the_controller(name: str, moves: bool) -> None:
    """By default the S0 broadcast is the one that bred the controllers; literally, the next."""
    bred_under: list[int] = []
    breeder = CoEvolution(
        [np.random.SeedSequence(3)],
        models=[load_model()],
        behaviour=Behaviour(),
        reading=READINGS[name],
    )
    original = breeder._generation

    def spy(robot: int) -> Bred:
        bred = original(robot)
        bred_under.append(bred.s0)
        return bred

    breeder._generation = spy  # type: ignore[method-assign]
    first = breeder.start(0)
    second = breeder.breed(0, np.array([[first.s0, 10.0]]))
    assert (second.s0 == bred_under[-1]) == moves


def test_of_ten_controllers_the_fittest_is_deployed(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[FloatArray] = []

    def fitness(genomes: FloatArray, *_: object, **__: object) -> Evaluation:
        seen.append(genomes)
        return Evaluation(np.array([3.0, 1, 4, 1, 5, 9, 2, 6, 5, 3]), np.zeros(10, dtype=np.int32))

    monkeypatch.setattr(breeding, "evaluate", fitness)
    breeder = CoEvolution(
        [np.random.SeedSequence(5)],
        models=[load_model()],
        behaviour=Behaviour(),
        reading=READINGS["default"],
    )
    bred = breeder.start(0)
    assert bred.genome == tuple(seen[0][5])
    assert bred.fitness_sim == 9.0


def test_the_deployed_controller_is_the_best_in_the_embedded_simulator() -> None:
    breeder = CoEvolution(
        [np.random.SeedSequence(5)],
        models=[load_model()],
        behaviour=Behaviour(),
        reading=READINGS["default"],
        trials=8,
    )
    breeder._s0[0] = 0.9  # light at nest
    bred = breeder.start(0)
    for _ in range(15):
        bred = breeder.breed(0, np.array([[0.95, 1.0]]))
        breeder._s0[0] = 0.9
    assert bred.genome[0] >= 0.66  # positive phototaxis with food: learnt in simulation alone


def test_avoidance_turns_away_from_the_nearer_side_and_commits_half_a_second() -> None:
    script = Script()
    script.ps[0, 0] = 1000.0  # front right
    script.run(range(1))
    assert script.swarm.commands[0] == pytest.approx([-4.0, 4.0])  # turn left
    script.ps[:] = 0.0
    turning = 0
    for step in range(1, 40):
        script.run(range(step, step + 1))
        turning += int(script.swarm.commands[0, 0] < 0)
    assert turning == 12  # 13 steps of 40 ms with the first: half a second, rounded up


def test_search_turns_as_often_to_either_side() -> None:
    script = Script(robots=20)
    turned = np.zeros(2)
    for step in range(1500):
        script.run(range(step, step + 1))
        left, right = script.swarm.commands.T
        turned += [(left < right).sum(), (left > right).sum()]
    assert turned[0] / turned.sum() == pytest.approx(0.5, abs=0.06)


def test_what_is_fainter_than_a_lamp_is_not_followed() -> None:
    """Forty counts are five times the noise of a light sensor."""
    commands = []
    for contrast in (0.0, 35.0, 45.0):
        script = Script(breeder=Fixed((0.5, 0.9)))
        script.ls[0, 5] -= contrast
        script.run(range(1))
        commands.append(script.swarm.commands[0].tolist())
    assert commands[0] == commands[1] != commands[2]


@pytest.mark.parametrize(("wait", "again"), [(5, True), (11, True), (13, False), (20, False)])
def test_an_obstacle_met_soon_after_a_turn_is_turned_from_the_same_way(
    wait: int, again: bool
) -> None:
    """The turn takes 13 steps of 40 ms and is remembered for as many: an obstacle on the other side
    is turned from as the first was, until then."""
    script = Script()
    script.ps[0, 0] = 1000.0  # front right
    script.run(range(1))
    script.ps[:] = 0.0
    script.run(range(1, 13 + wait))
    assert script.swarm.commands[0, 1] > 0.0
    script.ps[0, 7] = 1000.0  # front left
    script.run(range(13 + wait, 14 + wait))
    left = [-4.0, 4.0]
    assert script.swarm.commands[0] == pytest.approx(left if again else left[::-1])


def test_phototaxis_turns_towards_or_away_from_the_light() -> None:
    for genome, side in ((0.9, 1), (0.1, -1)):
        script = Script(breeder=Fixed((0.5, genome)))
        script.ls[0, 5] = 3000.0  # ps5: left
        script.run(range(1))
        left, right = script.swarm.commands[0]
        assert np.sign(right - left) == side


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("ps", np.zeros((2, 8))),
        ("ps", np.zeros((3, 8), dtype=np.float32)),
        ("ls", np.zeros((8, 3)).T),
        ("ls", [[0.0] * 8] * 3),
        ("on_food", np.zeros(2, dtype=np.uint8)),
        ("on_nest", np.zeros(3, dtype=np.bool_)),
        ("ps", np.full((3, 8), np.nan)),
        ("ls", np.full((3, 8), np.inf)),
    ],
)
def test_arrays_that_are_not_the_swarms_are_refused(field: str, value: object) -> None:
    """Also after a step with good ones, whose memory is kept."""
    script = Script(robots=3)
    flags = np.zeros(3, dtype=np.uint8)
    good = {"ps": script.ps, "ls": script.ls, "on_food": flags, "on_nest": flags}
    script.swarm.step(0, **good)
    with pytest.raises(InputError, match=f"^{field}"):
        script.swarm.step(1, **{**good, field: value})


def test_what_is_heard_has_a_row_and_a_column_per_robot() -> None:
    with pytest.raises(InputError, match="heard"):
        Script(robots=3).swarm.hear(np.zeros((2, 3), dtype=np.uint8), 0)


def test_a_swarm_has_a_robot() -> None:
    with pytest.raises(InputError, match="start_steps"):
        Swarm(np.random.SeedSequence(1), breeder=SEARCH, behaviour=Behaviour(), start_steps=[])
