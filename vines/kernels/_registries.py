"""numba's own parts are imported once, not each time that something is compiled.

Before each compilation, and for each function that it does not find at once, numba runs through some forty statements
of import, to hear of what has been added since. That is still heard of: the registries are read as before.
"""

from __future__ import annotations

from typing import Any

from numba.core.cpu import CPUContext
from numba.core.typing.context import Context

__all__ = ["import_parts_once"]


def import_parts_once() -> None:
    """Let numba import its parts once for each of its contexts, from now on, in this process."""
    for kind in (CPUContext, Context):
        _remember(kind)


def _remember(kind: Any) -> None:
    load = kind.load_additional_registries
    if getattr(load, "remembers", False):
        return
    known: dict[int, tuple[Any, list[Any]]] = {}

    def load_additional_registries(self: Any) -> None:
        # Contexts for other flags of compilation are copies of one, and share what it has loaded.
        loaded = self._registries
        if id(loaded) not in known:
            found: list[Any] = []
            install = self.install_registry

            def note(registry: Any) -> None:
                found.append(registry)
                install(registry)

            self.install_registry = note
            try:
                load(self)
            finally:
                del self.install_registry
            known[id(loaded)] = loaded, found
        else:
            for registry in known[id(loaded)][1]:
                self.install_registry(registry)

    load_additional_registries.remembers = True  # pyright: ignore[reportFunctionMemberAccess]
    kind.load_additional_registries = load_additional_registries
