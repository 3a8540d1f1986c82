"""The numbers that naming was tuned to, as a table and as a document.

`realitygap rules --out docs/rules.md --force` writes the document.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from realitygap.models.naming.rules import Rules, listed
from realitygap.studies.plumbing.output import whole_file

TITLE = "# The rules of naming"
INTRODUCTION = f"""{TITLE}

<!-- Written by `realitygap rules --out docs/rules.md --force`; edit the code alone. -->

Every number that naming was tuned to, in the order in which a log meets them. They are the fields
of `realitygap.Rules`. `rg.diagnose(log, rules=rg.Rules(price=8.0))` diagnoses by others, and
`diagnosis.json` then says which. What is no rule (tolerances and limits of iterations, constants of
statistics and of sensors) stands where it is used. Motion and the senses go by the same rules.

*Deviance* is -2 log likelihood; *our choice* means that no measurement of it is kept.
"""


def rules(
    of: Rules = Rules(), *, out: Path | str | None = None, force: bool = False
) -> pd.DataFrame:
    """Every number that naming was tuned to, a row each.

    Args:
        of: Which; the shipped ones if absent.
        out: File to write them into as well, as Markdown (docs/rules.md).
        force: Replace a file of rules that is there.

    Returns:
        Columns `rule` (a field of `Rules`), `value`, `unit`, `reason` and `origin` (measured on
        what, derived from what, or our choice).

    Raises:
        InputError: `out` cannot be written.
    """
    table = pd.DataFrame(list(listed(of))).rename(columns={"name": "rule"})
    if out is not None:
        with whole_file(Path(out), force=force, ours=_is_document) as part:
            part.write_text(document(of), encoding="utf-8")
    return table


def document(of: Rules) -> str:
    """The rules as Markdown."""
    lines = [INTRODUCTION, "| rule | value | unit | reason | origin |", "|---|---|---|---|---|"]
    lines += [
        f"| `{one.name}` | {one.value:.4g} | {one.unit} | {one.reason} | {one.origin} |"
        for one in listed(of)
    ]
    return "\n".join(lines) + "\n"


def changed(of: Rules) -> dict[str, float]:
    """Those that are not the shipped ones, by name."""
    shipped = Rules()
    return {n.name: n.value for n in listed(of) if n.value != getattr(shipped, n.name)}


def _is_document(path: Path) -> bool:
    """Whether a file is one that was written here."""
    with path.open("rb") as file:
        return file.readline().decode(errors="replace").strip() == TITLE
