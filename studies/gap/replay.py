"""Replay: where a model says the robots of a log should have been."""

from __future__ import annotations

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.models.gap.believed import motions, replay_believed
from realitygap.models.gap.replay import CHANNELS, errors, windows
from realitygap.models.log.frames import Windows, motion, moved, wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.studies.inputs.logs import AnyLog, as_log
from realitygap.studies.inputs.model import AnyModel


def replay(log: AnyLog, *, model: AnyModel = None, horizon: float | None = None) -> pd.DataFrame:
    """Replay the log's commands through a model, from measured poses on.

    Args:
        log: A measured log or several, as `read_log` takes them.
        model: What is believed; that of the log, or the e-puck, if absent.
        horizon: s ahead that is predicted, from every measured pose; None: every stretch without
            gaps is predicted as a whole, from its first measured pose.

    Returns:
        A row per predicted moment that was measured too. Columns `run`, `robot`; `t_start`, `t`
        (s): when the prediction starts and ends; `x`, `y` (m), `yaw` (rad, in [-pi, pi)): the
        predicted pose; `along`, `across` (m) and `heading` (rad): measured less predicted, in the
        frame of the pose it starts from.

    Raises:
        InputError: the log or the model cannot be used, or no two poses are `horizon` apart.
        Diverged: the replay left the finite numbers.
    """
    if horizon is not None and not 0.0 < horizon < np.inf:
        raise InputError("horizon", horizon, "a number of seconds above 0, or None")
    read = as_log(log, model)
    measured = read.measured
    replayed = replay_believed(measured, motions(measured, read.model.file, read.model.label))
    pairs = _from_the_first(measured) if horizon is None else windows(measured, horizon)
    if not len(pairs.first):
        ahead = "" if horizon is None else f", {horizon:g} s apart"
        raise InputError("log", "no two tracked poses" + ahead, "at least one replayable stretch")
    predicted = moved(measured.poses[pairs.first], motion(replayed, pairs))
    frame, t = measured.frame, measured.t
    return pd.DataFrame(
        {
            "run": frame["run"].astype(str).to_numpy()[pairs.last],
            "robot": measured.robots[pairs.last],
            "t_start": t[pairs.first],
            "t": t[pairs.last],
            "x": predicted[:, 0],
            "y": predicted[:, 1],
            "yaw": wrapped(predicted[:, 2]),
            **dict(zip(CHANNELS, errors(measured.poses, replayed, pairs).T, strict=True)),
        }
    )


def _from_the_first(log: MeasuredLog) -> Windows:
    """From the first tracked row of every stretch to each later one."""
    tracked = np.flatnonzero(log.tracked)
    stretch = log.stretch[tracked]
    new = np.ones(len(stretch), dtype=bool)
    new[1:] = stretch[1:] != stretch[:-1]
    first = tracked[np.maximum.accumulate(np.where(new, np.arange(len(new)), 0))]
    return Windows(first[~new], tracked[~new])
