"""Settings of a camera on the ball of a synthetic rig."""

from __future__ import annotations

import msgspec

from vines.errors import ParameterError

__all__ = ["BallCamera"]


class BallCamera(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A camera that follows the ball.

    Attributes
    ----------
    rate : float
        Positions a second.
    late : float
        By how much its record begins later than that of the run, which nobody states [s].
    ppm : float
        Error of its clock [1e-6].
    noise : float
        Of a position [m].
    scale : float
        What it gives for a metre: the error of its calibration.
    exposure : float
        Part of a frame in which the shutter is open.
    lost : float
        Share of the frames without the ball.
    u_scale : float
        Relative standard uncertainty that the laboratory states.
    """

    rate: float = 500.0
    late: float = 0.02
    ppm: float = 0.0
    noise: float = 5e-5
    scale: float = 1.0
    exposure: float = 0.25
    lost: float = 0.01
    u_scale: float = 0.005

    def check(self) -> BallCamera:
        """Return the camera if there can be such a one.

        Raises
        ------
        ParameterError
            One line: what cannot be, and what is allowed.
        """
        for name, low, high in (
            ("rate", 50.0, 1e5), ("late", -2.0, 2.0), ("noise", 0.0, 0.01), ("scale", 1e-3, 1e3),
            ("exposure", 0.0, 1.0), ("lost", 0.0, 0.5), ("u_scale", 0.0, 1.0), ("ppm", -1e5, 1e5),
        ):  # fmt: skip
            if not low <= getattr(self, name) <= high:
                raise ParameterError(
                    f"synthetic rig: camera.{name} is {getattr(self, name):g}, allowed is {low:g} to {high:g}"
                )
        return self
