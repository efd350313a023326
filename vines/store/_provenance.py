"""What a result says about its origin, beside its ingredients: versions and the revision of the sources."""

from __future__ import annotations

import functools
import os
import platform
import subprocess
import sys
from pathlib import Path

__all__ = ["revision", "versions"]

_PACKAGES = ("numba", "numpy", "vines")


@functools.cache
def _versions() -> tuple[tuple[str, str], ...]:
    return (("python", platform.python_version()), *((package, _version(package)) for package in _PACKAGES))


def _version(package: str) -> str:
    """Return the version of a package that the name of its installed folder tells, as pip wrote it.

    Every status asks, and loading importlib.metadata takes a sixth of a run with nothing to do; it is asked where no
    name tells.
    """
    for place in sys.path:
        try:
            names = os.listdir(place or ".")  # noqa: PTH208 - names alone, in folders of hundreds
        except OSError:
            continue
        for name in names:
            if name.startswith(f"{package}-") and name.endswith(".dist-info"):
                return name.removeprefix(f"{package}-").removesuffix(".dist-info")
    from importlib import metadata

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def versions() -> dict[str, str]:
    """Return the versions of Python, numba, numpy and vines.

    Examples
    --------
    >>> sorted(versions())
    ['numba', 'numpy', 'python', 'vines']
    """
    return dict(_versions())


@functools.cache
def revision() -> str:
    """Return the git revision of the checkout that vines runs from, with ``+`` if it was changed.

    Empty where vines is installed without one: a repository around the folder of installed packages says nothing
    about vines.
    """
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return ""
    try:
        head = _git(root, "rev-parse", "HEAD")
        changed = _git(root, "status", "--porcelain", "--untracked-files=no", "--", "vines", "schemas")
    except (OSError, subprocess.SubprocessError):
        return ""
    return head + ("+" if changed else "")


def _git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=20).stdout.strip()
