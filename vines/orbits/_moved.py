"""Parameters with some of them at other values, where a system exists there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from vines.errors import ParameterError
from vines.model import Parameters

__all__ = ["moved"]

Form = TypeVar("Form", bound=Parameters)


def moved(p: Form, values: Mapping[str, float]) -> Form | None:
    """Return parameters with some of them at other values, None where the system does not exist.

    Examples
    --------
    >>> from vines.model import Params
    >>> p = Params(mu=0.01, A=0.02)
    >>> moved(p, {"A": 0.03}).A, moved(p, {"mu": -1.0})
    (0.03, None)
    """
    try:
        return p.replace(**{name: float(value) for name, value in values.items()})
    except ParameterError:
        return None
