"""Attitude and rate from a magnetometer alone, with no prior knowledge: Natanson, McLaughlin and Nicklas (1990)."""

from fieldline.estimation.natanson.candidates import Candidate, Candidates, natanson_candidates
from fieldline.estimation.natanson.choice import constant_rate_loss, least_loss, rigid_loss, take
from fieldline.estimation.natanson.circle import Circle, uncertainty_circle
from fieldline.estimation.natanson.constant_rate import Roots, Status, constant_rate_roots
from fieldline.estimation.natanson.derivatives import (
    Derivatives,
    ExpectedError,
    best_cutoff_rad_s,
    best_step_samples,
    best_window_s,
    difference_error,
    finite_differences,
    local_polynomial,
    polynomial_error,
    seen_in_body,
    smoothing_spline,
    spline_error,
)
from fieldline.estimation.natanson.general import b_dot_torque, gravity_gradient_of_attitude, rigid_body_roots
from fieldline.estimation.natanson.limits import expected_angle_error, three_sample_verdict
from fieldline.estimation.natanson.window_fit import WindowFit, fit_window, propagate, starts_on_circle

__all__ = [
    "natanson_candidates",
    "Candidate",
    "Candidates",
    "constant_rate_roots",
    "rigid_body_roots",
    "Roots",
    "Status",
    "b_dot_torque",
    "gravity_gradient_of_attitude",
    "uncertainty_circle",
    "Circle",
    "constant_rate_loss",
    "rigid_loss",
    "least_loss",
    "take",
    "Derivatives",
    "ExpectedError",
    "seen_in_body",
    "finite_differences",
    "local_polynomial",
    "smoothing_spline",
    "difference_error",
    "polynomial_error",
    "spline_error",
    "best_step_samples",
    "best_window_s",
    "best_cutoff_rad_s",
    "expected_angle_error",
    "three_sample_verdict",
    "fit_window",
    "WindowFit",
    "propagate",
    "starts_on_circle",
]
