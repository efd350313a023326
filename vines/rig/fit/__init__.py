"""The oscillator's motion in closed form, by least squares at given impacts; what friction and the sensor add to it."""

from vines.rig.fit._bins import Bins, bins_of, sinhc
from vines.rig.fit._fitter import KEEP, LEAST, Fitter
from vines.rig.fit._jumps import TAIL, JumpFit, Jumps, fit_jumps
from vines.rig.fit._linearity import straight
from vines.rig.fit._motion import Motion, forced_response, free_part, root
from vines.rig.fit._sine_fit import SineFit, clumping, sine_fit
from vines.rig.fit._slide import Push, slide

__all__ = [
    "KEEP",
    "LEAST",
    "TAIL",
    "Bins",
    "Fitter",
    "JumpFit",
    "Jumps",
    "Motion",
    "Push",
    "SineFit",
    "bins_of",
    "clumping",
    "fit_jumps",
    "forced_response",
    "free_part",
    "root",
    "sine_fit",
    "sinhc",
    "slide",
    "straight",
]
