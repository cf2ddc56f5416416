"""The verdict: one sentence that a person can act on, and the same in plain types for a machine.

A result is usable when the filter follows the data, one motion is clearly the likeliest, and its stated uncertainty is
small enough to mean something. Otherwise the sentence says which of these fails, and what would help.
"""

from __future__ import annotations

import numpy as np

from fieldline.errors import NoEstimateError

LARGEST_STD_DEG = 30.0  # about the worst axis, in the median: beyond, the attitude is a guess
LARGEST_MISFIT_DEG = 15.0  # RMS angle between measured and predicted field: beyond, the motion does not explain the data
LARGEST_MAGNITUDE_SHARE = 0.08  # of the field: ten times what a poor calibration leaves
RIVAL_ANGLE_DEG = 20.0
RIVAL_LIKELIHOOD = 6.0  # of the logarithm, after the innovations' memory is taken off


def refuse_magnitude(residual_tesla: float, field_tesla: float) -> None:
    """NoEstimateError where even the calibrated magnitude does not follow the model's along the orbit."""
    share = residual_tesla / field_tesla
    if share > LARGEST_MAGNITUDE_SHARE:
        raise NoEstimateError(
            f"No usable attitude: even the magnitude of the calibrated field misses the model's by {100 * share:.0f} % RMS, "
            "which no attitude can mend. Check that orbit and time stamps (UTC) belong to this satellite, the unit, and the "
            "calibration."
        )


def degrees(value: float) -> str:
    """0.24°, 3.1°, 130°: two digits, never an exponent."""
    return f"{float(f'{value:.2g}'):g}°" if value < 1e4 else "unknown"


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n,) [rad] between rows."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))


def judge_usable(
    std_deg: np.ndarray, worst_deg: float, misfit_deg: float, halves_deg: float, rivals: list[str], consistency: dict
) -> tuple[bool, str]:
    """Whether the estimate may be used, and the sentence."""
    attitude = " ".join(degrees(v) for v in std_deg)
    stated = f"attitude known to {attitude} (1σ about body x, y, z; median over the arc, {degrees(worst_deg)} at worst)"
    if misfit_deg > LARGEST_MISFIT_DEG:
        return False, (
            f"No usable attitude: the best motion misses the measured field's direction by {misfit_deg:.0f}° RMS. "
            "Check that orbit, time stamps (UTC), axes and units belong to this satellite."
        )
    if halves_deg > RIVAL_ANGLE_DEG:
        return False, (
            f"No usable attitude: the halves of the arc, estimated apart, disagree by {degrees(halves_deg)} where they meet, "
            "more than their uncertainty allows. Something acts that neither a wandering rate nor a rigid body describes."
        )
    if rivals:
        return False, (
            f"No single attitude: {len(rivals) + 1} motions explain these data about equally well ({'; '.join(rivals)}). "
            "A longer arc, or one over which the field turns further, would tell them apart."
        )
    if float(np.max(std_deg)) > LARGEST_STD_DEG:
        return False, (
            f"No usable attitude: {stated}. The arc is too short, or the field turns too little over it, to see the turn "
            "about the field. A longer arc would help."
        )
    if consistency["words"].startswith("too optimistic"):
        return True, f"Usable with care: {stated}, but the filter is {consistency['words']}."
    return True, f"Usable: {stated}."
