"""Which impacts there were: what pulses, corners and flights show, tried against the fit."""

from vines.rig.impacts._oscillator import Response, measure_response
from vines.rig.impacts._pulses import pulses_of

__all__ = ["Response", "measure_response", "pulses_of"]
