"""Exact dynamics of the oscillator with a ball in its cavity: flight, impact, sticking, and their Jacobians."""

from vines.dynamics._saltation import jacobian

__all__ = ["jacobian"]
