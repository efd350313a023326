"""Lists of what declarations may name, and the options of one."""

from __future__ import annotations

import json
from typing import Any

import click

__all__ = ["show_things"]


def show_things(what: str, found: list[dict[str, Any]] | dict[str, Any], as_json: bool) -> None:
    """Print all things with their summaries, or one with its options."""
    from vines.cli._layout import print_rows
    from vines.stages import default_shown

    if as_json:
        click.echo(json.dumps(found, indent=2))
        return
    if isinstance(found, list):
        rows = [[row["name"], row["summary"], row["package"]] for row in found]
        brought = any(row["package"] for row in found)
        head = [what, "what it does", "package"]
        print_rows(head if brought else head[:2], rows if brought else [row[:2] for row in rows], wrap=1)
        click.echo(f"\nvines {what}s {what.upper()} lists the options of one")
        return
    click.echo(f"{found['name']}: {found['summary']}\n\n{found['description']}\n")
    options = [[row["option"], row["type"], default_shown(row), row["meaning"]] for row in found["options"]]
    if options:
        print_rows(["option", "type", "default", "meaning"], options, wrap=3)
    else:
        click.echo("no options")
