"""What impacts yield by a law that is declared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vines.errors import ParameterError
from vines.model import Parameter as Number
from vines.model import Range

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

__all__ = ["Harvest"]

_THRESHOLD = Number("threshold", "Speed below which an impact yields nothing", Range(0), "it is a speed")


@dataclass(frozen=True, slots=True)
class Harvest:
    """The energy that an impact yields: E = sum of c_k |w'|^k from a threshold of |w'| on, else nothing.

    Parameters
    ----------
    threshold : float
        Least impact speed |w'| that yields something, >= 0.
    coefficients : tuple of float
        c_0, c_1, …: in units of the energies of the system (of the pair: mass of the ball, b² omega²).

    Raises
    ------
    ParameterError
        If the threshold is negative, or there is no coefficient.

    Notes
    -----
    ``Harvest(0, (0, 0, (1 - r**2)/2))`` is the mechanical bound of the impact pair: all that an impact loses.

    Examples
    --------
    >>> Harvest(0.2, (0.0, 0.0, 0.5)).energy([0.1, -2.0]).tolist()
    [0.0, 2.0]
    """

    threshold: float
    coefficients: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold", _THRESHOLD.check(self.threshold))
        if not self.coefficients:
            raise ParameterError("coefficients are empty; give at least one: E is the sum of c_k |w'|^k")
        checked = (Number(f"coefficients[{k}]", "", Range()).check(c) for k, c in enumerate(self.coefficients))
        object.__setattr__(self, "coefficients", tuple(checked))

    def energy(self, w_dot: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return the energy of each impact.

        Parameters
        ----------
        w_dot : array_like
            Relative velocities w' just before the impacts.
        """
        import numpy as np

        speed = np.abs(np.asarray(w_dot, dtype=np.float64))
        return np.where(speed >= self.threshold, np.polynomial.polynomial.polyval(speed, self.coefficients), 0.0)
