"""Stages of a rig, and the same by hand for one run."""
