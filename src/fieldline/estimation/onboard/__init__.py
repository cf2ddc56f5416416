"""Attitude on board, reading by reading: from nothing known to a filter that watches itself."""

from fieldline.estimation.onboard.estimator import OnboardEstimator

__all__ = ["OnboardEstimator"]
