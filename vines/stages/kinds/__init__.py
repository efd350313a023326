"""Kinds of stages, a file each: light specifications, without numpy, numba, pyarrow, rerun or matplotlib."""
