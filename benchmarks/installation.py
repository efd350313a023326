"""How large installations are and how long pip takes for them: ``python -m benchmarks.installation [WORDS]``.

Each is a virtual environment of its own, made with ``--no-compile`` as `make` does it, files fetched anew or from pip's
cache. Site-packages are counted without pip itself and without byte-code. WORDS choose rows that hold one of them.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
LOCKS = ("requirements-node.lock", "requirements.lock", "requirements-dev.lock")
EXTRAS = ("", "rig", "dask", "browse", "rig,dask,browse")
ASKED = {
    **{f"`{lock}`": ["--require-hashes", "-r", lock] for lock in LOCKS},
    **{f"`pip install {f'.[{extra}]' if extra else '.'}`": [f".[{extra}]" if extra else "."] for extra in EXTRAS},
}


def installed(words: list[str]) -> tuple[int, float, float]:
    """Return how many packages an installation has, how large it is [MB], and how long pip took [s]."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        [place] = Path(folder).glob("lib/python*/site-packages")
        own = {path for pattern in ("pip*", "setuptools*", "_distutils_hack") for path in place.glob(pattern)}
        began = time.perf_counter()
        pip = [f"{folder}/bin/python", "-m", "pip", "install", "-qq", "--no-compile", "--disable-pip-version-check"]
        subprocess.run([*pip, *words], check=True, cwd=HERE)
        seconds = time.perf_counter() - began
        files = [
            path
            for path in place.rglob("*")
            if path.is_file() and path.suffix != ".pyc" and not own.intersection(path.parents)
        ]
        packages = sum(path not in own for path in place.glob("*.dist-info"))
        return packages, sum(path.stat().st_size for path in files) / 1e6, seconds


def main(words: list[str]) -> None:
    """Print the table."""
    print("| | packages | MB | s |\n|---|---|---|---|")
    for name, asked in ASKED.items():
        if not words or any(word in name for word in words):
            packages, size, seconds = installed(asked)
            print(f"| {name} | {packages} | {size:.0f} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
