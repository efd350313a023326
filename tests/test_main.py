"""``python -m vines`` is the command line."""

import runpy
import sys

import pytest

import vines


def test_the_package_runs_as_the_command_line(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["vines", "--version"])
    monkeypatch.setattr("vines.cli._app.go_on_in_a_child", lambda *remedy, **patience: None)
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("vines", run_name="__main__")
    assert (ended.value.code, capsys.readouterr().out) == (0, f"vines, version {vines.__version__}\n")
