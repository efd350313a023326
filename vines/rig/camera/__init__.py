"""The ball as a camera or a second laser sees it: its flights, its clock, what it says beside what was inferred."""

from vines.rig.camera._alignment import Alignment, align
from vines.rig.camera._flights import Flights, find_flights
from vines.rig.camera._sight import Sight, see_ball
from vines.rig.camera._witness import Witness, witness

__all__ = ["Alignment", "Flights", "Sight", "Witness", "align", "find_flights", "see_ball", "witness"]
