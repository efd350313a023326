"""The profile for bare viewers of a run with several balls: a cavity a ball, one above the other, on the same mass."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vines.logs._bare import Profile
from vines.logs._channels import BALLS

__all__ = ["profile_of_balls"]

_THICK = 0.16
"""From the end of the ball's way to the middle of the end of the cavity: the radius of the ball and half an end."""
_PITCH = -1.0
"""From one cavity to the next, upwards."""

_BOX = """    <visual><origin xyz="{x:g} 0 {z:g}"/><geometry><box size="{length:g} {width:g} {height:g}"/></geometry>
      <material name="{colour}"><color rgba="{rgba}"/></material></visual>
"""
_COLOURS = {
    "grey": "0.3 0.32 0.36 1",
    "left": "0.94 0.32 0.31 1",
    "right": "0.3 0.58 1 1",
    "floor": "0.84 0.86 0.9 1",
    "base": "0.43 0.78 0.55 1",
}
_BALL = """  <link name="ball_{number}"><visual><origin xyz="0 0 {z:g}"/><geometry><sphere radius="0.09"/></geometry>
    <material name="ball_{number}"><color rgba="1 0.78 0.24 1"/></material></visual></link>
"""
_JOINT = """  <joint name="{name}" type="prismatic"><parent link="rig"/><child link="{child}"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="0" velocity="0"/></joint>
"""

_ABOUT = """{name}: balls that fly freely, each in its own cavity of one shaken mass.
{parameters}

Lengths in b (half the reference cavity's free length), times in 1/omega0, shown as
seconds. Displacements are positive to the right; the gap of ball k is w = x1 - x2.
It touches the LEFT (red) end at w = +beta and the RIGHT (blue) end at w = -beta.

/curves   position: x1, x2 and w of each ball   velocity: v1, v2, w'
          effort: kinetic energy of mass and balls; at a gap that of its ball's weight
/state, /impact, /stick and /ball/k (vines.v1, protobuf) hold the run in full; their
schemas state every unit. https://github.com/foxglove/mcap reads them in many languages.
"""


def profile_of_balls(states: np.ndarray, parameters: Mapping[str, float]) -> Profile:
    """Return the profile of a run with several balls.

    Parameters
    ----------
    states : numpy.ndarray, structured
        Samples as `ball_rows` takes them.
    parameters : mapping of str to float
        Parameters of the system; half the length of a cavity is as far as the ball comes where there is none.
    """
    names = states.dtype.names or ()
    balls = [channel.key for channel in BALLS if f"x2_{channel.key}" in names]
    halves = {k: float(parameters.get(f"beta_{k}", np.abs(states[f"w_{k}"]).max(initial=0.0))) for k in balls}
    mount = -1.9 - max(halves.values())
    series = {"mass": ("x1", "v1", "kinetic_1")}
    series |= {f"ball {k}": (f"x2_{k}", f"v2_{k}", f"kinetic_2_{k}") for k in balls}
    series |= {f"gap {k}": (f"w_{k}", f"w_dot_{k}", f"potential_2_{k}") for k in balls}
    bodies = {"mass": "x1", **{f"ball_{k}": f"x2_{k}" for k in balls}, "base": "base"}
    return Profile(_geometry(list(halves.values()), balls, mount), _ABOUT, bodies, mount, series)


def _geometry(halves: list[float], balls: list[str], mount: float) -> str:
    """Return the URDF of the mass with its cavities, the balls, the base and what they stand on."""
    down = _PITCH * (len(halves) - 1)
    longest = max(halves)
    rig = _box("grey", (mount + longest + 1.0) / 2, down - 0.55, 2.0 * longest + 4.0, 1.0, 0.04)
    mass = ""
    for k, half in enumerate(halves):
        z, end = _PITCH * k + 0.0, half + _THICK
        mass += _box("left", -end, z, 0.14, 0.7, 0.7) + _box("right", end, z, 0.14, 0.7, 0.7)
        mass += _box("floor", 0.0, z - 0.4, 2.0 * end + 0.14, 0.7, 0.1)
    links = _link("rig", rig) + _link("mass", mass) + _link("base", _box("base", 0.0, down / 2, 0.1, 0.7, 0.9 - down))
    links += "".join(_BALL.format(number=ball, z=_PITCH * k + 0.0) for k, ball in enumerate(balls))
    moved = {"x1": "mass", **{f"x2_{ball}": f"ball_{ball}" for ball in balls}, "e": "base"}
    joints = "".join(_JOINT.format(name=name, child=child) for name, child in moved.items())
    return f'<robot name="vines">\n{links}{joints}</robot>\n'


def _link(name: str, visuals: str) -> str:
    return f'  <link name="{name}">\n{visuals}  </link>\n'


def _box(colour: str, x: float, z: float, length: float, width: float, height: float) -> str:
    rgba = _COLOURS[colour]
    return _BOX.format(colour=colour, rgba=rgba, x=x, z=z, length=length, width=width, height=height)
