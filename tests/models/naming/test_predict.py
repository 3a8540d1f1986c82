"""Where the tracker should have seen a robot whose marker is not where it should be."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import Drive
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.motion.predict import poses
from realitygap.models.naming.channels.motion.tracks import cut_tracks
from tests.models.small import driven_log

MODEL = read_model_file("epuck").model_copy(update={"arena": None})


def test_a_marker_ahead_and_to_the_left_is_seen_there_and_a_turned_one_turned() -> None:
    log = make_log(driven_log(1, robots=2, rows=300), drive=MODEL.motion().drive)
    cut = cut_tracks(log, MODEL)
    lever, turned = (0.02, 0.01), 0.3
    plain = poses(cut, [Motion(drive=Drive())] * 2)
    seen = poses(cut, [Motion(drive=Drive(), lever=lever, yaw_offset=turned)] * 2)
    for centre, marker in zip(plain, seen, strict=True):
        c, s = np.cos(centre[2]), np.sin(centre[2])
        expected = centre[:2] + np.array([[c, -s], [s, c]]) @ lever
        np.testing.assert_allclose(marker, [*expected, centre[2] + turned], atol=1e-12)
