"""Which impacts there were: what pulses, corners and flights show, tried against the fit."""

from vines.rig.impacts._oscillator import Response, measure_response
from vines.rig.impacts._pulses import find_pulses, pulses_of
from vines.rig.impacts._search import threshold

__all__ = ["Response", "find_pulses", "measure_response", "pulses_of", "threshold"]
