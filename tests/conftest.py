"""What holds for every test."""

from __future__ import annotations

import os
import signal

# Tests run side by side, a process for each core: threads of theirs would only wait for each other.
# Set before anything loads a library that reads it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# A busy machine is no broken connection.
os.environ.setdefault("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "300s")
os.environ.setdefault("DASK_DISTRIBUTED__COMM__TIMEOUTS__TCP", "300s")

from hypothesis import settings

# A shell lets what it runs in the background ignore interrupts, `nohup` hang-ups, and both every
# process started from it.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# How long one example takes says how busy the machine is, not whether the claim holds.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")
