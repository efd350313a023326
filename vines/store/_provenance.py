"""What a result says about its origin, beside its ingredients: versions and the revision of the sources."""

from __future__ import annotations

import functools
import platform
import subprocess
from pathlib import Path

__all__ = ["revision", "versions"]

_PACKAGES = ("numba", "numpy", "vines")


@functools.cache
def _versions() -> tuple[tuple[str, str], ...]:
    from importlib import metadata

    found = [("python", platform.python_version())]
    for package in _PACKAGES:
        try:
            found.append((package, metadata.version(package)))
        except metadata.PackageNotFoundError:
            found.append((package, "not installed"))
    return tuple(found)


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
