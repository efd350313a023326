"""What must be quick loads nothing heavy, and the public names are there."""

import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

import vines

HEAVY = ("numba", "pyarrow", "rerun", "matplotlib", "scipy", "pandas", "duckdb")


def loaded(code, tmp_path):
    """Run code in a fresh interpreter and return which heavy packages it loaded."""
    tail = f"\nimport json, sys\nsys.stderr.write(json.dumps([h for h in {HEAVY!r} if h in sys.modules]))"
    done = subprocess.run(
        [sys.executable, "-c", code + tail],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
        timeout=60,
    )
    return json.loads(done.stderr.splitlines()[-1])


def test_import_vines_and_params_load_nothing_heavy(tmp_path):
    assert loaded("import vines; vines.Params(mu=0.01, A=0.02); vines.PhysicalParams()", tmp_path) == []
    assert loaded("from vines import systems; systems.Parallel(mu=(0.01, 0.02), A=0.02)", tmp_path) == []


def test_science_imports_no_library_before_it_is_used(tmp_path):
    """SciPy's statistics took as long to import as vines, its compiled kernels included."""
    code = """
import sys
from vines.orbits import find_orbit
from vines.attractors import exits, settle
print([name for name in ("scipy.stats", "scipy.linalg", "scipy.optimize", "pandas", "pyarrow") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("arguments", [["--help"], ["list"], ["status"], ["status", "quickstart"], ["run", "--help"]])
def test_quick_commands_load_nothing_heavy(arguments, tmp_path):
    code = f"""
import sys
sys.argv = ["vines", *{arguments!r}]
from vines.cli import main
try:
    main()
except SystemExit as end:
    assert end.code == 0, end.code
"""
    assert loaded(code, tmp_path) == []


def test_tables_are_written_and_read_without_pandas(tmp_path):
    (tmp_path / "pipelines").mkdir()
    text = '[stages.table_1]\nkind = "dimensionless"\nparams = { m = 0.05, E = 0.000225, omega = 55.39 }\n'
    (tmp_path / "pipelines" / "rig.toml").write_text(text, "utf-8")
    code = """
import sys
from vines.cli import main
for words in (["run", "rig", "--quiet"], ["verify", "rig"], ["query", "select count(*) from dimensionless"]):
    sys.argv = ["vines", *words]
    try:
        main(supervised=False)
    except SystemExit as end:
        assert end.code == 0, words
"""
    found = loaded(code, tmp_path)
    assert "pyarrow" in found
    assert "pandas" not in found


LAZY = sorted(
    ".".join(stub.relative_to(Path(vines.__file__).parents[1]).parent.parts)
    for stub in Path(vines.__file__).parent.rglob("__init__.pyi")
)


@pytest.mark.parametrize("room", LAZY)
def test_public_names_resolve_and_are_listed(room):
    module = importlib.import_module(room)
    assert set(dir(module)) == set(module.__all__)
    for name in module.__all__:
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError, match="nothing"):
        _ = module.nothing


def test_the_rooms_that_were_lazy_are():
    rooms = ("catalogue", "figures", "pipeline", "rig", "schema", "stages", "store", "systems", "viewer")
    assert ["vines", *(f"vines.{room}" for room in rooms)] == LAZY
