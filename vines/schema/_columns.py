"""What a table and a column of it are."""

from __future__ import annotations

from dataclasses import dataclass

from vines.model import VI_NES, with_all_balls

__all__ = ["DTYPES", "Column", "Table"]

DTYPES = ("bool", "float64", "int8", "int64", "list<float64>", "list<int8>", "string")


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name : str
        Name, as SQL sees it.
    dtype : str
        One of bool, float64, int8, int64, string, list<float64>, list<int8>.
    unit : str
        ``"1"`` for a dimensionless number, ``"rad"``, ``"T"`` (forcing periods), ``"1/T"``, ``"B"``; empty
        for what is not a number of something.
    description : str
        What it holds, in one line.
    source : str
        Equation or section of the paper, or the page of docs/ that defines it.
    values : tuple of str
        The only texts that are allowed; empty if any is.
    minimum, maximum : float or None
        Least and largest number allowed. Empty values and nan always are.
    """

    name: str
    dtype: str
    unit: str
    description: str
    source: str
    values: tuple[str, ...] = ()
    minimum: float | None = None
    maximum: float | None = None

    @property
    def limited(self) -> bool:
        """Whether not every value of the type is allowed."""
        return bool(self.values) or self.minimum is not None or self.maximum is not None

    @property
    def allowed(self) -> str:
        """What is allowed, in words; empty if everything is.

        Examples
        --------
        >>> from vines.schema import table
        >>> table("points").columns[1].allowed
        '>= 1e-12 and <= 1e+06'
        """
        if self.values:
            return ", ".join(self.values)
        least = "" if self.minimum is None else f">= {self.minimum:g}"
        most = "" if self.maximum is None else f"<= {self.maximum:g}"
        return " and ".join(filter(None, (least, most)))


@dataclass(frozen=True, slots=True)
class Table:
    """A table of ``schemas/``.

    Attributes
    ----------
    name, description : str
        Its name and what a row is.
    version : int
        Raised when the meaning of a column changes.
    columns : tuple of Column
        ``point_id`` first.
    stored : bool
        False for what is made from manifests when asked, such as ``logs``.
    system : str
        The system that its rows are of.
    """

    name: str
    description: str
    version: int
    columns: tuple[Column, ...]
    stored: bool
    system: str = VI_NES.name

    @property
    def like(self) -> str:
        """What the table is called for the VI-NES.

        Examples
        --------
        >>> from vines.schema import table
        >>> table("impact_pair_points").like, table("points").like
        ('points', 'points')
        """
        return self.name if self.system == VI_NES.name else self.name.removeprefix(f"{self.system}_")

    @property
    def walls(self) -> dict[str, str]:
        """What the letters of words and the signs of sides mean; empty where there are none.

        Examples
        --------
        >>> from vines.schema import table
        >>> table("impact_pair_impacts").walls["L"]
        'lower end of the capsule, side +1'
        """
        if not {"word", "side"} & set(self.names):
            return {}
        contacts = with_all_balls(self.system).contacts
        return {each.letter: f"{each.text}, side {each.sign:+d}" for each in contacts}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return tuple(column.name for column in self.columns)
