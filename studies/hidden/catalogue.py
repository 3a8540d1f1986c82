"""The catalogue of effects: how each is hidden in reality, and what the diagnosis calls it.

`realitygap effects --out docs/effects.md --force` writes the document.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from realitygap.embedded_sim.probes import PREFIX
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.senses import SenseCause
from realitygap.reality.effects import Effect, Key, catalogue
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.output import whole_file

KINDS = {
    "motion": "Motion",
    "infrared": "Infrared",
    "light": "Light",
    "task": "Task",
}
"""Kinds of effects and their headings, in this order."""

TITLE = "# The catalogue of effects"
INTRODUCTION = f"""{TITLE}

<!-- Written by `realitygap effects --out docs/effects.md --force`; edit the code alone. -->

What can be hidden in reality with
`realitygap run --effect NAME:key=value[,key=value...]` (repeatable), and what `realitygap diagnose`
may answer. Every effect acts in every physics engine (`--engine`). The two sides are written
independently: an effect changes the body, the motors, the optics or the clock of the physical
world, a cause is a term of the point model, and they meet only through measured numbers.

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
known, `studies/hidden/shares.py` turns what was hidden into these shares.

Some causes are tried on some logs only (`Cause.where`):

- `motor_gain` is asked for where encoders are and no healthy reference is: to poses alone it is a
  wheel of another radius.
- `slew_limit` is the term of `weak_motor` in its own unit, rad/s², for logs without a healthy
  reference. With one, a ramp is told as `weak_motor`: no log tells a motor's torque from a ramp of
  its controller.
- `slip` (`share`), `effective_axle` (`scale`) and `side_slip` (`seconds`) are of robots of skid
  steer, those whose model file says `drive_kind = "skid"`. The first two are the terms of
  `wheel_radius_scale` and `wheel_separation`, and stand in their place: of four wheels that scrub
  in every turn no log tells radius from slip. `side_slip` is how fast the body drifts out of a
  curve, per speed (m/s) and turn rate (rad/s). No body of the physical world has four wheels, so
  that none has an effect.
"""


@dataclass(frozen=True)
class CatalogueEntry:
    """One effect with both its sides."""

    effect: Effect
    keys: tuple[str, ...]
    """Every key with its unit, bounds, null and default."""
    cause: str
    """What the diagnosis calls it in words; empty: it has no such cause."""
    confusable_with: tuple[str, ...]
    experiment: str
    """Manoeuvre that shows it best."""


def entries(kind: str) -> Iterator[CatalogueEntry]:
    """The effects of a kind, in the order of the battery's menu, others last."""
    order = [*MENU, *(name for name in catalogue() if name not in MENU)]
    effects = [effect for effect in catalogue().values() if effect.kind == kind]
    for effect in sorted(effects, key=lambda e: order.index(e.name)):
        keys = tuple(key_text(name, p) for name, p in effect.parameters.items())
        known = every_cause().get(effect.name)
        if known is None:
            yield CatalogueEntry(effect, keys, "", (), "")
        else:
            seen = f"`{PREFIX}{known.experiment}`" if known.experiment else ""
            yield CatalogueEntry(effect, keys, known.meaning, known.confusable_with, seen)


def key_text(name: str, parameter: Key) -> str:
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


def effects(*, out: Path | str | None = None, force: bool = False) -> pd.DataFrame:
    """What can be hidden in reality, a row per effect.

    Args:
        out: File to write the catalogue into as well, as Markdown (docs/effects.md).
        force: Replace a catalogue that is there.

    Returns:
        Columns `effect`, `kind`, `place` (it belongs to the place and takes no robot), `keys` (a
        tuple: every key of a SPEC with its bounds, unit, null and default), `physics`, `cause`
        (what the diagnosis calls it; empty: its catalogue has no such cause), `confusable_with` (a
        tuple of names) and `experiment` (the manoeuvre that shows it best).

    Raises:
        InputError: `out` cannot be written.
    """
    rows = [
        {
            "effect": entry.effect.name,
            "kind": kind,
            "place": not entry.effect.per_robot,
            "keys": entry.keys,
            "physics": entry.effect.physics,
            "cause": entry.cause,
            "confusable_with": entry.confusable_with,
            "experiment": entry.experiment.strip("`"),
        }
        for kind in KINDS
        for entry in entries(kind)
    ]
    if out is not None:
        with whole_file(Path(out), force=force, ours=_is_catalogue) as part:
            part.write_text(document(), encoding="utf-8")
    return pd.DataFrame(rows)


def _is_catalogue(path: Path) -> bool:
    """Whether a file is one that was written here."""
    with path.open("rb") as file:
        return file.readline().decode(errors="replace").strip() == TITLE


def causes() -> pd.DataFrame:
    """What a diagnosis may name, a row per parameter of each cause; one without any has a row too.

    Columns `cause`, `meaning`, `place` (every robot has it or none), `word` (a further parameter
    that takes one of `words`), `parameter`, `unit`, `null` (value that changes nothing; may be
    infinite), `low`, `high` (bounds of what is believed), `named` (False: known, but not visible
    enough to be named), `confusable_with` (a tuple of names) and `experiment`.
    """
    rows = [
        {
            "cause": cause.name,
            "meaning": cause.meaning,
            "place": isinstance(cause, SenseCause) and cause.place,
            "word": cause.word,
            "words": cause.variants if cause.word else (),
            **{
                "parameter" if field == "name" else field: getattr(parameter, field, None)
                for field in ("name", "unit", "null", "low", "high")
            },
            "named": cause.identifiable,
            "confusable_with": cause.confusable_with,
            "experiment": f"{PREFIX}{cause.experiment}" if cause.experiment else "",
        }
        for cause in every_cause().values()
        for parameter in cause.parameters or (None,)
    ]
    return pd.DataFrame(rows)


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
