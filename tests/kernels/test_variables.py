"""The variables of a statement are found quickly, and are those that numba's own way finds, in its order."""

import pytest
from numba.core import compiler, ir

import vines.kernels  # noqa: F401 - which replaces numba's way


def plainly(val):
    """Return the variables in a part of a statement, as numba looks for them."""
    if isinstance(val, ir.Var):
        return [val]
    if isinstance(val, ir.Expr):
        return plainly(val._kws)
    if isinstance(val, ir.Inst):
        return plainly(val.__dict__)
    if isinstance(val, dict):
        return [each for part in val.values() for each in plainly(part)]
    if isinstance(val, list | tuple):
        return [each for part in val for each in plainly(part)]
    return []


def loops(values, n):
    total = 0.0
    for k in range(n):
        if values[k] > 0.0:
            total += max(values[k], 1.0, *values[:2])
        values[k + 1], values[0] = total, -total
    return {"total": total, "list": [total, n]}


def calls(f, *more):
    f(*more)
    f(more, key=f)
    assert f is not None, "text"
    return f"{f}", (more, None, True, 1.5), [f, more]


@pytest.mark.parametrize("function", [loops, calls])
def test_they_are_those_that_numba_finds(function):
    statements = [each for block in compiler.run_frontend(function).blocks.values() for each in block.body]
    assert len(statements) > 20
    for each in statements:
        assert each.list_vars() == plainly(each)
        if isinstance(each, ir.Assign) and isinstance(each.value, ir.Expr):
            assert each.value.list_vars() == plainly(each.value)
