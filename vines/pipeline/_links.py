"""Parameters that follow from others: ``link.mu_2 = "0.02 - mu_1"``, evaluated in whole fractions and rounded once.

A number stands for the decimals that it is written or prints as, so that .02 - .005 is .015 and a row tells by itself
what its linked values have to be.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError, VinesError, nearest
from vines.model import Expression
from vines.pipeline._axes import exact

if TYPE_CHECKING:
    import numpy as np

    from vines.pipeline._declaration import Stage

__all__ = ["linked_values", "read_links", "with_links"]


def read_links(
    form: Mapping[str, Any], parameters: Iterable[str], taken: Mapping[str, str], where: str
) -> dict[str, Expression]:
    """Read ``link``: formulas by the name of the parameter that they give, each after those that it needs.

    Parameters
    ----------
    form : mapping
        What was declared.
    parameters : iterable of str
        The parameters of the kind.
    taken : mapping of str to str
        Where parameters are given that therefore cannot be linked.
    where : str
        File and key, for messages.

    Raises
    ------
    DeclarationError
        If a name is unknown or given elsewhere too, a formula cannot be read, or formulas need each other.
    """
    names = list(parameters)
    found: dict[str, Expression] = {}
    for name, text in form.items():
        if name not in names:
            raise DeclarationError(f"{where}: unknown parameter {name!r}: {nearest(name, names)}")
        if name in taken:
            raise DeclarationError(f"{where}.{name}: {name} is also given under {taken[name]}; keep one of them")
        try:
            found[name] = Expression(text)
        except VinesError as error:
            raise DeclarationError(f"{where}.{name}: {error}") from None
        for other in found[name].names:
            if other not in names:
                raise DeclarationError(f"{where}.{name}: unknown parameter {other!r}: {nearest(other, names)}")
    sorter = TopologicalSorter({name: [n for n in formula.names if n in found] for name, formula in found.items()})
    try:
        return {name: found[name] for name in sorter.static_order()}
    except CycleError as error:
        circle = " needs ".join(reversed(error.args[1]))
        raise DeclarationError(f"{where}: {circle}: a parameter cannot follow from itself") from None


def linked_values(links: Mapping[str, Expression], values: Mapping[str, float | Fraction]) -> dict[str, Fraction]:
    """Return what the formulas give, exactly.

    Examples
    --------
    >>> linked_values({"mu_2": Expression("0.02 - mu_1")}, {"mu_1": 0.005})
    {'mu_2': Fraction(3, 200)}

    Raises
    ------
    ParameterError
        If something is divided by 0.
    """
    known = {name: value if isinstance(value, Fraction) else exact(value, name) for name, value in values.items()}
    for name, formula in links.items():
        known[name] = formula.value(known)
    return {name: known[name] for name in links}


def with_links(stage: Stage, columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return columns of varied values and those that follow from them."""
    import numpy as np

    found = dict(columns)
    if not stage.links:
        return found
    needed = {name for formula in stage.links.values() for name in formula.names}
    axes = [name for name in columns if name in needed]
    rows = list(zip(*(columns[name].tolist() for name in axes), strict=True))
    made = {row: linked_values(stage.links, stage.params | dict(zip(axes, row, strict=True))) for row in set(rows)}
    return found | {name: np.array([float(made[row][name]) for row in rows]) for name in stage.links}
