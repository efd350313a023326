"""Ctrl-C while the command line is loaded, before it can do anything: one line, exit code 130, no traceback."""

import subprocess
import sys

import pytest

LOADED = """
import importlib.abc, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Stop(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == {module!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Stop())
sys.argv = ["vines", "tables"]
from vines.cli import main
main()
"""


@pytest.mark.parametrize(
    "module",
    ["click", "vines.cli._supervised", "vines.cli._app", "vines.errors", "vines.cli._tables", "vines.schema"],
)
def test_ctrl_c_while_it_is_loaded(module):
    said = subprocess.run(
        [sys.executable, "-c", LOADED.format(module=module)], capture_output=True, text=True, timeout=60, check=False
    )
    assert (said.returncode, said.stdout, said.stderr) == (130, "", "vines: stopped\n")
