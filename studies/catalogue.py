"""The catalogue of effects: how each is hidden in reality, and what the diagnosis calls it.

`python -m realitygap.studies.catalogue docs/effects.md` writes the document.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from realitygap.embedded_sim.probes import PREFIX
from realitygap.models.catalogue import every_cause
from realitygap.reality.effects import Effect, Parameter, catalogue
from realitygap.studies.blind.menu import MENU

KINDS = {
    "motion": "Motion",
    "infrared": "Infrared",
    "light": "Light",
    "task": "Task",
}
"""Kinds of effects and their headings, in this order."""

INTRODUCTION = """# The catalogue of effects

<!-- Written by `python -m realitygap.studies.catalogue docs/effects.md`; edit the code alone. -->

What can be hidden in the pybullet world with
`realitygap run --effect NAME:key=value[,key=value...]` (repeatable), and what `realitygap diagnose`
may answer. The two sides are written independently: an effect changes the body, the motors, the
optics or the clock of the physical world, a cause is a term of the point model, and they meet only
through measured numbers.

`robot=K`, any number of times, limits an effect to some robots; without it the whole swarm has it.
Lamps, walls and the floor belong to the place and take no `robot`. Brackets hold the bounds of a
value, `null` is the value that changes nothing, and a key with a default may be left out. The last
column names a manoeuvre of `realitygap run --controller probe:NAME` ([menu](next-experiment.md)).

A cause is told in the unit of its effect, but for two. No log tells newton metres or a coefficient
of friction, and no constant of the physical world is known to the diagnosis. What shows is how fast
wheels change speed, and a healthy reference says how fast sound wheels do:

- `weak_motor` tells `torque` as a share of a healthy motor's: acceleration grows in step with it.
- `low_friction` tells `friction` as the share of the healthy acceleration at which wheels begin to
  slip. A healthy robot's motors do not make its wheels slip: how much grip is to spare is unknown.
  So the share is at most 1, and is no ratio of coefficients of friction.

`healthy_acceleration` (rad/s²), which both are shares of, stands beside them. Without a reference
nothing is a share of anything: neither is named, and the diagnosis says so. Where the truth is
known, `studies/shares.py` turns what was hidden into these shares.
"""


@dataclass(frozen=True)
class Entry:
    """One effect with both its sides."""

    effect: Effect
    keys: tuple[str, ...]
    """Every key with its unit, bounds, null and default."""
    cause: str
    """What the diagnosis calls it in words; empty: it has no such cause."""
    confusable_with: tuple[str, ...]
    experiment: str
    """Manoeuvre that shows it best."""


def entries(kind: str) -> Iterator[Entry]:
    """The effects of a kind, in the order of the battery's menu."""
    order = list(MENU)
    effects = [effect for effect in catalogue().values() if effect.kind == kind]
    for effect in sorted(effects, key=lambda e: order.index(e.name)):
        keys = tuple(key_text(name, p) for name, p in effect.parameters.items())
        known = every_cause().get(effect.name)
        if known is None:
            yield Entry(effect, keys, "", (), "")
        else:
            seen = f"`{PREFIX}{known.experiment}`" if known.experiment else ""
            yield Entry(effect, keys, known.meaning, known.confusable_with, seen)


def key_text(name: str, parameter: Parameter) -> str:
    """A key as a reader of `--effect` needs it."""
    if parameter.words:
        text = f"{name}: {' | '.join(parameter.words)}"
        return text if parameter.default is None else f"{text} (default {parameter.default})"
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    notes = [] if parameter.null is None else [f"null {parameter.null:.4g}"]
    if parameter.default is not None:
        notes.append(f"default {parameter.default}")
    tail = f" ({', '.join(notes)})" if notes else ""
    return f"{name}: [{parameter.low:.4g}, {parameter.high:.4g}]{unit}{tail}"


def document() -> str:
    """The catalogue as Markdown."""
    lines = [INTRODUCTION]
    for kind, heading in KINDS.items():
        lines += [
            f"## {heading}\n",
            "| effect | keys | what is physically changed | what the diagnosis says "
            "| confusable with | seen best by |",
            "|---|---|---|---|---|---|",
        ]
        for entry in entries(kind):
            effect = entry.effect
            place = "" if effect.per_robot else " (place)"
            keys = "<br>".join(f"`{key}`" for key in entry.keys).replace("|", "\\|")
            rivals = ", ".join(f"`{name}`" for name in entry.confusable_with) or "–"
            cells = (entry.cause or "not in its catalogue", rivals, entry.experiment or "–")
            lines.append(
                f"| `{effect.name}`{place} | {keys} | {effect.physics} | {' | '.join(cells)} |"
            )
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(document(), encoding="utf-8")
