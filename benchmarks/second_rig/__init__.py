"""A second synthetic rig, in another formulation than `vines.rig.synth`, with what real rigs do and the model doesn't.

Shaker table, oscillator, ball and the ball's spin are integrated together by an adaptive Runge-Kutta pair with the
contact as a spring and dashpot (`_integrator`); each effect has a strength (`SecondRig`). It shares no equation with
the catalogue, and no code of physics or instruments with the first rig.
"""

from benchmarks.second_rig._record import record, write
from benchmarks.second_rig._settings import HARMLESS, PHYSICS, SecondRig, draw_rig, rest_of

__all__ = ["HARMLESS", "PHYSICS", "SecondRig", "draw_rig", "record", "rest_of", "write"]
