"""Laws in C: as defined in numpy, the same in lanes as one by one; without them nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from realitygap.embedded_sim import Behaviour, Drive, InputError, evaluate, replay
from realitygap.embedded_sim.laws import CHANNELS, FORMS, MOST_LAWS, Atom, Law
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.simulator import FORMS as COMPUTED
from realitygap.embedded_sim.simulator import has_form
from realitygap.models.belief.law_values import product
from realitygap.models.belief.modelfile import load_model

STEP = 0.01
ATOMS = (
    Atom("wheel_speed", "power", (6.0, 1.7)),
    Atom("speed", "power", (0.1, 1.0)),
    Atom("turn", "sign"),
    Atom("heading", "cosine", (3.0, 0.7)),
    Atom("time", "cosine", (1.3, -0.4)),
    Atom("place", "slope", (0.5, 2.0)),
    Atom("place", "half", (1.1, 0.02)),
    Atom("place", "disc", (0.05, 0.02, 0.08)),
    Atom("radius", "power", (0.5, 2.0)),
    Atom("wall", "fade", (0.3,)),
    Atom("gap", "below", (0.2,)),
    Atom("wheel_speed", "below", (5.0,)),
    Atom("wheel_speed", "over", (5.0,)),
    Atom("speed", "always"),
    Atom("heading", "curve", (0.0, 2.0 * np.pi, 0.1, -0.3, 0.5, 0.1)),
)
FEW = np.random.default_rng(8)


def commands(rows: int) -> tuple[FloatArray, FloatArray]:
    t = STEP * np.arange(rows)
    return t, np.column_stack([5.0 + 3.0 * np.sin(2.0 * t), 6.0 - 2.0 * np.cos(3.0 * t)])


def by_definition(drive: Drive, t: FloatArray, told: FloatArray, gap: float) -> FloatArray:
    """(rows, 3) by small steps; every quantity at the middle of a step."""
    pose = np.zeros(3)
    poses = [pose.copy()]
    for row in range(len(t) - 1):
        h = t[row + 1] - t[row]
        wheels = np.array(told[row])
        way = wheels * np.array(drive.wheel_radius) * h
        ahead, turn = way.mean(), (way[1] - way[0]) / drive.axle
        heading = pose[2] + 0.5 * turn
        x = pose[0] + 0.5 * ahead * np.cos(heading)
        y = pose[1] + 0.5 * ahead * np.sin(heading)
        radius = np.hypot(x, y)
        known = {
            "speed": ahead / h,
            "turn": turn / h,
            "heading": heading,
            "time": t[row] + 0.5 * h,
            "radius": radius,
            "wall": drive.reach - radius,
            "gap": gap - 2.0 * drive.body,
        }
        numbers = {name: np.array([one]) for name, one in known.items()}
        numbers["place"] = np.array([[x, y]])
        change = dict.fromkeys(CHANNELS, 0.0)
        for law in drive.laws:
            for side, channel in enumerate(("left", "right")):
                if law.channel in (channel, "both"):
                    own = {**numbers, "wheel_speed": np.array([wheels[side]])}
                    way[side] *= 1.0 + law.amplitude * product(law.atoms, own)[0]
            if law.channel not in ("left", "right", "both"):
                change[law.channel] = law.amplitude * product(law.atoms, numbers)[0]
        whole = way.mean() * (1.0 + change["speed"])
        spun = (way[1] - way[0]) / drive.axle * (1.0 + change["turning"])
        spun += change["turn"] * h + change["bend"] * abs(ahead)
        aside = change["aside"] * ahead
        middle = pose[2] + 0.5 * spun
        pose[0] += whole * np.cos(middle) - aside * np.sin(middle)
        pose[1] += whole * np.sin(middle) + aside * np.cos(middle)
        pose[2] += spun
        poses.append(pose.copy())
    return np.array(poses)


def replayed(drive: Drive, seen: Any = None) -> FloatArray:
    t, told = commands(300)
    return replay(t, told, [0, 300], [[0.0, 0.0, 0.0]], drive=drive, seen=seen).poses


@pytest.mark.parametrize("atom", ATOMS, ids=lambda one: f"{one.of}-{one.form}")
@pytest.mark.parametrize("channel", CHANNELS)
def test_a_law_moves_a_robot_as_its_definition_says(channel: Any, atom: Atom) -> None:
    if atom.of == "wheel_speed" and channel not in ("left", "right", "both"):
        return  # a body has no wheel of its own
    drive = Drive(laws=(Law(channel, 0.2, (atom,)),), reach=0.6, body=0.035)
    t, told = commands(300)
    gap = 0.25
    wanted = by_definition(drive, t, told, gap)
    where = by_definition(drive, t, told, gap)
    seen = np.column_stack([where, np.full(300, gap)])
    np.testing.assert_allclose(replayed(drive, seen), wanted, atol=2e-4)
    assert np.abs(wanted - replayed(Drive())).max() > 1e-3


def test_two_atoms_are_multiplied_and_laws_added() -> None:
    one = Law(
        "turn", 0.3, (Atom("heading", "cosine", (1.0, 0.0)), Atom("radius", "power", (0.5, 1.0)))
    )
    drive = Drive(laws=(one, Law("both", -0.1, (Atom("turn", "sign"),))), reach=0.6, body=0.035)
    t, told = commands(300)
    np.testing.assert_allclose(replayed(drive), by_definition(drive, t, told, np.inf), atol=3e-4)


def test_laws_of_amplitude_0_change_no_bit() -> None:
    laws = tuple(Law(channel, 0.0, (ATOMS[3],)) for channel in CHANNELS) * 3
    assert replayed(Drive(laws=laws)).tobytes() == replayed(Drive()).tobytes()


@pytest.mark.parametrize("form", [form for form in COMPUTED if has_form(form)])
@pytest.mark.parametrize("some", [ATOMS[k::3] for k in range(3)], ids=str)
def test_lanes_obey_bit_for_bit(form: Any, some: Any) -> None:
    """Every form, of a wheel or of both, and of the body."""
    wheels = [Law("both" if k % 2 else "right", -0.1, (atom,)) for k, atom in enumerate(some)]
    turns = [Law("turn", 0.1, (atom,)) for atom in some if atom.of != "wheel_speed"]
    laws = (*wheels, *turns)[:MOST_LAWS]
    model = load_model()
    drive = replace(model.drive, laws=laws, reach=0.565, body=0.035, latency=0.05)
    lawful = replace(model, drive=drive)
    genomes, scenarios = FEW.uniform(0.0, 0.99, (40, 2)), FEW.integers(0, 3, 40)
    seeds = FEW.integers(0, 2**32, (40, 4))

    def forage(of: Any, computed: Any) -> Any:
        return evaluate(
            genomes, scenarios, seeds, model=of, behaviour=Behaviour(), seconds=20.0, form=computed
        )

    one, other = forage(lawful, "one_by_one"), forage(lawful, form)
    assert one.fitness.tobytes() == other.fitness.tobytes()
    assert one.fitness.tobytes() != forage(model, "one_by_one").fitness.tobytes()


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Law("both", 0.1, ()), "one or two"),
        (Law("both", 0.1, (Atom("left_angle", "cosine", (1.0, 0.0)),)), "one of wheel_speed"),
        (Law("both", 0.1, (Atom("place", "power", (1.0, 1.0)),)), "drive.laws of"),
        (Law("both", 0.1, (Atom("gap", "fade", (0.0,)),)), "drive.laws scale"),
        (Law("both", 0.1, (Atom("gap", "curve", (0.0, 1.0)),)), "those of curve"),
        (Law("both", np.inf, (Atom("turn", "sign"),)), "drive.laws amplitude"),
        (Law("both", 0.1, (Atom("heading", "cosine", (99.0, 0.0)),)), "drive.laws harmonic"),
    ],
)
def test_what_is_no_law_is_refused(law: Law, expected: str) -> None:
    with pytest.raises(InputError, match=expected):
        Drive(laws=(law,)).struct()


def test_every_form_is_tried() -> None:
    assert {atom.form for atom in ATOMS} == set(FORMS)
