"""The glossary on a page: the first time that a page says one of its words, its meaning is there.

`glossary.md` is that of the documents, as it is installed.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import resources

from markupsafe import Markup, escape

ROW = re.compile(r"^\| ([^|]+?) \| ([^|]+?) \|", re.MULTILINE)
"""Of the tables: a word, its meaning."""
ORDINARY = ("bar", "column", "course", "frame", "map", "memory", "part", "place", "row")
"""Words that a page says in their everyday meaning, too."""


@cache
def meanings() -> dict[str, str]:
    """By word; what needs a bracket to be told from another ("gain (of naming)") is left out."""
    text = (resources.files(__package__) / "glossary.md").read_text(encoding="utf-8")
    found: dict[str, str] = {}
    for words, meaning in ROW.findall(text):
        if words != "word" and "(" not in words and not words.startswith("---"):
            found |= dict.fromkeys(words.split(", "), meaning)
    plain = {word: meaning.replace("`", "") for word, meaning in found.items()}
    return {word: meaning for word, meaning in plain.items() if word not in ORDINARY}


class Words:
    """Marks the words of the glossary in the texts of one page, each once."""

    def __init__(self) -> None:
        self.said: dict[str, str] = {}
        """The words that the page has said so far, with their meanings."""
        longest = sorted(meanings(), key=lambda word: (-len(word), word))
        self._any = re.compile(rf"\b({'|'.join(map(re.escape, longest))})(?=s?\b)", re.IGNORECASE)

    def __call__(self, text: str) -> Markup:
        """The text, escaped, as HTML."""
        parts = self._any.split(str(text))
        return Markup().join(
            self._marked(part) if k % 2 else escape(part) for k, part in enumerate(parts)
        )

    def _marked(self, part: str) -> Markup:
        word = part.lower()
        if word in self.said:
            return escape(part)
        self.said[word] = meanings()[word]
        return Markup('<abbr title="{}" tabindex="0">{}</abbr>').format(self.said[word], part)
