"""Which study a command is about."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from vines.stages import Home

__all__ = ["the_study"]


def the_study() -> Home:
    """Return where the study lives that ``--root`` names, or that the current folder belongs to.

    Raises
    ------
    FileMissingError
        If there is no such folder.
    """
    from vines.stages import current

    root: Path | None = click.get_current_context().find_root().params.get("root")
    return current(root)
