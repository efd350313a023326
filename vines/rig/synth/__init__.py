"""A synthetic rig: physics and an integrator of its own, so that it shares no equation with what it tests."""

from vines.rig.synth._ball_camera import BallCamera
from vines.rig.synth._campaign import make_campaign
from vines.rig.synth._contact import LEAST, MOST
from vines.rig.synth._disturb import Burst, Disturbances, Hum, Ringing, disturbed
from vines.rig.synth._live import LiveRig
from vines.rig.synth._make import RawRun, make_run, raw_run, read_raw, simulate_rig
from vines.rig.synth._pattern import true_pattern
from vines.rig.synth._settings import RigSettings, draw_settings
from vines.rig.synth._write import write_raw

__all__ = [
    "LEAST",
    "MOST",
    "BallCamera",
    "Burst",
    "Disturbances",
    "Hum",
    "LiveRig",
    "RawRun",
    "RigSettings",
    "Ringing",
    "disturbed",
    "draw_settings",
    "make_campaign",
    "make_run",
    "raw_run",
    "read_raw",
    "simulate_rig",
    "true_pattern",
    "write_raw",
]
