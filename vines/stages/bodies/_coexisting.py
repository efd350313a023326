"""Rows of the attractors that coexist at a point."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from vines.attractors import Attractor, share_error
from vines.stages.bodies._rows import outline

__all__ = ["attractor_rows"]


def attractor_rows(
    point_id: str,
    found: list[tuple[Attractor, int]],
    random: int,
    told: Callable[[Attractor], dict[str, Any]] = outline,
) -> list[dict[str, Any]]:
    """Return rows of the table ``attractors`` with what is told of each; shares are null where no start was drawn."""
    rows = []
    for k, (attractor, count) in enumerate(found):
        share = count / random if random else None
        rows.append(
            {
                "point_id": point_id,
                **attractor.params.as_dict(),
                "attractor": k,
                "fraction": share,
                "fraction_error": share_error(share, random) if share is not None else None,
                **told(attractor),
            }
        )
    return rows
