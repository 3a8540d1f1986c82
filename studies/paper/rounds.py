"""Runs are added in batches, only to conditions whose claims are open, until nothing is.

The default reading and the mixtures come first, then the literal reading, no selection, and other
lamps. What is done next follows from the runs that are there, so a resumed study goes the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import pandas as pd

from realitygap.studies.pages.page import number
from realitygap.studies.paper.claims import CLAIMS, PAPERS
from realitygap.studies.paper.conditions import (
    SIZED,
    STUDIED,
    Condition,
    PlannedRun,
    StudyConfig,
    plan,
)
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.execution import execute, run_files
from realitygap.studies.paper.our_claims import NUMBER, SELECTION
from realitygap.studies.paper.readings import (
    DEFAULT,
    LAMPS,
    LITERAL,
    NEUTRAL,
    conditions_of,
    of_variant,
)
from realitygap.studies.paper.sequential import looks
from realitygap.studies.paper.tables import Known, StudyTables, collect
from realitygap.studies.paper.verdicts import OPEN, decide, still_open
from realitygap.studies.paper.weighing import Claim
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.progress import Shown

SELECTED, NUMBERED = "selection", "number"
"""What is decided across variants, by the family of its claims."""
DECIDED = (DEFAULT, LITERAL, NEUTRAL, SELECTED, *LAMPS, NUMBERED)
"""Variants, and what compares them, in the order in which they are decided."""

Directory = StudyDirectory[StudyConfig, PlannedRun]


def claims_of(variant: str) -> tuple[Claim, ...]:
    """What a variant decides: the mixtures are asked about once."""
    return {DEFAULT: CLAIMS, SELECTED: SELECTION, NUMBERED: NUMBER}.get(variant, PAPERS)


def studied_in(variant: str) -> tuple[Condition, ...]:
    """A variant's own conditions."""
    own = {DEFAULT: STUDIED, SELECTED: (), NUMBERED: SIZED}
    return own[variant] if variant in own else conditions_of(variant)


def tables_of(tables: StudyTables, variant: str) -> StudyTables:
    """What a variant's claims are weighed on: its tables, or all."""
    return tables if variant in (SELECTED, NUMBERED) else of_variant(tables, variant)


def grown(
    runs: Mapping[str, int],
    conditions: Mapping[str, Condition],
    claims: Sequence[Claim],
    batch: int,
) -> dict[str, int]:
    """How many runs each condition has when the open claims have got one batch more.

    Args:
        runs: By key of condition, so far.
        conditions: By name: where a variant has one of its own, that, else the default's.
        claims: Those that are open.
        batch: Runs that are added.

    Returns:
        As `runs`: of an open claim's conditions those with fewest runs have a batch more, unless
        they have all that may be spent.
    """
    more = dict(runs)
    for claim in claims:
        keys = {conditions[name].key for name in claim.conditions}
        fewest = min(runs[key] for key in keys)
        if fewest + batch <= looks(batch)[-1]:
            more |= {key: fewest + batch for key in keys if runs[key] == fewest}
    return more


@dataclass
class Rounds:
    """The rounds of one study."""

    directory: Directory
    workers: Workers
    report: Callable[[Directory], object]
    """Makes tables, figures and page of what is there: after every round that ran anything."""
    quiet: bool
    known: Known = field(default_factory=dict)
    runs: dict[str, int] = field(default_factory=dict)
    """So far, by key of condition."""

    def finish(self) -> None:
        """Do every round that is missing.

        Raises:
            RunsFailed: some runs raised; the others are kept.
            WorkersLost: workers keep dying.
        """
        for variant in DECIDED:
            wanted = self.runs | {one.key: self._batch for one in studied_in(variant)}
            tables = self._run(wanted)
            while True:
                found = decide(tables_of(tables, variant), self._batch, claims_of(variant))
                self._say(variant, found)
                left = still_open(found, claims_of(variant))
                wanted = grown(self.runs, self.at_hand(variant), left, self._batch)
                if wanted == self.runs:
                    break
                tables = self._run(wanted)

    def at_hand(self, variant: str) -> dict[str, Condition]:
        """What a variant's claims mean by the name of a condition."""
        every = {one.key: one for one in self.conditions}
        if variant in (SELECTED, NUMBERED):
            return every
        return every | {one.name: one for one in studied_in(variant)}

    @property
    def conditions(self) -> list[Condition]:
        """All that have runs, in the order in which they came in."""
        return [one for name in DECIDED for one in studied_in(name) if one.key in self.runs]

    @property
    def _batch(self) -> int:
        return self.directory.study.runs

    def _run(self, wanted: dict[str, int]) -> StudyTables:
        """Do the runs that are missing; all that are there."""
        self.runs = wanted
        self.directory.widen(plan(self.directory.study, self.conditions, wanted))
        if self.directory.pending():
            execute(self.directory, self.workers, run_files, quiet=self.quiet)
            self.report(self.directory)
        return collect(self.directory, self.known)

    def _say(self, variant: str, found: pd.DataFrame) -> None:
        """How many claims are decided, which are open, and how wide intervals still are."""
        with Shown("claims", None, (), quiet=self.quiet) as shown:
            left = found[found["verdict"] == OPEN]
            shown.say(f"{variant}: {len(found) - len(left)} of {len(found)} claims are decided")
            for row in left.to_dict("records"):
                shown.say(
                    f"  open: {row['claim']}, {number(row['effect'])} ({number(row['low'])} to "
                    f"{number(row['high'])}) of {row['runs']} runs, at {row['bound']:.2f} s.e."
                )


def verdicts_by_variant(tables: StudyTables, batch: int) -> dict[str, pd.DataFrame]:
    """The claims tables of all that has runs."""
    there = set(tables.runs["variant"])
    needed = {SELECTED: NEUTRAL, NUMBERED: SIZED[0].variant}
    return {
        variant: decide(tables_of(tables, variant), batch, claims_of(variant))
        for variant in DECIDED
        if needed.get(variant, variant) in there
    }
