"""The oscillator's motion in closed form, by least squares at given impacts; what friction and the sensor add to it."""

from vines.rig.fit._bins import Bins, bins_of, sinhc
from vines.rig.fit._fitter import KEEP, LEAST, Fitter
from vines.rig.fit._jump_model import JumpModel, noise_of
from vines.rig.fit._jumps import JumpFit, Jumps
from vines.rig.fit._linearity import straight
from vines.rig.fit._motion import Motion, forced_response, free_part, root
from vines.rig.fit._normal_equations import TAIL
from vines.rig.fit._signal import Forced
from vines.rig.fit._sine_fit import SineFit, clumping, sine_fit
from vines.rig.fit._slide import Push, push, slide
from vines.rig.fit._train import U_PULSE, Train

__all__ = [
    "KEEP",
    "LEAST",
    "TAIL",
    "U_PULSE",
    "Bins",
    "Fitter",
    "Forced",
    "JumpFit",
    "JumpModel",
    "Jumps",
    "Motion",
    "Push",
    "SineFit",
    "Train",
    "bins_of",
    "clumping",
    "forced_response",
    "free_part",
    "noise_of",
    "push",
    "root",
    "sine_fit",
    "sinhc",
    "slide",
    "straight",
]
