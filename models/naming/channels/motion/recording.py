"""How a log was recorded: what lies between the robots and its rows, the same for all of them.

Commands merged onto the tracker's rows are early or late by up to a row; a log with fewer rows than
the robots had commands smears every change of them; a tracker that averages does so too; two clocks
run at different rates; a tracker's metre is not everybody's. None of this is a robot's fault. It is
fitted to all robots of a log together, before anything is asked of one of them, and believed to be
no better known than the log can tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.cause import ALL, Cause, Parameter
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.rules import Rules

NAME = "recording"
TRANSIENT = "transient"
"""The family of causes that show where commands change;"""
DELAYS = ("clock_offset", "command_latency")
"""those among them that are a delay and nothing else: the recording has one of its own."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    delay, rate, smear, scale, *lag = (float(v) for v in values)
    return replace(
        motion,
        pose_delay=motion.pose_delay + delay,
        clock_rate=motion.clock_rate + rate,
        smear=motion.smear + smear,
        pose_scale=motion.pose_scale * scale,
        pose_lag=motion.pose_lag + sum(lag),
    )


def recording(step: float, rules: Rules, *, filtered: bool = False) -> Cause:
    """What may lie between robots and rows that come every `step` seconds.

    Commands are merged by at most a row early or late; more than that is a cause. The other bounds
    are rules. Poses whose noise hangs together may have gone through a causal filter.
    """
    most = rules.record_rows * step
    lag = Parameter(name="lag", unit="s", null=0.0, low=0.0, high=most, step=1e-3)
    rate, scale = rules.record_rate_most, rules.record_scale_most
    smear = (rules.record_rows * step) ** 2
    return Cause(
        name=NAME,
        meaning="how the log was recorded",
        parameters=(
            Parameter(name="delay", unit="s", null=0.0, low=-step, high=step, step=1e-3),
            Parameter(name="rate", unit="1", null=0.0, low=-rate, high=rate, step=1e-5),
            Parameter(name="smear", unit="s^2", null=0.0, low=-1e-4, high=smear, step=1e-5),
            Parameter(
                name="scale",
                unit="1",
                null=1.0,
                low=1.0 - scale,
                high=1.0 + scale,
                step=1e-4,
                link="factor",
            ),
            *((lag,) if filtered else ()),
        ),
        change=_change,
        variants=(ALL,),
    )


def unsure(step: float, names: Sequence[str], rules: Rules) -> dict[str, float]:
    """By name of a column, the standard deviation with which it is believed to be null.

    Where in its row a command began to hold nobody knows. That delays and smears what all robots
    do, and makes their motors look slower or their wheels slip by up to as much.

    Args:
        step: s between rows.
        names: Of the columns that there are.
        rules: How sure one is.
    """
    spread = {
        "delay": step,
        "rate": rules.record_rate,
        "smear": step**2,
        "scale": rules.record_scale,
        "lag": step,
    }
    found = {f"{NAME}@{name}": sd for name, sd in spread.items()}
    for name in names:
        key, _, dose = name.partition("@")
        key, _, parameter = key.partition(".")
        cause = causes().get(key.partition("/")[0])
        if cause is None or cause.family != TRANSIENT or cause.name in DELAYS:
            continue
        if any(p.unit == "s" and (dose or p.name == parameter) for p in cause.parameters):
            found[name] = 0.5 * step / (float(dose) if dose else 1.0)
        else:
            found[name] = rules.record_dose
    return found
