"""Pandas is loaded late, and pyarrow knows of it whenever it is: what belongs to pandas is read as that."""

import subprocess
import sys

import pytest

ASKED = """
import sys
from importlib.util import find_spec
from vines.late_pandas import load_pandas_late
BEFORE
load_pandas_late()
load_pandas_late()
import pyarrow as pa
pa.array([1, 2])
assert "pandas" not in sys.modules
assert find_spec("pandas") is not None
assert "pandas" not in sys.modules
BETWEEN
import pandas
print(pa.array(pandas.Series([1.0, float("nan")])).null_count, len(pa.table({"a": [1]}).to_pandas()))
print([type(finder).__name__ for finder in sys.meta_path].count("_AfterImport"))
"""


@pytest.mark.parametrize("before", ["", "import pyarrow"])
@pytest.mark.parametrize("between", ["", "pa.table({'a': [1]}).to_pandas()", "load_pandas_late()"])
def test_pyarrow_knows_pandas_as_soon_as_it_is_there(before, between):
    program = ASKED.replace("BEFORE", before).replace("BETWEEN", between)
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (said.stdout, said.stderr) == ("1 1\n0\n", "")
