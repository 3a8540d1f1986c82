"""What holds for every test."""

from __future__ import annotations

import signal

from hypothesis import settings

# A shell lets what it runs in the background ignore interrupts, and every process started from it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# How long one example takes says how busy the machine is, not whether the claim holds.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")
