"""How busy this machine's cores were, as the kernel counts it."""

from __future__ import annotations

import os
from pathlib import Path

STAT = Path("/proc/stat")


class Cores:
    """Measures the busy share of every core from its creation on."""

    def __init__(self) -> None:
        self._before = _times()

    def busy(self) -> list[float]:
        """Share of time each core was not idle since then; empty where the kernel does not say."""
        shares = []
        for core, (idle, total) in _times().items():
            was_idle, was_total = self._before.get(core, (idle, total))
            if total > was_total:
                shares.append(round(1.0 - (idle - was_idle) / (total - was_total), 4))
        return shares


def _times() -> dict[str, tuple[int, int]]:
    """Idle and total ticks of every core this process may use."""
    try:
        lines = STAT.read_text(encoding="ascii").splitlines()
    except OSError:
        return {}
    ours = {f"cpu{core}" for core in os.sched_getaffinity(0)}
    times = {}
    for line in lines:
        name, *ticks = line.split()
        if name in ours:
            counts = [int(tick) for tick in ticks[:8]]  # user .. steal; guests are within user
            times[name] = (counts[3] + counts[4], sum(counts))  # idle and waiting for a disk
    return times
