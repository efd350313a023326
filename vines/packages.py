"""Packages that computing does without: what each is for, and the one line that says how to install a missing one.

A node of a cluster has neither the viewer nor figures nor SQL (``requirements-node.lock``), and the libraries of
measured files, of dask and of the schemas' compiler are extras. Whoever is about to import such a package calls
:func:`need` first, so that its absence is told in one line, in the library as on the command line.
"""

from __future__ import annotations

from importlib.util import find_spec

from vines.errors import PackageMissingError

__all__ = ["OPTIONAL", "need"]

_RUN = "pip install --require-hashes -r requirements.lock"
_RIG, _DASK, _NI, _FOXGLOVE, _DEV = (f"pip install '.[{extra}]'" for extra in ("rig", "dask", "ni", "foxglove", "dev"))

OPTIONAL = {
    "duckdb": ("SQL over tables", "duckdb", _RUN),
    "matplotlib": ("drawing figures", "matplotlib", _RUN),
    "pandas": ("reading a table as a data frame", "pandas", _RUN),
    "PIL": ("writing a GIF", "pillow", _RUN),
    "rerun": ("the viewer", "rerun-sdk", _RUN),
    "distributed": ("--engine dask", "distributed", _DASK),
    "h5py": ("HDF5 and MATLAB 7.3", "h5py", _RIG),
    "nptdms": ("NI TDMS", "npTDMS", _RIG),
    "pymatreader": ("MATLAB", "pymatreader", _RIG),
    "pyuff": ("UFF dataset 58", "pyuff", _RIG),
    "soundfile": ("WAV", "soundfile", _RIG),
    "nidaqmx": ("a device of National Instruments", "nidaqmx", _NI),
    "foxglove": ("serving Foxglove", "foxglove-sdk", _FOXGLOVE),
    "grpc_tools": ("compiling the schemas", "grpcio-tools", _DEV),
}
"""By the name that is imported: what needs it, the package that brings it, and the command for the folder of vines."""


def need(module: str) -> None:
    """See that a package is there before it is imported.

    Parameters
    ----------
    module : str
        One of `OPTIONAL`.

    Raises
    ------
    PackageMissingError
        If it is not installed: what needs it, and what to install.

    Examples
    --------
    >>> need("matplotlib")
    """
    if find_spec(module) is None:
        purpose, package, install = OPTIONAL[module]
        text = f"{purpose} needs {package}, which is not installed; in the folder of vines: {install}"
        raise PackageMissingError(text, name=module)
