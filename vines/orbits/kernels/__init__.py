"""What rooms above compile into kernels of their own: contacts, eigenvalues, Newton's method for periodic orbits."""

from vines.orbits._contacts import STUCK, completes, contacts, mark
from vines.orbits._eigenvalues import eigenvalues_kernel
from vines.orbits._equations import newton_kernel

__all__ = ["STUCK", "completes", "contacts", "eigenvalues_kernel", "mark", "newton_kernel"]
