"""Tables of points over two parameters as grids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.packages import need

__all__ = ["Grid", "grid_of"]


@dataclass(frozen=True)
class Grid:
    """Where the rows of a table lie on a grid.

    Attributes
    ----------
    x, y : (nx,), (ny,) array
        Values of the two parameters, ascending; y runs down the rows of an array.
    rows : pandas.DataFrame
        The rows.
    """

    x: npt.NDArray[np.float64]
    y: npt.NDArray[np.float64]
    rows: Any
    places: tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]

    def of(self, values: Any, empty: Any) -> Any:
        """Return values of the rows as an (ny, nx) array, `empty` where there is no row."""
        array = np.full((len(self.y), len(self.x)), empty)
        array[self.places] = values
        return array


def grid_of(table: Any, first: str, second: str) -> Grid:
    """Return the grid of a table over two of its columns, the first along x."""
    need("pandas")
    rows = table.to_pandas()
    x, y = np.unique(rows[first]), np.unique(rows[second])
    return Grid(x, y, rows, (np.searchsorted(y, rows[second]), np.searchsorted(x, rows[first])))
