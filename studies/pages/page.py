"""One self-contained HTML page: text, figures as inline images, tables; nothing is fetched.

The same sections as Markdown are for a document that holds them.

The first time that a page says a word of `glossary.md`, its meaning is there.
"""

from __future__ import annotations

import base64
import math
import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Literal

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
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


VERDICTS = ("holds", "does not hold", "no difference that matters", "open")
WIDTH = 110
"""Characters of a line of Markdown; our choice."""


@dataclass(frozen=True)
class Picture:
    """A figure already drawn."""

    path: Path
    """The PNG."""
    caption: str
    wide: bool = True
    """It takes the page's whole width; a phone scrolls it sideways, by itself."""

    @property
    def png(self) -> str:
        """Its bytes as base64."""
        return base64.b64encode(self.path.read_bytes()).decode("ascii")


@dataclass(frozen=True)
class Cell:
    """A table's cell and its style."""

    text: str
    kind: str


@dataclass(frozen=True)
class PageTable:
    """A table as text."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]

    @property
    def heads(self) -> Iterator[Cell]:
        """Headings, those of numbers aligned as these are."""
        for k, name in enumerate(self.columns):
            yield Cell(name, "number" if any(row[k].kind == "number" for row in self.rows) else "")

    @classmethod
    def of(cls, frame: pd.DataFrame) -> PageTable:
        """From a data frame; numbers to three digits, verdicts coloured."""
        rows = [[_cell(value) for value in row] for row in frame.itertuples(index=False)]
        return cls([str(name) for name in frame.columns], rows)


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it, in this order."""

    title: str
    texts: Sequence[str] = ()
    figures: Sequence[Picture] = ()
    tables: Sequence[PageTable] = field(default_factory=tuple)
    links: Sequence[tuple[str, str]] = ()
    """Files beside the page: name, and what is to be seen in it."""
    points: Sequence[str] = ()
    """Of a list."""
    commands: Sequence[str] = ()
    """To type."""
    folded: bool = False
    """Shown when it is clicked on, at the page's end; not printed."""


@dataclass(frozen=True)
class Box:
    """What a page says first, set apart."""

    tone: Literal["fault", "sound", "open"]
    """Its colour: something is wrong, nothing is, it is not known."""
    headline: str
    texts: Sequence[str] = ()
    code: str = ""
    """As it stands in a file."""


def write_page(path: Path, title: str, lead: str | Box, sections: Sequence[Section]) -> None:
    """Write the page: its words of the glossary explain themselves."""
    environment = Environment(
        loader=PackageLoader("realitygap.studies.pages", "."),
        autoescape=select_autoescape(default=True, default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["words"] = words = Words()
    page = environment.get_template("report.html.j2")
    text = page.render(title=title, lead=lead, sections=sections, said=words.said)
    path.write_text(text, encoding="utf-8")


def markdown(sections: Sequence[Section]) -> str:
    """Sections without their figures as Markdown, the same text and tables as on the page."""
    parts = []
    for section in sections:
        parts.append(f"## {section.title}")
        parts += [_filled(text) for text in section.texts]
        parts += [_markdown_table(table) for table in section.tables]
    return "\n\n".join(parts) + "\n"


def _filled(text: str) -> str:
    return textwrap.fill(text, WIDTH, break_long_words=False, break_on_hyphens=False)


def _markdown_table(table: PageTable) -> str:
    rows = [
        table.columns,
        ["---"] * len(table.columns),
        *([cell.text.replace("|", "\\|") for cell in row] for row in table.rows),
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def number(value: float) -> str:
    """Three digits, a dash for what does not exist, signs of infinity spelt."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def _cell(value: object) -> Cell:
    if isinstance(value, float):
        return Cell(number(value), "" if math.isnan(value) else "number")
    if isinstance(value, int):
        return Cell(str(value), "number")
    text = "–" if value is None or value is pd.NA else str(value)
    return Cell(text, text.replace(" ", "-") if text in VERDICTS else "")
