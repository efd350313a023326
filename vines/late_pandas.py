"""Pandas is loaded when somebody asks for it, not by pyarrow for itself.

pyarrow makes no array of Python's or numpy's without asking whether what it is given belongs to pandas, and to ask it
loads pandas, for half a second of each process. Where pandas has not been loaded, nothing can belong to it.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["load_pandas_late"]


class _AfterImport:
    """A finder that does something once, as soon as a module has been loaded; who looks for it has not loaded it."""

    def __init__(self, name: str, then: Callable[[], None]) -> None:
        self.name = name
        self._then = then
        self._asks_others = False

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find the module as others do, and see to it that loading it does one thing more."""
        del path, target
        if name != self.name or self._asks_others:
            return None
        self._asks_others = True
        try:
            spec = importlib.util.find_spec(name)
        finally:
            self._asks_others = False
        return None if spec is None else self._and_then(spec)

    def _and_then(self, spec: ModuleSpec) -> ModuleSpec:
        load = getattr(spec.loader, "exec_module", None)
        if load is not None:

            def both(module: ModuleType) -> None:
                load(module)
                sys.meta_path[:] = [finder for finder in sys.meta_path if finder is not self]
                self._then()

            setattr(spec.loader, "exec_module", both)  # noqa: B010 - a method for this loader alone
        return spec


class _Missing:
    """A finder that says of pandas that there is none."""

    def find_spec(self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> None:
        """Refuse pandas, and leave all else to others."""
        del path, target
        if name == "pandas":
            raise ModuleNotFoundError("pandas is loaded when it is asked for", name=name)


def load_pandas_late() -> None:
    r"""Let pyarrow take pandas for missing until somebody imports it: for processes of vines, not for a library.

    Functions of pyarrow that need pandas, such as ``Table.to_pandas``, load it as before.

    Examples
    --------
    >>> import subprocess, sys
    >>> program = '''
    ... import sys
    ... from vines.late_pandas import load_pandas_late
    ... load_pandas_late()
    ... import pyarrow as pa
    ... before = pa.array([1, 2]), "pandas" in sys.modules
    ... import pandas
    ... print(before[1], pa.array(pandas.Series([1.0, float("nan")])).null_count)
    ... '''
    >>> subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout
    'False 1\n'
    """
    waits = any(isinstance(finder, _AfterImport) and finder.name in ("pandas", "pyarrow") for finder in sys.meta_path)
    if waits or "pandas" in sys.modules:
        return
    if "pyarrow" in sys.modules:
        _hide()
    else:
        sys.meta_path.insert(0, _AfterImport("pyarrow", _hide))


def _hide() -> None:
    """Let pyarrow look for pandas where it finds none, and tell it when there is one."""
    import pyarrow as pa

    if "pandas" in sys.modules:
        return
    missing = _Missing()
    sys.meta_path.insert(0, missing)
    try:
        pa.array([])
    finally:
        sys.meta_path[:] = [finder for finder in sys.meta_path if finder is not missing]
    sys.meta_path.insert(0, _AfterImport("pandas", _show))


def _show() -> None:
    """Let pyarrow know that pandas is there."""
    import pyarrow.pandas_compat as compat

    assert getattr(compat, "_pandas_api").pd is not None  # noqa: B009 - asking for it makes pyarrow look again
