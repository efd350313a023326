"""Plots, a file each, and what they share: from rows of stages to panels."""
