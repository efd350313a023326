"""Reconstructions as files: the same after a round trip, the same bytes, and one line for what is none."""

import dataclasses

import numpy as np
import pytest

from vines.errors import FileMissingError, RigError
from vines.rig import load_reconstruction, save_reconstruction


def same(one, other):
    """Say whether two parts of a reconstruction are alike, arrays to the last bit."""
    if dataclasses.is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one)
        )
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.tobytes() == other.tobytes()
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other or (one != one and other != other)


def test_round_trip(dwell, tmp_path):
    save_reconstruction(dwell, tmp_path / "a.npz")
    again = load_reconstruction(tmp_path / "a.npz")
    assert same(again, dwell)
    save_reconstruction(again, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_what_is_no_reconstruction_is_one_line(dwell, tmp_path):
    with pytest.raises(FileMissingError, match="no such file"):
        load_reconstruction(tmp_path / "none.npz")
    save_reconstruction(dwell, tmp_path / "a.npz")
    data = (tmp_path / "a.npz").read_bytes()
    np.savez(tmp_path / "other.npz", form=np.frombuffer(b'{"run": 1}', np.uint8))
    (tmp_path / "cut.npz").write_bytes(data[: len(data) // 2])
    (tmp_path / "text.npz").write_text("nothing")
    (tmp_path / "refused.npz").symlink_to("/proc/self/mem")  # the system refuses to read it
    for name, says in (
        ("other", "is no reconstruction of this version of vines: "),
        ("text", "is no reconstruction of this version of vines: "),
        ("cut", "is damaged (File is not a zip file)"),
        ("refused", "cannot be read: Input/output error"),
    ):
        with pytest.raises(RigError) as caught:
            load_reconstruction(tmp_path / f"{name}.npz")
        assert str(caught.value).startswith(f"{tmp_path / name}.npz {says}")
        assert "\n" not in str(caught.value)
