"""Which manoeuvre tells two rivals apart: analytic truths, and what poses cannot separate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Drive, PointModel
from realitygap.embedded_sim.probes import MENU
from realitygap.models.belief.catalogue import causes, every_cause, sense_causes
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief
from realitygap.models.log.measured import make_log
from realitygap.models.log.repertoire import manoeuvres
from realitygap.models.naming.channels.motion.candidates import candidates
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.senses import nest
from realitygap.models.naming.channels.senses.joined import with_senses
from realitygap.models.naming.channels.senses.terms import columns_of
from realitygap.models.naming.diagnosis import alternatives
from realitygap.models.naming.engine.hypothesis import Fit, Term
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.health.reference import INHERENT, Column, Reference, no_reference
from realitygap.models.naming.proposal import motion
from realitygap.models.naming.proposal.ground import Ground
from realitygap.models.naming.proposal.menu import Proposal, distance, flights, ranked
from realitygap.models.naming.proposal.propose import with_proposal
from realitygap.models.naming.rules import Rules
from tests.models.small import driven_log

MODEL = read_model_file("epuck")
ARENA = Ground(x=0.0, y=0.0, radius=0.6, walled=True, body_radius=0.035, fastest=6.28)
FLIGHTS = {one.probe.name: one for one in flights(2, PointModel(), ARENA)}


def apart(
    name: str, truth: tuple[str, float], rival: str, *, at: float = 0.0, open_by: float = 1.0
) -> float:
    """Separation of two causes in robot 0 where the log left the rival's coordinate open."""
    log = examined_log()
    tracks = motion._tracks(FLIGHTS[name], [0], (0,), log)
    assert tracks is not None
    problem = Problem(tracks, [Motion(drive=Drive())])
    own, other = (Term(causes()[cause], "") for cause in (truth[0], rival))
    fits = [
        Fit(
            terms=(term,),
            coordinates=np.array([[value]]),
            covariance=np.array([[[open_by**2]]]),
            residual=np.empty((0, 3)),
        )
        for term, value in ((own, truth[1]), (other, at))
    ]
    return motion._apart(problem, tracks, fits[0], fits[1])


def examined_log() -> motion.Tracks:
    from realitygap.models.naming.channels.motion.tracks import cut_tracks

    frame = driven_log(1, robots=2, rows=300, position_noise=5e-4, heading_noise=5e-3)
    plain = MODEL.model_copy(update={"arena": None})
    return cut_tracks(make_log(frame, drive=Drive()), plain)


def test_a_radius_and_an_axle_differ_in_straights_and_not_in_turns_on_the_spot() -> None:
    scale = ("wheel_radius_scale", 0.01)
    in_spins = apart("spins", scale, "wheel_separation")
    in_straights = apart("straights", scale, "wheel_separation")
    assert in_straights > 5.0 * in_spins
    assert in_straights > Rules().promising


def test_what_the_log_has_pinned_down_cannot_follow_the_truth() -> None:
    scale = ("wheel_radius_scale", 0.01)
    loose = apart("spins", scale, "wheel_separation", open_by=1.0)
    pinned = apart("spins", scale, "wheel_separation", open_by=1e-4)
    assert pinned > 10.0 * loose


def test_late_poses_and_late_commands_are_alike_in_every_manoeuvre() -> None:
    for name in FLIGHTS:
        assert apart(name, ("command_latency", 0.05), "clock_offset", at=0.05) < 1e-3


@given(
    st.lists(st.floats(-5, 5), min_size=4, max_size=4),
    st.lists(st.floats(-2, 2), min_size=4, max_size=4),
    st.floats(1e-3, 1e3),
)
def test_a_rival_that_may_follow_is_never_further_away(
    errors: list[float], column: list[float], open_by: float
) -> None:
    far = np.array(errors)
    columns = np.array(column)[:, None]
    free = distance(far, columns, np.array([[open_by]]))
    assert free <= np.linalg.norm(far) + 1e-9
    assert distance(far, np.zeros((4, 0)), np.zeros((0, 0))) == pytest.approx(np.linalg.norm(far))


def test_a_rival_that_the_log_leaves_wholly_open_may_follow_anywhere() -> None:
    far, columns = np.array([1.0, 2.0, -1.0]), np.array([[1.0, 0.5], [0.0, 1.0], [1.0, 0.0]])
    wide = distance(far, columns, np.diag([1e5, 0.04]))
    assert distance(far, columns, np.diag([np.inf, 0.04])) == pytest.approx(wide, rel=1e-4)
    nothing = np.column_stack([columns[:, 0], np.zeros(3)])
    assert np.isfinite(distance(far, nothing, np.diag([0.04, np.inf])))


def test_the_farthest_nearest_rival_decides() -> None:
    options = ranked({"steps": (9.0, 2.0), "spins": (5.0, 4.0)})
    assert [(o.name, o.separation) for o in options] == [("spins", 4.0), ("steps", 2.0)]
    assert not Proposal(separates=("a", "b", "c"), options=options).promises(Rules().promising)


def test_every_cause_names_a_manoeuvre_of_the_menu() -> None:
    assert {cause.experiment for cause in every_cause().values()} <= set(MENU)


def sound(acceleration: float) -> Reference:
    """Health that is the point model's, but for the wheels' limited acceleration (rad/s^2)."""
    none = Column(mean=0.0, sd=0.0, swarm_sd=0.0)
    columns = {f"{t.key}.{p.name}": none for t in candidates() for p in t.cause.parameters}
    inherent = [
        p.coordinate(acceleration) if p.unit == "rad/s^2" else 0.0 for p in INHERENT.parameters
    ]
    return no_reference("e-puck", Drive()).model_copy(
        update={"robots": 1, "swarms": 1, "columns": columns, "inherent": tuple(inherent)}
    )


def test_weak_motors_without_encoders_ask_for_steps_with_encoders() -> None:
    frame = driven_log(
        5,
        robots=1,
        rows=3000,
        drive=Drive(acceleration=(40.0, 40.0)),
        position_noise=5e-4,
        heading_noise=5e-3,
    )
    log = make_log(frame, drive=Drive())
    motion_only = diagnose(log, MODEL.model_copy(update={"arena": None}), sound(160.0))
    examined = with_proposal(with_senses(motion_only, log, None, None), log, None)
    cause = examined.diagnosis.named[0]
    assert {cause.term.cause.name, *alternatives(cause)} == {"weak_motor", "low_friction"}
    proposal = examined.diagnosis.proposal
    assert proposal is not None
    assert proposal.best.name == "steps"
    assert proposal.needs == ("wheel_left", "wheel_right")
    feasible = {name for name, one in MENU.items() if not one.walled and one.least == 1}
    assert {o.name for o in proposal.options} == feasible
    assert [rival.name for rival in proposal.rivals] == list(proposal.separates)


def test_a_nest_displaced_is_told_from_a_larger_one_where_all_its_edge_is_crossed() -> None:
    model = PointModel()
    moved = Belief(nest_shift=(-0.03, 0.0))
    lost = {}
    for name, angles in (("one place", [np.pi]), ("all round", np.linspace(1.7, 4.6, 8))):
        reach = np.linspace(0.1, 0.3, 201)
        x, y = (
            np.concatenate([centre + reach * turn(a) for a in angles])
            for centre, turn in ((model.nest[0], np.cos), (model.nest[1], np.sin))
        )
        at_x, at_y, radius = moved.of(model).nest
        rows, none = np.arange(len(x)), np.zeros(len(x), dtype=np.int64)
        inside = np.hypot(x - at_x, y - at_y) < radius
        leg = rows // len(reach)
        told = nest.Answers(np.column_stack([x, y]), inside, none, none, rows, leg, 0.0 * rows)
        edge = nest.Crossings(told, 0, model)
        (larger,) = columns_of(
            Item(Term(sense_causes()["nest_radius"], ""), None, "", "", ()), Belief(), edge.errors
        )
        errors = edge.errors(Belief())
        fitted = larger * (larger @ errors) / (larger @ larger)
        lost[name] = float(np.sum((errors - fitted) ** 2))
        assert np.abs(edge.errors(moved)).max() < 3.0**0.5 + 1e-6, "uniform between two poses"
    assert lost["one place"] < 5.0
    assert lost["all round"] > 100.0


@pytest.mark.parametrize(
    ("wheels", "answer"),
    [((4.0, 4.0), False), ((4.0, -4.0), False), ((-4.0, -4.0), True), ((0.0, 0.0), True)],
)
def test_standing_and_reversing_are_manoeuvres(wheels: tuple[float, float], answer: bool) -> None:
    log = make_log(driven_log(2, robots=1, rows=400), drive=Drive())
    commands = np.full((400, 2), 3.0)
    commands[100:150] = wheels
    commands[:50] = 0.0  # waiting to be switched on is no manoeuvre
    assert manoeuvres(replace(log, commands=commands)) is answer
