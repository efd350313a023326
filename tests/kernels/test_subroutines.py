"""What numba compiles of its own for kernels follows the rule of rounding of each, whichever asked first."""

import re

import numba
import numpy as np

import vines.kernels  # noqa: F401 - sets up numba


def test_products_of_complex_numbers_follow_the_rule_of_the_kernel_they_are_in():
    # Not by the decorators of vines: their cache would bring what an earlier process compiled.
    fused, plain = (numba.njit(lambda z, w: z * w, fastmath=rule) for rule in ({"contract", "nsz"}, False))
    rng = np.random.default_rng(1)
    pairs = (rng.normal(size=(200, 4)) @ np.array([[1, 0], [1j, 0], [0, 1], [0, 1j]])).tolist()
    assert np.allclose([fused(z, w) for z, w in pairs], [z * w for z, w in pairs], rtol=1e-14)
    assert [plain(z, w) for z, w in pairs] == [z * w for z, w in pairs]
    for kernel, few in ((fused, True), (plain, False)):
        (code,) = kernel.inspect_llvm().values()
        assert bool(re.search(r"fmul [a-z ]*contract", code)) is few
