"""What a stencil of samples can tell at all: the error of the circle's angle foretold from noise, step and spin.

The attitude lives in the turning of the field along the orbit, r = lambda_R / f = |dB_R| sin psi_R / |B_R|, some 0.05 to
0.15 deg/s; the body's own spin w is what it must be told apart from. With the errors e1 [T/s] and e2 [T/s^2] of the two
derivatives of the body's field, noise and bias together,

    sigma_Phi^2 = (e1 / (|B| r))^2 + (e2 / (|B| r max(w, r)))^2                                       (1)

Orders of magnitude, within a factor of about three of what was measured. Beyond one radian there is no answer, and most
often no real root either: three samples with digits of 6.44 mG of a body that turns at 10 to 50 deg/s hold none at any
step, since a step long enough for the digits is far too long for the spin.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.natanson.derivatives import difference_error

ANSWER_MAX_RAD = 1.0


def expected_angle_error(step_s, noise_tesla, magnitude_tesla, spin_rad_s, field_turn_rad_s, points: int = 3) -> float:
    """sigma_Phi [rad] of equation (1) for central differences over `points` samples that lie step_s apart."""
    first, second = difference_error(step_s, noise_tesla, magnitude_tesla, spin_rad_s, points).total
    reach = magnitude_tesla * field_turn_rad_s
    return float(np.hypot(first / reach, second / (reach * max(spin_rad_s, field_turn_rad_s))))


def three_sample_verdict(step_s, noise_tesla, magnitude_tesla, spin_rad_s, field_turn_rad_s, points: int = 3) -> tuple[bool, str]:
    """Whether a deterministic attitude can be had from so many samples, and a sentence that says why or why not."""
    fixed = (magnitude_tesla, spin_rad_s, field_turn_rad_s, points)
    error = expected_angle_error(step_s, noise_tesla, *fixed)
    spin, digits = f"{np.degrees(spin_rad_s):.3g} deg/s", f"a noise of {noise_tesla * 1e9:.3g} nT"
    if error < ANSWER_MAX_RAD:
        return True, f"expected error about {np.degrees(error):.2g} deg at {spin} with {digits} and a step of {step_s:g} s"
    steps = np.geomspace(1e-3, 1e3, 200)
    errors = [expected_angle_error(step, noise_tesla, *fixed) for step in steps]
    best = int(np.argmin(errors))
    if errors[best] < ANSWER_MAX_RAD:
        return False, (
            f"{points} samples {step_s:g} s apart hold no answer at {spin} with {digits}; the best step is about "
            f"{steps[best]:.2g} s, with an expected error of {np.degrees(errors[best]):.2g} deg"
        )
    return False, (
        f"{points} samples of a body that turns at {spin} hold no answer with {digits}, at any step: the attitude lives in the "
        f"field's own turning, {np.degrees(field_turn_rad_s):.2g} deg/s, which the samples cannot tell from the spin. Use a "
        "longer arc: the spin from the spectrum, then a fit over a window with the body's inertia"
    )
