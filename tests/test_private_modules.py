"""What a room keeps private is imported by no other room; others go through its doors."""

import ast
from collections.abc import Iterator
from pathlib import Path

import vines

PACKAGE = Path(vines.__file__).parent


def imported(file: Path) -> Iterator[str]:
    """Yield the full names that a file imports, those inside functions and for type checkers too."""
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: import by the full name"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def is_foreign(name: str, room: str) -> bool:
    """Say whether an imported name is, or lies in, something private of another room of vines."""
    parts = name.split(".")
    private = any(part.startswith("_") and not part.startswith("__") for part in parts)
    return private and parts[0] == "vines" and parts[1] != room


def test_no_room_imports_what_another_keeps_private():
    found = []
    for file in PACKAGE.rglob("*.py"):
        place = file.relative_to(PACKAGE)
        found += [f"{place}: {name}" for name in imported(file) if is_foreign(name, place.parts[0])]
    assert found == []


def test_the_rule_tells_own_and_foreign_names_apart():
    assert is_foreign("vines.dynamics._flight.turn", "orbits")
    assert is_foreign("vines.dynamics._flight", "__init__.py")
    assert not is_foreign("vines.dynamics._flight.turn", "dynamics")
    assert not is_foreign("vines.dynamics.kernels.turn", "orbits")
    assert not is_foreign("numpy._core", "orbits")
