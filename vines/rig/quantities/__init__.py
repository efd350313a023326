"""From a recording to the quantities of the model, with uncertainties, pattern and gates."""

from vines.rig.quantities._budget import SOURCES
from vines.rig.quantities._cycle import Slots, Track, matching, mean_cycle, slots
from vines.rig.quantities._dwells import Dwell, dwells, envelope
from vines.rig.quantities._forcing import measure_base
from vines.rig.quantities._match_ring_downs import match_ring_downs
from vines.rig.quantities._pattern import HOLDS, Pattern, Periods, cut_into_periods, find_pattern
from vines.rig.quantities._reconstruct import reconstruct
from vines.rig.quantities._reconstruction import IMPACT, NOTED, QUANTITIES, Finding, Reconstruction
from vines.rig.quantities._ring_down import RingDown, ring_down

__all__ = [
    "HOLDS",
    "IMPACT",
    "NOTED",
    "QUANTITIES",
    "SOURCES",
    "Dwell",
    "Finding",
    "Pattern",
    "Periods",
    "Reconstruction",
    "RingDown",
    "Slots",
    "Track",
    "cut_into_periods",
    "dwells",
    "envelope",
    "find_pattern",
    "match_ring_downs",
    "matching",
    "mean_cycle",
    "measure_base",
    "reconstruct",
    "ring_down",
    "slots",
]
