"""Whatever a fit returns becomes values that the catalogue has."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim.senses import Senses
from realitygap.models.belief.catalogue import every_cause, sense_causes
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.causes.late import COMMAND_LATENCY as LATENCY
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.senses.clock import Shift, told_apart
from realitygap.models.naming.channels.senses.diagnose import diagnose_senses
from realitygap.models.naming.diagnosis import Diagnosis, as_json, extension
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import values
from realitygap.models.naming.findings import Evidence, Named
from realitygap.models.naming.health.reference import Column
from tests.models.naming.test_senses import MODEL
from tests.models.naming.test_senses import table as sensed

QUIET = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
TERMS = [(name, v) for name, cause in every_cause().items() for v in cause.variants]
ANY = st.one_of(
    st.floats(allow_nan=False), st.floats(-10.0, 10.0), st.sampled_from(["low", "high", "null"])
)
ERROR = st.one_of(st.floats(0.0, 1e300), st.floats(0.0, 1.0), st.just(math.inf))


def coordinates(cause: Cause, drawn: st.DataObject) -> np.ndarray:
    """(p,) anything, and what lies exactly on a bound or the null."""
    found = []
    for p in cause.parameters:
        any_of = drawn.draw(ANY)
        ends = {"low": p.bounds[0], "high": p.bounds[1], "null": 0.0}
        found.append(ends[any_of] if isinstance(any_of, str) else any_of)
    return np.array(found)


def as_file(cause: Cause, variant: str, told: dict[str, ParameterValue]) -> NamedCause:
    given = {p.name: ParameterValue(value=p.high) for p in cause.given}
    return NamedCause(name=cause.name, word=variant, parameters={**told, **given})


@QUIET
@given(st.sampled_from(TERMS), st.data())
def test_any_coordinate_is_a_value_that_can_be_applied_and_read_back(
    term: tuple[str, str], data: st.DataObject
) -> None:
    name, variant = term
    cause = every_cause()[name]
    here = coordinates(cause, data)
    told = {
        p.name: ParameterValue(value=v)
        for p, v in zip(cause.parameters, cause.values(here).tolist(), strict=True)
    }
    named = as_file(cause, variant, told)
    motion = cause.applied(Motion(), here, variant)
    assert math.isfinite(motion.drive.axle)
    if isinstance(cause, SenseCause):
        believed = cause.believed(Belief(), here, variant)
        assert isinstance(believed.senses, Senses)
        assert named.sensed(Belief()) == believed
    else:
        assert named.applied(Motion(encoder_drive=None)) is not None


@QUIET
@given(st.sampled_from([n for n, c in every_cause().items() if c.parameters]), st.data())
def test_any_fit_is_a_value_with_an_interval_around_it(name: str, data: st.DataObject) -> None:
    cause = every_cause()[name]
    size = len(cause.parameters)
    here, error = coordinates(cause, data), [data.draw(ERROR) for _ in range(size)]
    covariance = np.diag(np.square(np.minimum(error, 1e150)))
    told = values(Term(cause, cause.variants[0]), here, covariance)
    assert all(one.low <= one.value <= one.high for one in told)
    given = {v.name: ParameterValue(value=v.value, low=v.low, high=v.high) for v in told}
    as_file(cause, cause.variants[0], given)


FAR_FROM_NULL = {"lamp_intensity": np.array([0.2]), "light_falloff": np.array([0.3])}


@pytest.mark.parametrize("robots", [(0,), (0, 3), (0, 1, 2)], ids=["one", "two", "three"])
@pytest.mark.parametrize("name", FAR_FROM_NULL)
def test_what_belongs_to_the_place_is_everybodys_however_many_they_are(
    name: str, robots: tuple[int, ...]
) -> None:
    cause = sense_causes()[name]
    frame = sensed({}, everybody=cause.believed(Belief(), FAR_FROM_NULL[name], ""))
    some = frame[frame["robot"].isin(robots)]
    found = diagnose_senses(make_log(some, drive=MODEL.drive), MODEL, None)
    named = tuple(one for one in found.named if one.term.cause.place)
    assert named
    written = extension(Diagnosis(named=named, robots=robots), log_hash="", command="")
    assert written.causes[0].robots == "all"
    assert as_json(Diagnosis(named=named, robots=robots))["causes"][0]["robots"] == "all"


def test_a_clock_far_too_early_is_not_called_a_latency_that_cannot_be() -> None:
    from realitygap.models.belief.causes.late import CLOCK_OFFSET as CLOCK
    from realitygap.models.naming.engine.value import Value

    term = Term(CLOCK, "")
    evidence = Evidence(
        term=term,
        coordinates=np.array([-0.5]),
        covariance=np.eye(1) * 1e-6,
        gain=90.0,
        share=0.5,
        distance=20.0,
    )
    named = Named(
        term=term,
        robots=(0,),
        whole_swarm=False,
        values=(Value("seconds", -0.5, -0.51, -0.49, "s"),),
        evidence=evidence,
        twins=(Term(LATENCY, ""),),
    )
    in_time = Shift(np.zeros(1), np.full(1, 1e-3))
    said = told_apart(
        named,
        (0,),
        in_time,
        Column(mean=0.0, sd=0.0, swarm_sd=0.0),
    )
    assert isinstance(said, Named)
    extension(Diagnosis(named=(said,)), log_hash="", command="")
    assert told_apart(named, (0,), in_time, None) is named
