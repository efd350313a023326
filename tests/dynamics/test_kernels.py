"""The compiled kernels: never stale, never compiled at import, accurate sines."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import typeof, types

import vines.dynamics
from vines.dynamics import _advance
from vines.dynamics._room import constants
from vines.dynamics._sincos import sincos
from vines.kernels import CACHE, njit
from vines.kernels._cache import LazyCache
from vines.kernels._linked import load_symbols
from vines.model import Params

PROGRAM = """
from vines.dynamics._room import constants
from vines.dynamics._flight import phasors
from vines.model import Params
print(phasors(constants(Params(mu=0.1, A=0.3)).free, 1.0, 0.1, 0.2, 0.5)[2])
"""


def _run(program: str, folder: Path, cache: Path | None = None) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
    environment |= {
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONPATH": str(folder),
        "NUMBA_CACHE_DIR": str(cache or folder / "cache"),
    }
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_a_changed_helper_in_another_file_changes_the_number(tmp_path: Path) -> None:
    source = Path(vines.dynamics.__file__).resolve().parent.parent
    copy = tmp_path / "vines"
    copy.mkdir()
    for path in source.glob("*.py*"):
        shutil.copy(path, copy / path.name)
    for room in ("model", "kernels", "dynamics"):
        shutil.copytree(source / room, copy / room, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(source.parent / "schemas", tmp_path / "schemas")
    first = float(_run(PROGRAM, tmp_path))
    helper = copy / "dynamics" / "_sincos.py"
    stamp = helper.stat()
    text = helper.read_text()
    changed = text.replace("n = (x * TWO_OVER_PI", "n = (2.0 * x * TWO_OVER_PI", 1).replace(
        "y = ((x - n", "y = ((2.0 * x - n", 1
    )
    assert changed != text
    helper.write_text(changed)
    os.utime(helper, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    second = float(_run(PROGRAM, tmp_path))
    lam = 0.0119979670
    g = 0.3 * complex(lam, -1.0) / complex(lam / 2, 1.0 + math.sqrt(1 - lam**2 / 4))
    for value, phase in ((first, 0.5), (second, 1.0)):
        exact = (g * complex(math.cos(phase), math.sin(phase))).real
        assert abs(value - exact) < 1e-9


def test_nothing_compiles_at_import(tmp_path: Path) -> None:
    program = """
import vines.attractors, vines.dynamics
from vines.dynamics import _advance, _flight, _totals
kernels = [f for m in (_advance, _flight, _totals) for f in vars(m).values() if hasattr(f, "signatures")]
print(sum(len(f.signatures) for f in kernels))
"""
    root = Path(vines.dynamics.__file__).resolve().parent.parent.parent
    environment = os.environ | {
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONPATH": str(root),
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout.strip() == "0"


def test_sines_are_right_to_the_last_place() -> None:
    for x in np.random.default_rng(7).uniform(-2000.0, 2000.0, 20_000):
        s, c = sincos(x)
        assert abs(s - math.sin(x)) < 2.3e-16
        assert abs(c - math.cos(x)) < 2.3e-16


def test_a_kernel_kept_for_a_tuple_that_has_other_fields_by_now_is_not_loaded() -> None:
    now = typeof(constants(Params(mu=0.1, A=0.3)))
    symbol = _advance.state_now.load((now, types.float64[::1], types.float64))[0]
    call = (symbol, "vines.dynamics._advance", "state_now")
    assert load_symbols([(*call, (now, types.float64[::1], types.float64))])
    before = types.NamedTuple(now.types[:-1], now.instance_class)
    before.fields = now.fields[:-1]
    assert not load_symbols([(*call, (before, types.float64[::1], types.float64))])
    assert not load_symbols([(*call, (types.Tuple((before, types.int64)), types.float64[::1], types.float64))])


@njit
def _half(value):
    return 0.5 * value


def test_a_kernel_kept_with_types_of_modules_that_are_gone_is_compiled_again(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _half(3.0) == 1.5
    cache = LazyCache(_half.py_func, _half.targetoptions)

    def gone(*_: object) -> None:
        raise ModuleNotFoundError("No module named 'vines.gone'")

    monkeypatch.setattr(cache._cache()._cache_file, "load", gone)
    assert cache.load_overload((types.float64,), _half.targetctx) is None


USE = """
import sys
import numpy as np
from vines import Params, continue_orbit, find_orbit, settle
from vines.dynamics import Scatter, ensemble
p = Params(mu=0.01, A=0.0213)
many, one = {"mu": np.full(3, 0.01), "A": np.full(3, 0.02)}, {"v2": np.full(3, 0.1)}
for params, starts in ((p, one), (many, None), (many, one), (p, None)):
    ensemble(params, starts, periods=2, record="measures", threads=1)
    ensemble(params, starts, periods=2, record="impacts", scatter=Scatter(sigma_r=0.01), threads=1)
settle(p)
orbit = find_orbit("LLR", p)
continue_orbit(orbit, "A", 0.0212)
find_orbit("LLR", p.replace(A=0.0214), guess=orbit)
kernels = [k for m in list(sys.modules.values()) if m.__name__.startswith("vines.") for k in vars(m).values()]
# Constants with scatter are a type of their own, for which a kernel is compiled once too.
def most(k):
    scattered = sum("Scatter" in str(types) for types in k.signatures)
    return max(scattered, len(k.signatures) - scattered)
kernels = {id(k): k for k in kernels if isinstance(getattr(k, "signatures", 0), list) and most(k) > 1}
print(sorted(k.__name__ for k in kernels.values()))
"""


def test_no_kernel_is_compiled_again_because_callers_hold_other_kinds_of_arrays_or_constants() -> None:
    root = Path(vines.dynamics.__file__).resolve().parent.parent.parent
    # The largest of a vector, of a matrix and of complex numbers are functions of their own.
    assert _run(USE, root, CACHE.parent) in ("['max_abs']", "[]")


@njit
def _sum(kind, value):
    return kind + value


def test_a_call_with_a_known_number_and_one_with_an_unknown_are_one_kernel() -> None:
    for kind in (types.literal(0), types.literal(1), types.int64):
        _sum.get_call_template((kind, types.float64), {})
    assert _sum.signatures == [(types.int64, types.float64)]
