"""One oscillator with a ball that a coil drags along as it flies; docs/dynamics.md, "A ball that is dragged"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vines.dynamics._room import Room
from vines.dynamics.drag import _energies as _energies
from vines.dynamics.drag import _tangent as _tangent
from vines.dynamics.drag._constants import DragConstants, DragTable, drag_constants

__all__ = ["ROOM", "DragConstants"]


class _Drag(Room):
    def constants(self, values: Sequence[float]) -> DragConstants:
        return drag_constants(*values)

    def table(self, points: list[list[float]]) -> DragTable:
        return DragTable(self.constants(points[0]))

    def conserves(self, p: Any) -> bool:
        return p.delta == 0.0 and super().conserves(p)


ROOM = _Drag()
