"""The profile with which a log explains itself: channels that viewers understand without vines.

Opened in a bare Rerun, a log shows the moving cavity and ball in 3-D, curves, and the impacts in words. Four channels
do that: a robot description with the geometry (URDF), transforms that move it (foxglove.FrameTransforms), curves
(sensor_msgs/JointState) and lines of a log (foxglove.Log). They hold nothing that the channels of vines do not, in
single precision and at fewer times, so they can be left out.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from xml.sax.saxutils import escape

import numpy as np

from vines.logs._channels import Channel, Rows, log_times
from vines.logs._form import ROS_LATEST, Form, stamps
from vines.model import VI_NES
from vines.schema import WireFormat, foxglove_schema

__all__ = ["BARE", "BESIDE", "Profile", "bare_rows", "more_rows"]

_STRIDE = 3
"""Of the states in smooth motion, one in so many."""
_VIEW = "tf#/"
"""The frame in which Rerun's 3-D view looks when nobody has told it another."""

_WORDS = 96
"""Bytes of a line about an impact in a log that is being written, where the longest is not known."""

_JOINT_STATE = b"""std_msgs/Header header

string[] name
float64[] position
float64[] velocity
float64[] effort

================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id

================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""

_GEOMETRY = """<robot name="vines">
  <link name="rig"><visual><origin xyz="-0.4 0 -0.55"/><geometry><box size="6 1 0.04"/></geometry>
    <material name="grey"><color rgba="0.3 0.32 0.36 1"/></material></visual></link>
  <link name="mass">
    <visual><origin xyz="-1.16 0 0"/><geometry><box size="0.14 0.7 0.7"/></geometry>
      <material name="left"><color rgba="0.94 0.32 0.31 1"/></material></visual>
    <visual><origin xyz="1.16 0 0"/><geometry><box size="0.14 0.7 0.7"/></geometry>
      <material name="right"><color rgba="0.3 0.58 1 1"/></material></visual>
    <visual><origin xyz="0 0 -0.4"/><geometry><box size="2.46 0.7 0.1"/></geometry>
      <material name="floor"><color rgba="0.84 0.86 0.9 1"/></material></visual>
  </link>
  <link name="ball"><visual><geometry><sphere radius="0.09"/></geometry>
    <material name="ball"><color rgba="1 0.78 0.24 1"/></material></visual></link>
  <link name="base"><visual><geometry><box size="0.1 0.7 0.9"/></geometry>
    <material name="base"><color rgba="0.43 0.78 0.55 1"/></material></visual></link>
  <joint name="x1" type="prismatic"><parent link="rig"/><child link="mass"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="0" velocity="0"/></joint>
  <joint name="x2" type="prismatic"><parent link="rig"/><child link="ball"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="0" velocity="0"/></joint>
  <joint name="e" type="prismatic"><parent link="rig"/><child link="base"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="0" velocity="0"/></joint>
</robot>
"""

_ABOUT = """{name}: a ball that flies freely in the cavity of a shaken mass.
{parameters}

Lengths in b (half the cavity's free length), times in 1/omega0, shown as seconds.
Displacements are positive to the right; the gap is w = x1 - x2. The ball touches
the LEFT (red) end at w = +1 and the RIGHT (blue) end at w = -1.

/curves   position: x1, x2, w   velocity: v1, v2, w'
          effort: kinetic energy of mass and ball, energy of the spring
/state, /impact, /stick (vines.v1, protobuf) hold the run in full; their schemas
state every unit. https://github.com/foxglove/mcap reads them in many languages.
"""


@dataclass(frozen=True)
class Profile:
    """What the profile shows of a run.

    Attributes
    ----------
    geometry, about : str
        The bodies, and what the log is, with room for `name` and `parameters`.
    bodies : mapping of str to str
        Columns of the places of bodies.
    mount : float
        Where the shaken base is drawn; only its displacement is to scale.
    series : mapping of str to tuple of str
        Columns shown as position, velocity and effort of each curve; ``""`` is nothing, 0.
    """

    geometry: str
    about: str
    bodies: Mapping[str, str]
    mount: float
    series: Mapping[str, tuple[str, str, str]]


def _foxglove(number: int, topic: str, message: str) -> Channel:
    return Channel(number, topic, f"foxglove.{message}", "", topic, schema=("protobuf", foxglove_schema()))


def _ros(number: int, topic: str, message: str, definition: bytes) -> Channel:
    return Channel(number, topic, message, "", topic, schema=("ros2msg", definition), encoding="cdr")


_MODEL = _ros(20, "/robot_description", "std_msgs/msg/String", b"string data")
_PLACED = _foxglove(21, "/tf_static", "FrameTransforms")
_MOVED = _foxglove(22, "/tf", "FrameTransforms")
_CURVES = _ros(23, "/curves", "sensor_msgs/msg/JointState", _JOINT_STATE)
_TOLD = _foxglove(24, "/impact_log", "Log")
BARE = (_MODEL, _PLACED, _MOVED, _CURVES, _TOLD)
"""The channels of the profile."""


def more_rows(
    states: np.ndarray,
    impacts: np.ndarray,
    sticks: np.ndarray,
    about: tuple[str, Mapping[str, float]] | None = None,
) -> list[Rows]:
    """Return the rows of those channels for a part of a log of one ball that is being written.

    Parameters
    ----------
    states, impacts, sticks : numpy.ndarray, structured
        What is added to it.
    about : tuple of (str, mapping), optional
        Name and parameters of the run, with the first states.
    """
    found: list[Rows] = []
    if len(states) and states["t"][-1] < ROS_LATEST:
        kept = states[_kept(states["t"])]
        if about is not None:
            start = log_times(kept["t"][:1])
            found += [_model(_ONE, *about, start), _placed(start)]
        found += [_moved(_ONE, kept), _curves(_ONE, kept)]
    events = [each[name][-1] for each, name in ((impacts, "t"), (sticks, "t_start")) if len(each)]
    return found + (_words(impacts, sticks, _WORDS) if events and max(events) < ROS_LATEST else [])


def bare_rows(
    states: np.ndarray,
    impacts: np.ndarray,
    sticks: np.ndarray,
    name: str,
    parameters: Mapping[str, float],
    profile: Profile | None = None,
) -> list[Rows]:
    """Return the rows of the channels with which a log explains itself; none where there is nothing to show.

    Parameters
    ----------
    states, impacts, sticks : numpy.ndarray, structured
        The messages of the run, sorted by time.
    name : str
        What the run is called.
    parameters : mapping of str to float
        Parameters of the model.
    profile : Profile, optional
        That of one ball in a cavity of half length 1 if left out.
    """
    shown = _ONE if profile is None else profile
    if not len(states) or states["t"][-1] >= ROS_LATEST:
        return []
    kept = states[_kept(states["t"])]
    start = log_times(kept["t"][:1])
    return [
        _model(shown, name, parameters, start),
        _placed(start),
        _moved(shown, kept),
        _curves(shown, kept),
        *_words(impacts, sticks),
    ]


_ONE = Profile(
    _GEOMETRY,
    _ABOUT,
    {"mass": "x1", "ball": "x2", "base": "base"},
    -2.9,
    dict(
        zip(
            ("mass", "ball", "gap; spring"),
            zip(("x1", "x2", "w"), ("v1", "v2", "w_dot"), VI_NES.energies.stored, strict=True),
            strict=True,
        )
    ),
)


_MASS = """  <link name="nes"><visual><origin xyz="0 0 -0.52"/><geometry><box size="0.16 0.16 0.16"/></geometry>
    <material name="nes"><color rgba="1 0.5 0.78 1"/></material></visual></link>
  <joint name="x3" type="prismatic"><parent link="rig"/><child link="nes"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="0" velocity="0"/></joint>
</robot>"""

BESIDE = Profile(
    _GEOMETRY.replace("</robot>", _MASS),
    _ABOUT.replace("a shaken mass.", "a shaken mass, and a mass on a spring beside it.").replace(
        "/state, /impact, /stick", "/state, /nes, /impact, /stick"
    ),
    {**_ONE.bodies, "nes": "x3"},
    _ONE.mount,
    {**_ONE.series, "mass on the spring": ("x3", "v3", "kinetic_3")},
)
"""That of a ball with a mass on a spring beside it, which is drawn under the cavity."""


def _kept(t: np.ndarray) -> np.ndarray:
    """Return which states are kept: the ends, those just before and after an event, and one in a few of the rest."""
    kept = np.zeros(len(t), bool)
    kept[::_STRIDE] = kept[-1] = True
    jumps = np.flatnonzero(t[1:] == t[:-1])
    kept[jumps] = kept[jumps + 1] = True
    return kept


def _single(values: np.ndarray) -> np.ndarray:
    """Return values in single precision, as doubles: half of their bytes are zero and cost nothing."""
    with np.errstate(over="ignore"):
        return values.astype(np.float32)


def _model(shown: Profile, name: str, parameters: Mapping[str, float], start: np.ndarray) -> Rows:
    """Return the geometry, with what the log is as a comment on top: viewers show both."""
    listed = "   ".join(f"{key} = {parameters[key]:.10g}" for key in sorted(parameters))
    about = escape(shown.about.format(name=name, parameters=listed)).replace("--", "- -")
    text = f"<!--\n{about}-->\n{shown.geometry}".encode() + b"\0"
    layout = Form().put(b"\0\1\0\0" + struct.pack("<I", len(text)) + text).layout()
    return Rows(_MODEL, layout, start, np.empty(1, layout.dtype))


def _transform(form: Form, parent: str, child: str, x: str | None) -> Form:
    """Append a foxglove.FrameTransform."""
    inner = Form().stamp(1).text(2, parent).text(3, child)
    if x is not None:
        inner.nest(4, Form().double(1, x))
    inner.nest(5, Form().tag(4, 1).put(struct.pack("<d", 1.0)))
    slots = [(f"{name}:{child}" if name != x else name, kind, place) for name, kind, place in inner.slots]
    inner.slots = slots
    return form.nest(1, inner)


def _placed(start: np.ndarray) -> Rows:
    """Return the one transform that does not change: where the whole rig is."""
    layout = _transform(Form(), _VIEW, "rig", None).layout()
    return _filled(_PLACED, layout, start, {})


def _moved(shown: Profile, states: np.ndarray) -> Rows:
    form = Form()
    for child, x in shown.bodies.items():
        _transform(form, "rig", child, x)
    values = {x: states[x] + (shown.mount if x == "base" else 0.0) for x in shown.bodies.values()}
    single = {key: _single(each) for key, each in values.items()}
    return _filled(_MOVED, form.layout(), log_times(states["t"]), single)


def _curves(shown: Profile, states: np.ndarray) -> Rows:
    form = Form().put(b"\0\1\0\0").slot("ros_sec", "<i4").slot("ros_nano", "<u4").cdr_text("rig")
    form.align(4).put(struct.pack("<I", len(shown.series)))
    for name in shown.series:
        form.cdr_text(name)
    groups = [list(columns) for columns in zip(*shown.series.values(), strict=True)]
    for names in groups:
        form.cdr_doubles([name or f"none_{k}" for k, name in enumerate(names)])
    values = {
        name or f"none_{k}": _single(states[name]) if name else np.zeros(len(states))
        for names in groups
        for k, name in enumerate(names)
    }
    return _filled(_CURVES, form.layout(), log_times(states["t"]), values)


def _words(impacts: np.ndarray, sticks: np.ndarray, least: int = 0) -> list[Rows]:
    """Return a line an impact and a line a stick, all of one length, that of the longest or `least`."""
    with np.errstate(invalid="ignore"):  # infinite velocities are kept, and shown as nan here
        after = impacts["v1_after"] - impacts["v2_after"]
    told = (impacts[name].tolist() for name in ("t", "index", "w_dot"))
    lines = [
        (t, f"{letter}{ball} impact {index}   w' {before:+.4f} -> {left:+.4f}")
        for letter, ball, t, index, before, left in zip(
            VI_NES.letters(impacts["side"]), _numbers(impacts), *told, after.tolist(), strict=True
        )
    ]
    for row, ball in zip(sticks, _numbers(sticks), strict=True):
        wall = f"{VI_NES.letters([row['side']])}{ball}" if row["side"] else ""
        text = f"{wall} sticks after {row['impacts']} impacts, released at {row['t_release']:.4f}"
        if not wall:
            text = f"stops in mid-cavity, slides on at {row['t_release']:.4f}"
        lines.append((float(row["t_start"]), text))
    if not lines:
        return []
    lines.sort(key=lambda line: line[0])
    texts = np.array([text.encode() for _, text in lines])
    size = max(texts.dtype.itemsize, least)
    form = Form().stamp(1).tag(2, 0).put(b"\2").nest(3, Form().slot("text", f"S{size}")).text(4, "vines")
    times = log_times(np.array([time for time, _ in lines]))
    padded = np.char.ljust(texts, size)
    return [_filled(_TOLD, form.layout(), times, {"text": padded})]


def _numbers(events: np.ndarray) -> list[str]:
    """Return the number of the ball of each event as text, nothing where there is one ball."""
    if "ball" not in (events.dtype.names or ()):
        return [""] * len(events)
    return [str(ball) for ball in events["ball"].tolist()]


def _filled(channel: Channel, layout: WireFormat, times: np.ndarray, values: Mapping[str, np.ndarray]) -> Rows:
    """Return rows whose slots hold the values, or the time where they are those of a time stamp."""
    names = layout.dtype.names or ()
    # Without the offsets of the layout: the bytes between the slots are the template's.
    rows = np.empty(len(times), np.dtype([(name, layout.dtype[name]) for name in names]))
    seconds, nanos = times // 10**9, times % 10**9
    for name in names:
        if name in values:
            rows[name] = values[name]
        elif name.startswith("ros_"):
            rows[name] = seconds if name == "ros_sec" else nanos
        else:
            rows[name] = stamps(seconds if name.startswith("sec") else nanos)
    return Rows(channel, layout, times, rows)
