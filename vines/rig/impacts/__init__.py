"""Which impacts there were: what pulses, corners and flights show, tried against the fit; what frames add."""

from vines.rig.impacts._oscillator import Response, measure_response
from vines.rig.impacts._pulses import find_pulses, pulses_of
from vines.rig.impacts._ringing import Mode, rung
from vines.rig.impacts._search import threshold
from vines.rig.impacts._undisturbed import still_rings, undisturbed, without_ringing

__all__ = [
    "Mode",
    "Response",
    "find_pulses",
    "measure_response",
    "pulses_of",
    "rung",
    "still_rings",
    "threshold",
    "undisturbed",
    "without_ringing",
]
