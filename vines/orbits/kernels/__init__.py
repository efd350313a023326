"""What rooms above compile into kernels of their own: eigenvalues, and Newton's method for periodic orbits."""

from vines.orbits._eigenvalues import eigenvalues_kernel
from vines.orbits._equations import newton_kernel

__all__ = ["eigenvalues_kernel", "newton_kernel"]
