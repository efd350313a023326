"""A reconstruction as a file, so that what needs it later does not reconstruct again."""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import msgspec
import numpy as np

from vines.errors import FileMissingError, RigError
from vines.rig.quantities import Reconstruction

__all__ = ["load_reconstruction", "save_reconstruction"]

_FORM = "form"


def save_reconstruction(found: Reconstruction, path: Path) -> None:
    """Write a reconstruction as ``.npz``: its arrays, and the rest as JSON under ``form``; equal ones give equal bytes.

    Parameters
    ----------
    found : Reconstruction
    path : Path
        An existing file is replaced.
    """
    arrays: list[np.ndarray] = []

    def plain(value: object) -> Any:
        if isinstance(value, np.ndarray):
            arrays.append(value)
            return {"array": len(arrays) - 1}
        if isinstance(value, complex):
            return {"re": value.real, "im": value.imag}
        if isinstance(value, np.generic):
            return value.item()
        raise TypeError(f"{type(value).__name__} is no part of a reconstruction")

    form = json.dumps(msgspec.to_builtins(found, enc_hook=plain))
    named: Any = {f"array_{k:02d}": values for k, values in enumerate(arrays)}
    with path.open("wb") as file:
        np.savez_compressed(file, **{_FORM: np.frombuffer(form.encode(), dtype=np.uint8)}, **named)


def load_reconstruction(path: Path) -> Reconstruction:
    """Read what `save_reconstruction` wrote.

    Raises
    ------
    FileMissingError
        If there is no such file.
    RigError
        If it cannot be read, is damaged, is no reconstruction, or was written by another version of vines.
    """
    if not path.is_file():
        raise FileMissingError(f"{path}: there is no such file; 'vines rig reconstruct RUN' makes one")

    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as held:
            form = json.loads(held[_FORM].tobytes())

            def whole(kind: Any, value: Any) -> Any:
                return complex(value["re"], value["im"]) if kind is complex else held[f"array_{value['array']:02d}"]

            return msgspec.convert(form, Reconstruction, dec_hook=whole)
    except OSError as error:
        raise RigError(f"{path} cannot be read: {error.strerror or error}") from None
    except (BadZipFile, EOFError, zlib.error) as error:
        raise RigError(f"{path} is damaged ({error}); 'vines rig reconstruct RUN' makes it again") from None
    except (ValueError, KeyError, TypeError) as error:
        # msgspec's and json's errors are ValueErrors.
        raise RigError(f"{path} is no reconstruction of this version of vines: {str(error).splitlines()[0]}") from None
