"""Rooms of the rig are entered by their doors."""

import re
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PRIVATE = re.compile(r"^\s*(?:from|import) (vines\.rig\.\w+)\._\w+", re.MULTILINE)


def test_nothing_imports_a_private_module_of_another_room():
    found = []
    for file in [*(REPOSITORY / "vines").rglob("*.py"), *(REPOSITORY / "benchmarks").rglob("*.py")]:
        own = ".".join(file.relative_to(REPOSITORY).parent.parts)
        found += [
            (file.name, room) for room in PRIVATE.findall(file.read_text()) if not f"{own}.".startswith(f"{room}.")
        ]
    assert not found
