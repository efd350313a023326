"""What a run demands of every process that computes for it: the store that it sees, and the code of the key."""

from __future__ import annotations

import multiprocessing
import platform
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from vines.errors import CodeError, EngineError
from vines.imported import imported_at
from vines.pipeline._code import CodeDigests
from vines.store import Store, versions

if TYPE_CHECKING:
    from vines.pipeline._ingredients import Ingredients

__all__ = ["Checked", "Demand", "demand"]

_Item = TypeVar("_Item")
_Made = TypeVar("_Made")

_PACKAGES = ("numba", "numpy")
_IMPORTED: dict[str, tuple[int, str]] = {}
"""Of each module that was looked at when its import began, and the digest of the code that this process has of it."""


@dataclass(frozen=True, slots=True)
class Demand:
    """What the process that computes has to prove before anything of it is stored; travels with the work.

    Attributes
    ----------
    code : str
        The digest of the code in the key.
    modules : mapping of str to str
        Digest of each module that it is made of.
    versions : mapping of str to str
        Versions of Python, numba and numpy of the run.
    data : Path
        The folder of the store.
    token : Path or None
        File that the run has written there, where others have started the processes.
    text : str
        What stands in it.
    """

    code: str
    modules: Mapping[str, str]
    versions: Mapping[str, str]
    data: Path
    token: Path | None = None
    text: str = ""

    def check_store(self) -> None:
        """See that this process sees the store of the run.

        Raises
        ------
        EngineError
            If it does not: what it would store, nobody would find.
        """
        if self.token is None:
            return
        try:
            seen = self.token.read_text("utf-8") == self.text
        except FileNotFoundError:
            seen = False
        except OSError as error:
            raise EngineError(
                f"{_who()} cannot read the folder {self.data} of this run ({error.strerror}); nothing was given to it"
            ) from None
        if not seen:
            raise EngineError(
                f"{_who()} does not see the folder {self.data} of this run, so nothing was given to it; "
                "mount it there at the same path, or use --shard on the nodes and copy data/points (docs/clusters.md)"
            )

    def check_code(self) -> None:
        """See that what this process has imported is the code of the key, and that its packages are those of the run.

        Raises
        ------
        CodeError
            If something differs; one line that names it.
        """
        # the cache of the sources goes by path and time stamp, which say nothing on another machine
        cache = None if self.token is not None else Store(self.data).cache / "code.json"
        other = _other_code(self.modules, CodeDigests(cache))
        if other:
            listed = ", ".join(other[:3]) + (f" and {len(other) - 3} more" if len(other) > 3 else "")
            raise CodeError(
                f"{_who()} runs other code than the key says: {listed}; nothing of it is stored; {_remedy()}"
            )
        mine = _versions()
        for name, version in self.versions.items():
            if name in mine and mine[name] != version:
                raise CodeError(
                    f"{_who()} runs {name} {mine[name]}, and this run {name} {version}; nothing of it is stored; "
                    f"{_remedy()}"
                )


@dataclass(frozen=True, slots=True)
class Checked(Generic[_Item, _Made]):
    """A function that other processes apply, once they have shown that they run the code of the key."""

    function: Callable[[_Item], _Made]
    demand: Demand

    def __call__(self, item: _Item) -> _Made:
        """Apply the function."""
        made = self.function(item)
        self.demand.check_code()
        return made


def demand(ingredients: Ingredients, store: Store, token: tuple[Path, str] | None) -> Demand:
    """Return what is demanded of who computes a stage.

    Parameters
    ----------
    ingredients : Ingredients
        Of the stage.
    store : Store
        Where its results go.
    token : tuple of (Path, str) or None
        File and text that prove that a process sees the store, where others have started it.
    """
    path, text = token or (None, "")
    packages = {name: version for name, version in versions().items() if name != "vines"}
    code = ingredients.form["code"]
    return Demand(code["digest"], code["modules"], packages, store.data, path, text)


def _other_code(wanted: Mapping[str, str], code: CodeDigests) -> list[str]:
    """Return the modules that this process has imported with other code; those not imported were not used."""
    return [name for name, digest in wanted.items() if name in sys.modules and _imported(name, code) != digest]


def _imported(module: str, code: CodeDigests) -> str:
    """Return the digest of the code that this process has of a module; empty if its file was changed before a look."""
    began = imported_at(module)
    known = _IMPORTED.get(module)
    if known is None or known[0] != began:
        read = code.read(module)
        digest, changed = read if read is not None else ("", 0)
        known = _IMPORTED[module] = (began, digest if changed <= began else "")
    return known[1]


def _versions() -> dict[str, str]:
    """Return the versions that this process runs: of an imported package what it says itself."""
    found = {"python": platform.python_version(), **{name: versions()[name] for name in _PACKAGES}}
    found.update({name: sys.modules[name].__version__ for name in _PACKAGES if name in sys.modules})
    return found


def _worker() -> Any:
    """Return the dask worker that this process is; None if it is none."""
    if "distributed" not in sys.modules:
        return None
    try:
        return sys.modules["distributed"].get_worker()
    except ValueError:
        return None


def _who() -> str:
    worker = _worker()
    if worker is not None:
        return f"the dask worker at {worker.address} on {platform.node()}"
    return "a worker process" if multiprocessing.parent_process() is not None else "this process"


def _remedy() -> str:
    if _worker() is not None:
        return "start it from the environment and the sources of this run"
    if multiprocessing.parent_process() is not None:
        return "files were changed while it ran; run again"
    return "files were changed after they were imported; restart Python and run again"
