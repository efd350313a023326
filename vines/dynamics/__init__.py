"""Exact dynamics of the oscillator with a ball in its cavity.

Flight, impact and sticking in closed form, events found for certain, and what follows: samples, energy measures,
tangent maps. Importing this room loads numba but compiles nothing.
"""

from vines.dynamics._decay import Decay, decay
from vines.dynamics._ensemble import Ensemble, ensemble
from vines.dynamics._maps import P1, P2, P3, P4, Mapped, impact_map
from vines.dynamics._measures import Measures
from vines.dynamics._saltation import jacobian
from vines.dynamics._scatter import OrnsteinUhlenbeck, Scatter
from vines.dynamics._simulate import simulate
from vines.dynamics._tangent import lyapunov_spectrum, tangent_map
from vines.dynamics._trajectory import Trajectory
from vines.dynamics._warm_up import warm_up
from vines.dynamics._yardsticks import ball_locked, no_ball
from vines.kernels import CACHE

__all__ = [
    "CACHE",
    "P1",
    "P2",
    "P3",
    "P4",
    "Decay",
    "Ensemble",
    "Mapped",
    "Measures",
    "OrnsteinUhlenbeck",
    "Scatter",
    "Trajectory",
    "ball_locked",
    "decay",
    "ensemble",
    "impact_map",
    "jacobian",
    "lyapunov_spectrum",
    "no_ball",
    "simulate",
    "tangent_map",
    "warm_up",
]
