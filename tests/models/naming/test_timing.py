"""Changes of a command that a log shows late, of one kind in one robot."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.motion.columns import FREE, columns
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.timing import KINDS, NAME, timed
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.weighed import Weighed
from tests.models.linear import nobody
from tests.models.small import driven_log

OPEN = read_model_file("epuck").model_copy(update={"arena": None})
MOTION = OPEN.motion()


def tracks_of(*, rows: int = 1500, every: int = 1) -> Tracks:
    """Of one robot, every so many rows."""
    frame = driven_log(
        3, robots=1, rows=rows, drive=MOTION.drive, position_noise=3e-4, heading_noise=3e-3
    )
    return cut_tracks(
        make_log(frame.iloc[::every].reset_index(drop=True), drive=MOTION.drive), OPEN
    )


def test_changes_of_all_kinds_that_are_late_are_commands_that_are_late() -> None:
    """Of wheels that follow at once, but for a change in a window's first row."""
    tracks = tracks_of()
    made = columns(tracks, [MOTION], tracks.commands)
    by_name = dict(zip(made.names, np.moveaxis(made.values, 2, 0), strict=True))
    own = [one for name, one in by_name.items() if name.startswith(f"{NAME}@")]
    late, kinds = by_name["clock_offset.seconds"].copy(), np.sum(own, axis=0)
    for window in np.split(np.arange(len(late)), tracks.first[1:]):  # place and heading are free
        free = made.windows[window, :, :FREE].reshape(-1, FREE)
        for one in (late, kinds):
            at = np.linalg.lstsq(free, one[window].ravel(), rcond=None)[0]
            one[window] -= (free @ at).reshape(-1, 3)
    changed = np.any(np.diff(tracks.commands, axis=0, prepend=np.nan) != 0.0, axis=1)
    inside = ~changed[tracks.rows[tracks.first]][tracks.window]
    late, kinds = late[inside], kinds[inside]
    assert np.corrcoef(late.ravel(), kinds.ravel())[0, 1] > 0.97
    assert np.std(kinds) == pytest.approx(np.std(late), rel=0.1)


def test_a_log_that_misses_rows_shows_that_changes_scatter() -> None:
    whole, half = (robots_of(tracks_of(rows=3000, every=n), [MOTION])[0] for n in (1, 3))
    assert whole.scatter < 2e-3
    assert 5e-3 < half.scatter < 0.05, "rows of 120 ms show changes up to 80 ms late"


def test_what_scatters_is_a_difference_that_sound_robots_may_have() -> None:
    """A robot whose changes of one kind are late is then less far from the others."""
    tracks = tracks_of()
    robots = tuple(robots_of(tracks, [MOTION]))
    between = timed(robots[0].names, 0.013)
    assert len(between) == len(KINDS) == 8
    k = robots[0].names.index(f"{NAME}@-1+1")
    sizes = [
        Weighed(State(tracks, (MOTION,), robots, nobody(), between=some)).score(0).information[k, k]
        for some in ({}, between)
    ]
    assert sizes[1] < sizes[0]
    assert sizes[1] <= 1.0 / 0.013**2
