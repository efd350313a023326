"""Which impacts there were: what pulses, corners and flights show, tried against the fit; what frames add."""

from vines.rig.impacts._oscillator import Response, measure_response
from vines.rig.impacts._pulses import pulses_of
from vines.rig.impacts._ringing import Mode
from vines.rig.impacts._undisturbed import undisturbed

__all__ = ["Mode", "Response", "measure_response", "pulses_of", "undisturbed"]
