"""Declaring a pipeline in Python: the same words as in TOML, the same checks, the same keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError
from vines.pipeline._declaration import Pipeline

__all__ = ["Declaration", "span"]

Number = int | float | Decimal


def span(
    start: Number, stop: Number, count: int | None = None, *, step: Number | None = None, log: bool = False
) -> Any:
    """Return what ``vary`` takes for a range: ``{ from, to, count }``, ``{ from, to, step }`` or ``{ from, to }``.

    Examples
    --------
    >>> span(0.015, 0.023, 401)
    {'from': 0.015, 'to': 0.023, 'count': 401}
    """
    form: dict[str, Any] = {"from": start, "to": stop}
    if count is not None:
        form["count"] = count
    if step is not None:
        form["step"] = step
    if log:
        form["log"] = True
    return form


class Declaration:
    """A pipeline that is declared step by step.

    Floats stand for the decimals that they print as, so ``0.1`` is a tenth, as in TOML.

    Parameters
    ----------
    name : str
        Name of the pipeline; its results are pinned under it.
    title, source : str
        What it is, and which figure or section it reproduces.
    params : mapping of str to float or list of float, optional
        Parameters of every stage that takes them.
    system : str, optional
        The system of every stage that takes parameters; the VI-NES if left out.
    physical : mapping of str to float or list of float, optional
        Quantities in SI units from which parameters follow.

    Examples
    --------
    >>> study = Declaration("first", params={"mu": 0.01})
    >>> study.stage("up", "sweep", vary={"A": span(0.015, 0.023, 401)}, carry="A", settle=400)
    >>> study.form["stages"]["up"]["settle"]
    400
    """

    def __init__(
        self,
        name: str,
        *,
        title: str = "",
        source: str = "",
        params: Mapping[str, Number | Sequence[Number]] | None = None,
        system: str | None = None,
        physical: Mapping[str, Number | Sequence[Number]] | None = None,
    ) -> None:
        self.name = name
        self.form: dict[str, Any] = {"title": title, "source": source, "params": _plain(params or {}), "stages": {}}
        self.form |= {} if system is None else {"system": system}
        self.form |= {"physical": _plain(physical)} if physical else {}

    def stage(
        self,
        name: str,
        kind: str,
        *,
        params: Mapping[str, Number] | None = None,
        vary: Mapping[str, Any] | None = None,
        needs: Sequence[str] = (),
        **rest: Any,
    ) -> None:
        """Add a stage.

        Parameters
        ----------
        name, kind : str
            Its name, and what it does.
        params, vary, needs
            As in TOML.
        **rest
            ``system``, ``physical``, ``link``, ``carry``, ``zip``, ``refine``, and the options of the kind.

        Raises
        ------
        DeclarationError
            If there is a stage of that name already.
        """
        if name in self.form["stages"]:
            raise DeclarationError(f"{self.name}: stages.{name} is declared twice; choose another name")
        given = {"params": dict(params or {}), "vary": dict(vary or {}), "needs": list(needs)}
        self.form["stages"][name] = {
            "kind": kind,
            **{key: value for key, value in given.items() if value},
            **{key: _plain(value) for key, value in rest.items()},
        }

    def load(self, overrides: Mapping[str, Any] | None = None, *, root: Path | None = None) -> Pipeline:
        """Check the declaration and return the pipeline.

        Raises
        ------
        DeclarationError, ParameterError, StateError
            As :func:`vines.pipeline.load`.
        """
        from vines.pipeline._reading import read_form

        form = {key: value for key, value in self.form.items() if value != {} or key == "stages"}
        form["stages"] = {
            name: {key: _plain(value) for key, value in stage.items()} for name, stage in self.form["stages"].items()
        }
        return read_form(self.name, form, overrides or {}, Path(f"<{self.name}>"), root)


def _plain(value: Any) -> Any:
    """Return tuples as lists and mappings as dicts, as TOML gives them."""
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(each) for each in value]
    return float(value) if isinstance(value, Fraction) else value
