"""What a reader must know beside a claim: what it owes to choices that were not the paper's."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Note:
    """Said once in full, and beside every claim it concerns by its label."""

    label: str
    text: str
    claims: tuple[str, ...]
    """Keys of the claims concerned."""


LAMP = Note(
    "lamp chosen for this order",
    "The paper gives no figure for its lamp. Ours fades at 0.8 m because ranges of 0.6 to 1 m gave "
    "the paper's order of conditions. That order is therefore no independent finding.",
    (
        *("no-light-worst", "two-best", "light-useful", "opposite-marginal", "negative-excels"),
        *("switches-below-fixed", "first-half-better", "balanced", "opposite-fails"),
        *("keeps-foraging-at-nest-to-opposite", "keeps-foraging-opposite-to-at-nest"),
        *("retrieval-falls-at-nest", "spread-grows-opposite-to-at-nest"),
    ),
)
MUTATION = Note(
    "s.d. 0.2, not 2",
    "S0 mutates with a standard deviation of 0.2; the paper prints 2, on genes of range 1. The "
    "literal reading has the printed one.",
    (
        *("two-best", "nest-converges-faster", "spread-falls-no-light", "spread-falls-at-nest"),
        *("spread-grows-opposite-to-at-nest", "mean-middle-no-light", "mean-middle-opposite"),
        *("no-light-converges", "opposite-fails", "nest-converges", "nest-mean-upper"),
        *("nest-positive", "search-evolves-no-light", "search-evolves-opposite"),
        *("first-half-opposite", "first-half-nest"),
        *("persists-at-nest-to-opposite", "persists-opposite-to-at-nest"),
    ),
)
POOLED = Note(
    "same first halves pooled",
    "Until the lamp moves, at nest → opposite is the same experiment as light at nest, and "
    "opposite → at nest the same as light opposite. Claims about the first half alone pool their "
    "runs.",
    ("nest-converges-faster", "first-half-opposite", "first-half-nest"),
)
NOTES = (LAMP, MUTATION, POOLED)


def labels(claim: str) -> list[str]:
    """Labels of the notes that stand beside a claim, given its key."""
    return [note.label for note in NOTES if claim in note.claims]
