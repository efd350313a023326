"""The error map of the reduced model: panels, scales, marks, and bytes that repeat."""

import numpy as np
import pytest

from vines.errors import DeclarationError
from vines.figures import ERRORS, ErrorMap, reduced_figure, save


def chart(name="mu"):
    x, y = np.geomspace(0.001, 0.1, 20), np.linspace(0.01, 0.03, 15)
    error = np.outer(y, x) * 40 - 0.01
    error[:3, :5] = np.nan
    valid = np.broadcast_to(y[:, None] < 0.02, error.shape)
    return ErrorMap(
        (name, "A"),
        x,
        y,
        dict.fromkeys(ERRORS, error),
        valid,
        np.broadcast_to(y[:, None] - 0.015, error.shape),
        "r = 0.65",
    )


def test_a_row_a_panel_and_a_column_a_map():
    figure = reduced_figure([chart(), chart("Omega")], panels=("max_abs_x1", "phase"))
    charts = [ax for ax in figure.axes if ax.get_xlabel()]
    assert [ax.get_xlabel() for ax in charts] == 2 * [r"mass ratio  $\mu$", r"frequency ratio  $\Omega$"]
    assert {ax.get_xscale() for ax in charts} == {"log"}
    assert {ax.get_yscale() for ax in charts} == {"linear"}
    bars = [ax.get_ylabel() for ax in figure.axes if "error" in ax.get_ylabel()]
    assert bars == [ERRORS["max_abs_x1"], ERRORS["phase"]]
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 3


def test_files_are_the_same_bytes_each_time(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save(reduced_figure([chart()]), tmp_path / name)
    for suffix in ("png", "svg"):
        one, two = ((tmp_path / n / f"picture.{suffix}").read_bytes() for n in ("one", "two"))
        assert one == two


def test_mistakes_are_told_in_one_line():
    with pytest.raises(DeclarationError, match="did you mean 'phase'"):
        reduced_figure([chart()], panels=("phse",))
    with pytest.raises(DeclarationError, match="here is none"):
        reduced_figure([])
