"""Axes, rotations and time."""
