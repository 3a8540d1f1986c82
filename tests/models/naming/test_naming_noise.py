"""What windows have of their own: learned from the log, and turned into independent rows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.columns import FREE
from realitygap.models.naming.channels.motion.noise import BEGIN, WIDE, Noise, Whitener, learn
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.rules import Rules
from tests.models.toys import tracks

RULES = Rules()
LENGTHS = (12, 5, 9)
"""Rows of windows that are of unlike length."""


def uneven(seed: int) -> tuple[Tracks, FloatArray, Noise]:
    """Windows, (n, 3, FREE + 2) columns of their own effects, and a noise of many sizes."""
    random = np.random.default_rng(seed)
    rows = sum(LENGTHS)
    first = np.cumsum([0, *LENGTHS[:-1]])
    cut = replace(tracks(1, 1, 30), rows=np.arange(rows), first=first)
    noise = Noise(
        random.uniform(0.3, 2.0, (rows, 3)),
        random.uniform(0.5, 2.0, len(LENGTHS)),
        np.append(np.full(FREE, 20.0), [0.7, 1.4]),
    )
    return cut, random.normal(size=(rows, 3, FREE + 2)), noise


def test_white_rows_are_independent_and_of_unit_variance() -> None:
    """Whatever windows, rows and effects weigh."""
    cut, z, noise = uneven(1)
    rows = 3 * len(cut.rows)
    covariance = np.diag(1.0 / noise.weight.ravel())
    for k, (begin, length) in enumerate(zip(cut.first, LENGTHS, strict=True)):
        part = slice(3 * begin, 3 * (begin + length))
        own = z.reshape(rows, -1)[part] * noise.spread
        own[:, FREE:] /= np.sqrt(noise.window[k])
        covariance[part, part] += own @ own.T
    turn = Whitener(cut, z, noise)(np.eye(rows).reshape(-1, 3, rows))
    some = np.abs(turn).sum(axis=1) > 0.0
    assert some.sum() == rows, "short windows are filled up with nothing"
    found = turn[some] @ covariance @ turn[some].T
    assert found == pytest.approx(np.eye(rows), abs=1e-7)


def test_where_a_window_lies_and_how_it_is_turned_says_nothing() -> None:
    cut, z, noise = uneven(2)
    noise = replace(noise, spread=np.append(np.full(FREE, np.sqrt(WIDE)), [0.7, 1.4]))
    random = np.random.default_rng(3)
    rows = random.normal(size=(len(cut.rows), 3, 1))
    own = random.normal(size=(len(LENGTHS), FREE))[cut.window]
    moved = rows + np.einsum("ncf,nf->nc", z[:, :, :FREE], own)[:, :, None]
    white = Whitener(cut, z, noise)
    assert white(moved) == pytest.approx(white(rows), abs=2e-3)
    assert np.abs(white(rows)).max() > 0.5


TRUE = np.array([0.8, 0.4])
"""rms noise: window effects of the simulated log."""
WINDOWS, ROWS = 600, 12


def simulated(
    seed: int, spread: FloatArray, *, cause: float = 0.0, noise: float = 1.0
) -> tuple[Tracks, Any]:
    """A robot whose windows and rows have Student-t effects, and one cause that it has or not."""
    random = np.random.default_rng(seed)
    cut = tracks(1, WINDOWS // 5, 5 * ROWS)
    n = len(cut.rows)
    z = random.normal(size=(n, 3, FREE + len(spread)))
    far = np.sqrt(random.chisquare(RULES.window_freedom, WINDOWS) / RULES.window_freedom)
    own = random.normal(size=(WINDOWS, len(spread))) * spread / far[:, None]
    free = 30.0 * random.normal(size=(WINDOWS, FREE))
    effects = np.hstack([free, own])[cut.window]
    x = random.normal(size=(n, 3, 1)) + z[:, :, [FREE]]
    errors = np.einsum("ncq,nq->nc", z, effects) + cause * x[:, :, 0]
    errors += noise * random.standard_t(RULES.row_freedom, (n, 3))
    return cut, SimpleNamespace(errors=errors, values=x, windows=z, linear=np.array([0]))


@pytest.mark.parametrize("cause", [0.0, 3.0])
def test_what_windows_have_of_their_own_is_learned_and_no_cause_is_taken_for_it(
    cause: float,
) -> None:
    """Of 600 windows a standard deviation is known to a twentieth: three times that."""
    cut, made = simulated(4, TRUE, cause=cause)
    (found,) = learn([cut], [made], RULES)
    assert found.spread[FREE:] == pytest.approx(TRUE, rel=0.15)
    size = np.sqrt((made.windows**2).mean(axis=(0, 1)))
    assert found.spread[:FREE] * size[:FREE] == pytest.approx(np.sqrt(WIDE))


def test_robots_of_one_log_have_one_spread_and_rows_of_their_own() -> None:
    logs = [simulated(5, TRUE), simulated(6, TRUE, noise=2.0)]
    one, other = learn([cut for cut, _ in logs], [made for _, made in logs], RULES)
    assert one.spread == pytest.approx(other.spread)
    assert one.spread[FREE:] == pytest.approx(TRUE, rel=0.15)
    ratio = np.median(one.weight) / np.median(other.weight)
    assert ratio == pytest.approx(4.0, rel=0.1)


def test_a_pushed_window_and_a_wild_row_count_less() -> None:
    cut, made = simulated(7, TRUE)
    made.errors[cut.window == 3] += 30.0 * made.windows[cut.window == 3][:, :, FREE]
    made.errors[500] += 40.0
    (found,) = learn([cut], [made], RULES)
    assert found.window[3] < 0.05 * np.median(found.window)
    assert found.weight[500].max() < 0.05 * np.median(found.weight)


def test_where_windows_have_nothing_of_their_own_little_is_learned() -> None:
    cut, made = simulated(8, 0.0 * TRUE)
    (found,) = learn([cut], [made], RULES)
    assert found.spread[FREE:].max() < 0.5 * BEGIN
