"""Compiled kernels of sources that are gone do not pile up, and those that may be in use are left alone."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vines.dynamics._old_kernels import delete_old, note_use

DAY = 86_400.0


def _cache(folder: Path, number: int, days: float) -> Path:
    made = folder / f"{number:016x}"
    (made / "kernels").mkdir(parents=True)
    (made / "kernels" / "one.nbc").write_bytes(b"machine code")
    used = time.time() - days * DAY
    os.utime(made, (used, used))
    return made


def test_the_last_ones_and_those_used_lately_are_kept(tmp_path: Path) -> None:
    made = [_cache(tmp_path, k, days) for k, days in enumerate((0.1, 1.0, 1.5, 1.9, 3.0, 9.0))]
    other = tmp_path / "notes"
    other.mkdir()
    assert delete_old(tmp_path) == [made[4].name, made[5].name]
    assert sorted(tmp_path.iterdir()) == sorted([*made[:4], other])


def test_three_are_kept_however_old(tmp_path: Path) -> None:
    made = [_cache(tmp_path, k, 10.0 + k) for k in range(5)]
    note_use(made[4])
    delete_old(tmp_path)
    assert [folder.exists() for folder in made] == [True, True, False, False, True]
    assert delete_old(tmp_path / "absent") == []


@pytest.mark.parametrize("known", [True, False])
def test_a_process_with_new_sources_cleans_up_and_one_with_known_ones_does_not(tmp_path: Path, known: bool) -> None:
    made = [_cache(tmp_path / "cache" / "numba", k, 10.0 + k) for k in range(5)]
    code = "from vines.dynamics import _jit; print(_jit.CACHE)"
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    environment |= {"VINES_DATA": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}

    def run() -> Path:
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        return Path(done.stdout.strip())

    if known:
        now = tmp_path / "cache" / "numba" / run().name
        now.mkdir(exist_ok=True)
        made = [_cache(now.parent, 100 + k, 10.0 + k) for k in range(5)]
        os.utime(now, (0.0, 0.0))
        run()
        assert all(folder.exists() for folder in made)
        assert time.time() - now.stat().st_mtime < DAY
    else:
        run()
        assert [folder.exists() for folder in made] == [True, True, True, False, False]
