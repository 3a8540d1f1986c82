"""A few kills of every command; `make kills` does more."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.helpers import ROOT
from tests.kills import KINDS


@pytest.mark.slow
def test_killed_commands_leave_nothing_and_come_to_the_same_bytes() -> None:
    counts = [f"{kind.name}=3" for kind in KINDS]
    done = subprocess.run(
        [sys.executable, "-m", "tests.kills", "--seed", "7", "--kills", *counts],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
