"""Columns of a stored table as numpy arrays, for checks of all rows at once."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Floats", "Rows"]

Floats = npt.NDArray[np.float64]


class Rows:
    """Some rows of a table.

    Parameters
    ----------
    table : pyarrow.Table
        With columns of a table of ``schemas/``.
    """

    def __init__(self, table: pa.Table) -> None:
        self._table: Any = table.combine_chunks()
        self._columns: dict[str, Floats] = {}

    def __len__(self) -> int:
        return self._table.num_rows

    def __getitem__(self, name: str) -> Floats:
        """Return a column of numbers or truth values as floats, shape (n,); nan where it is empty."""
        if name not in self._columns:
            column = self._table.column(name).combine_chunks()
            self._columns[name] = _floats(column)
        return self._columns[name]

    @property
    def table(self) -> pa.Table:
        """The rows as they were given."""
        return self._table

    def has(self, *names: str) -> bool:
        """Whether all these columns are there."""
        return set(names) <= set(self._table.column_names)

    def text(self, name: str) -> npt.NDArray[np.object_]:
        """Return a column of texts, shape (n,); None where it is empty."""
        return np.asarray(self._table.column(name).to_numpy(zero_copy_only=False), dtype=object)

    def codes(self, name: str) -> tuple[npt.NDArray[np.int64], list[Any]]:
        """Return a column of texts as numbers, shape (n,), and the different texts; -1 where it is empty."""
        encoded = self._table.column(name).combine_chunks().dictionary_encode()
        return np.asarray(encoded.indices.fill_null(-1)), encoded.dictionary.to_pylist()

    def lists(self, name: str) -> Floats:
        """Return the values of a column of lists one list after the other."""
        return _floats(self._table.column(name).combine_chunks().flatten())

    @cached_property
    def lengths(self) -> npt.NDArray[np.int64]:
        """Number of impacts of each row, shape (n,): the length of its list ``t``."""
        import pyarrow.compute

        pc: Any = pyarrow.compute
        return np.asarray(pc.fill_null(pc.list_value_length(self._table.column("t").combine_chunks()), 0), dtype=int)

    def take(self, chosen: npt.NDArray[np.bool_]) -> Rows:
        """Return the rows that are chosen."""
        import pyarrow as pa

        return Rows(self._table.filter(pa.array(chosen)))


def _floats(column: Any) -> Floats:
    import pyarrow as pa

    column = column.cast(pa.int8()) if column.type == pa.bool_() else column
    made = column.cast(pa.float64(), safe=False)
    return np.array(made.fill_null(float("nan")) if made.null_count else made)
