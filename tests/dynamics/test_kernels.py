"""The compiled kernels: never stale, never compiled at import, accurate sines."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

import vines.dynamics
from vines.dynamics._sincos import sincos

PROGRAM = """
from vines.dynamics._constants import constants
from vines.dynamics._flight import phasors
from vines.model import Params
print(phasors(constants(Params(mu=0.1, A=0.3)).free, 1.0, 0.1, 0.2, 0.5)[2])
"""


def _run(program: str, folder: Path) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
    environment |= {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_a_changed_helper_in_another_file_changes_the_number(tmp_path: Path) -> None:
    source = Path(vines.dynamics.__file__).resolve().parent.parent
    copy = tmp_path / "vines"
    for name in ("__init__.py", "errors.py", "places.py"):
        copy.mkdir(exist_ok=True)
        shutil.copy(source / name, copy / name)
    for room in ("model", "kernels", "dynamics"):
        shutil.copytree(source / room, copy / room, ignore=shutil.ignore_patterns("__pycache__"))
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
    environment = os.environ | {"PYTHONPATH": str(root), "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout.strip() == "0"


def test_sines_are_right_to_the_last_place() -> None:
    for x in np.random.default_rng(7).uniform(-2000.0, 2000.0, 20_000):
        s, c = sincos(x)
        assert abs(s - math.sin(x)) < 2.3e-16
        assert abs(c - math.cos(x)) < 2.3e-16
