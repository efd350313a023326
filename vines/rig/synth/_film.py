"""What a camera on the ball records: few positions a second, a clock of its own, frames in which the ball is lost."""

from __future__ import annotations

import numpy as np

from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import ChannelRow
from vines.rig.synth._ball_camera import BallCamera
from vines.rig.synth._motion import Motion

__all__ = ["CAMERA_FILE", "film"]

CAMERA_FILE = "camera.csv"
_TURNED, _INCH = -1.0, 25.4
_STRETCH = 4
"""Frames that are lost together, on average."""


def film(
    camera: BallCamera, motion: Motion, lead: float, duration: float, seed: int, fault: str = "none"
) -> tuple[ChannelRow, RawFile]:
    """Return the camera's row of ``channels.tsv`` and its file: positions in millimetres, nan where it lost the ball.

    Parameters
    ----------
    camera : BallCamera
    motion : Motion
        Its rows begin `lead` before the record.
    lead, duration : float
        Of the record [s].
    seed : int
        Of what the camera draws, apart from all other draws of the run.
    fault : {"none", "sign", "unit"}
        What is wrong without being stated.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 66]))
    pace = 1 + 1e-6 * camera.ppm
    count = int((duration - max(camera.late, 0.0)) * camera.rate / pace)
    true = lead + camera.late + np.arange(count) * pace / camera.rate
    total = np.concatenate([[0.0], np.cumsum(motion.x2)]) * motion.step
    edges = np.arange(len(total)) * motion.step - 0.5 * motion.step
    half = max(0.5 * camera.exposure / camera.rate, 0.5 * motion.step)
    x = (np.interp(true + half, edges, total) - np.interp(true - half, edges, total)) / (2 * half)
    x = camera.scale * x + rng.normal(0.0, camera.noise, count)
    x *= {"sign": _TURNED, "unit": _INCH}.get(fault, 1.0)
    for begin in rng.uniform(0, count, rng.poisson(camera.lost * count / _STRETCH)).astype(int):
        x[begin : begin + 1 + rng.poisson(_STRETCH - 1)] = np.nan
    channel = RawChannel("ball", 1e3 * x, "mm", times=np.arange(count) / camera.rate, about={"slope": "1"})
    row = ChannelRow(
        name="ball_cam", role="ball_cam", quantity="displacement", dof="x2", file=CAMERA_FILE, field="ball", unit="mm",
        sensitivity="scaled", sensitivity_unit="", u_sensitivity=camera.u_scale, sign="+1", fs=camera.rate, t0=0.0,
        range=1e4, group_delay=0.0, u_delay=1e-4, high_pass=0.0, recorder="camera",
        sensor=f"camera, {camera.rate:g} frames a second", serial="synthetic-ball_cam", calibrated="2026-01-02",
    )  # fmt: skip
    return row, RawFile("csv", (channel,), None)
