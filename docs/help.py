"""What the site adds to its documents: the help of every command, as the command line prints it."""

from __future__ import annotations

from typing import Any

from typer import Context
from typer.main import get_command

from realitygap.studies.cli import app

MARK = "<!-- help -->"
"""Of `commands.md`: where it goes."""


def on_page_markdown(markdown: str, **_: Any) -> str:
    """A page's text with the help in it."""
    return markdown.replace(MARK, every_help()) if MARK in markdown else markdown


def every_help() -> str:
    """A heading and a block for every command, those of a group after it."""
    group = get_command(app)
    return "\n".join(_helps(group, Context(group, info_name="realitygap")))


def _helps(command: Any, context: Any) -> list[str]:
    if not hasattr(command, "list_commands"):
        usage = context.get_usage()
        rows = [one.get_help_record(context) for one in command.get_params(context)]
        told = [f"| `{name}` | {text} |" for name, text in filter(None, rows)]
        table = ["| option | does |", "|---|---|", *told, ""]
        about = (command.help or "").strip()
        return [f"## `{context.command_path}`", "", about, "", f"    {usage}", "", *table]
    found = []
    for name in command.list_commands(context):
        inner = command.get_command(context, name)
        found += _helps(inner, context.__class__(inner, info_name=name, parent=context))
    return found
