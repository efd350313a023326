"""Settings of the compiler, made before numba is imported, because numba reads them then."""

from __future__ import annotations

import os

import llvmlite.binding

__all__ = ["TARGET", "WIDE", "numba"]

WIDE = "+avx512f" in llvmlite.binding.get_host_cpu_features().flatten()
"""Whether the processor has vectors of eight doubles; LLVM would use only half of each unless told to."""

if WIDE and "NUMBA_CPU_FEATURES" not in os.environ and "NUMBA_CPU_NAME" not in os.environ:
    os.environ["NUMBA_CPU_NAME"] = llvmlite.binding.get_host_cpu_name()
    os.environ["NUMBA_CPU_FEATURES"] = llvmlite.binding.get_host_cpu_features().flatten() + ",-prefer-256-bit"

import numba  # noqa: E402 - only now
import numba.core.config as settings  # noqa: E402

# Somebody may have imported numba before; it asks for these when it compiles for the first time.
settings.CPU_NAME = os.environ.get("NUMBA_CPU_NAME")  # pyright: ignore[reportAttributeAccessIssue]
settings.CPU_FEATURES = os.environ.get("NUMBA_CPU_FEATURES")  # pyright: ignore[reportAttributeAccessIssue]

TARGET = " ".join(
    (
        numba.__version__,
        os.environ.get("NUMBA_CPU_NAME") or llvmlite.binding.get_host_cpu_name(),
        os.environ.get("NUMBA_CPU_FEATURES") or llvmlite.binding.get_host_cpu_features().flatten(),
    )
)
"""What machine code is made by and for: version of numba, processor and its features."""
