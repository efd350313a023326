"""A synthetic rig: physics and an integrator of its own, so that it shares no equation with what it tests."""

from vines.rig.synth._ball_camera import BallCamera
from vines.rig.synth._campaign import make_campaign
from vines.rig.synth._contact import LEAST, MOST
from vines.rig.synth._make import RawRun, make_run, raw_run, read_raw, simulate_rig
from vines.rig.synth._settings import RigSettings, draw_settings

__all__ = [
    "LEAST",
    "MOST",
    "BallCamera",
    "RawRun",
    "RigSettings",
    "draw_settings",
    "make_campaign",
    "make_run",
    "raw_run",
    "read_raw",
    "simulate_rig",
]
