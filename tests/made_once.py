"""What takes long to make is made once in a test run: by the worker that needs it first; the others share it."""

import os
import shutil

from filelock import FileLock


def made_once(factory, name, make):
    """Return a folder that all workers share; not to be changed, see `own_copy`.

    Parameters
    ----------
    factory : pytest.TempPathFactory
        Knows the folder of this run of pytest.
    name : str
        Name of the folder.
    make : callable
        Fills the folder that it gets. What fails is made again by the next worker that asks, and fails there too.
    """
    base = factory.getbasetemp()
    if os.environ.get("PYTEST_XDIST_WORKER"):
        base = base.parent  # each worker has a folder of its own in it
    folder, done = base / "made once" / name, base / "made once" / f"{name}.done"  # a path with a space in it
    folder.parent.mkdir(exist_ok=True)
    with FileLock(base / f"{name}.lock"):
        if not done.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            done.touch()
    return folder


def own_copy(folder, to):
    """Return a copy of a shared folder that a test may change."""
    return shutil.copytree(folder, to, dirs_exist_ok=True)
