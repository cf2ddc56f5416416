"""Attitude and rate from a magnetometer alone, with no prior knowledge: Natanson, McLaughlin and Nicklas (1990)."""
