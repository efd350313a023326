"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported."""

from vines.rig._recording import ROLES, Recording, RunInfo, Sampled, Uncertain

__all__ = ["ROLES", "Recording", "RunInfo", "Sampled", "Uncertain"]
