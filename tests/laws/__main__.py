"""The battery of sealed laws.

    python -m tests.laws [SEED [ROBOTS [SECONDS [HEALTHY [ENGINE]]]]]

prints an answer a line as JSON, and the rates at the end.
"""

from __future__ import annotations

import json
import sys
import time

from typer import echo

from realitygap.reality.engine import DEFAULT, engine_name
from tests.laws.battery import answered, plan, rates, scored

seed, robots, seconds, healthy = (
    int(word) for word in [*sys.argv[1:5], *("1", "5", "120", "6")[len(sys.argv) - 1 :]]
)
answers = []
world = engine_name(sys.argv[5]) if len(sys.argv) > 5 else DEFAULT
for trial in plan(seed, healthy=healthy, robots=robots, seconds=seconds, engine=world):
    began = time.process_time()
    answers.append(scored(trial, answered(trial)))
    answers[-1]["cpu_s"] = round(time.process_time() - began, 1)
    echo(json.dumps(answers[-1], ensure_ascii=False))
for line in rates(answers):
    echo(line)
