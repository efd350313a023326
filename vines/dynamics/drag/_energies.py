"""Energies of a ball that is dragged: what base, damper, coil and impacts do."""

from __future__ import annotations

from vines.dynamics._integrals import segment_integrals
from vines.dynamics._totals import (
    add_segment,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    segment_state,
    stored_energy,
    window_totals,
)
from vines.dynamics._travel import add_travel, travel_integrals
from vines.dynamics.drag._constants import DragConstants

__all__: list[str] = []

for _name in (window_totals, ball_mass, base_at, event_loss, event_work, segment_state, stored_energy):
    _name.register(DragConstants)(_name.first)

segment_integrals.register(DragConstants)(travel_integrals)
add_segment.register(DragConstants)(add_travel)
