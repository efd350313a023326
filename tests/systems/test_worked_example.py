"""The example of docs/systems.md, "To add a system", as it stands there."""

import re
import shutil
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import vines
from vines import schema
from vines.dynamics import _room
from vines.errors import ParameterError
from vines.model import _declared
from vines.places import shipped
from vines.schema import _system_tables, _tables

PAGE = Path(__file__).resolve().parents[2] / "docs" / "systems.md"
DECLARED = (_declared.read_system, _declared.system_names, _declared._form)
CACHES = (*DECLARED, _room._room_of, _tables._names, _system_tables.of_systems, _tables._table)


def module(name, code, monkeypatch):
    made = types.ModuleType(name)
    made.__dict__["__name__"] = name
    monkeypatch.setitem(sys.modules, name, made)
    exec(compile(code, name, "exec"), made.__dict__)
    return made


@pytest.fixture
def added(tmp_path, monkeypatch):
    """Put the three files where they would lie, and forget them afterwards."""
    text = PAGE.read_text("utf-8")
    files = dict(re.findall(r"^`(\S+)`:\n\n```\w+\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    assert len(files) == 3
    folder = tmp_path / "schemas"
    shutil.copytree(shipped("schemas"), folder)
    (folder / "systems" / "scaled.toml").write_text(files["schemas/systems/scaled.toml"])
    for room in (_declared, _tables, _system_tables):
        monkeypatch.setattr(room, "shipped", lambda name: folder if name == "schemas" else shipped(name))
    for each in CACHES:
        each.cache_clear()
    form = module("vines.systems._scaled", files["vines/systems/_scaled.py"], monkeypatch).Scaled
    monkeypatch.setattr(vines.systems, "Scaled", form, raising=False)
    module("vines.dynamics.scaled", files["vines/dynamics/scaled/__init__.py"], monkeypatch)
    yield form
    for each in CACHES:
        each.cache_clear()


def test_the_example_runs_as_the_vi_nes_at_the_scaled_amplitude(added):
    p, same = added(mu=0.01, A=0.03, beta=2.0), vines.Params(mu=0.01, A=0.015)
    assert str(p) == "mu = 0.01, A = 0.03, beta = 2 (dimensionless)"
    ours, theirs = vines.simulate(p, periods=40), vines.simulate(same, periods=40)
    assert np.array_equal(ours.rows, theirs.rows)
    assert np.array_equal(ours.sample(50), theirs.sample(50))
    assert vines.settle(p).name == vines.settle(same).name == "1:1"


def test_its_names_are_everywhere_after_the_declaration(added):
    assert "scaled" in vines.systems.names()
    assert vines.systems.parameters("scaled") is added
    assert {"beta", "x2", "end_v2", "ties"} <= set(schema.table("scaled_points").names)
    assert schema.table("scaled_orbits").walls["L"] == "left end, side +1"
    with pytest.raises(ParameterError, match="beta is 0, allowed is beta > 0"):
        added(mu=0.01, A=0.03, beta=0)


TOOK = {
    "impact_pair": ("_impact_pair", "impact_pair", ("vines/orbits/*_capsule.py",), ()),
    "parallel": ("_parallel", "parallel", ("vines/orbits/*balls.py",), ("vines/[lv]*/_balls.py",)),
    "drag": ("_drag", "drag", ("vines/orbits/_dragged.py", "vines/orbits/_flown_closing.py"), ()),
    "friction": ("_friction", "friction", ("vines/orbits/_slid*.py", "vines/orbits/_rests.py"), ()),
    "cubic_barriers": (
        "_cubic_barriers",
        "[ct][ua][by][il]*",
        ("vines/orbits/_shots.py", "vines/orbits/_shooting*.py"),
        (),
    ),
    "hybrid": ("_hybrid", "hybrid", ("vines/orbits/_motions.py",), ()),
    "modes": ("_modes", "modes", ("vines/orbits/_modal.py",), ()),
    "duffing": ("_duffing", "duffing", (), ()),
}
"""Of each system: the files that serve it alone, by room."""


def test_the_table_of_what_a_system_took_is_about_right():
    root = PAGE.parents[1]
    row = r"^\| `[\w/]+`(?:, `[\w/]+`)? ((?:\| \d+ in \d+ )+)\|$"
    told = re.findall(row, PAGE.read_text("utf-8"), re.MULTILINE)
    assert len(told) == 5
    for place, (system, (parameters, kernels, orbits, shown)) in enumerate(TOOK.items()):
        patterns = (
            (f"schemas/systems/{system}.toml",),
            (f"vines/systems/{parameters}.py",),
            (f"vines/dynamics/{kernels}/**/*.py",),
            orbits,
            shown,
        )
        for room, row in zip(patterns, told, strict=True):
            files = [file for pattern in room for file in root.glob(pattern)]
            lines, count = re.findall(r"(\d+) in (\d+)", row)[place]
            assert sum(len(file.read_text("utf-8").splitlines()) for file in files) == pytest.approx(
                int(lines), rel=0.2
            )
            assert len(files) == int(count), room
