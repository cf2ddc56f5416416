"""The cone by least squares on the measured vector itself: elliptical, in a turning field, with no filter to settle or lag.

Over a window about t_m the body's axes are (U, V, W) turned by a small rotation with slow parts and harmonics,

    theta(t) = sum_k p_k x^k + (Re z1 e^{i w (t - t_m)}, Re z2 e^{i w (t - t_m)}, 0) + other lines,   x = (t - t_m) / half    (1)

and the measured field, brought to the known magnitude, differs from the known one by

    |B| / |b| b - B = -theta x B                                                                               (2)

which is linear in p and z. Slow parts of theta take up biases, yaw, and whatever direction error the known field has, as long
as it is slow: none is assumed constant beyond the window. Scale errors drop out of (2). The ellipse is free. At an instant
nothing is seen of a rotation about B; over a window with the field level, that is a tilt across the plane of field and
vertical, so the covariance there grows, and says so.

With `rounds` above 1 the known field is turned by the slow part found, window by window, and the rest fitted anew: what is
left of theta is then small however wrong the known field is, and the phasors are along the body's own axes, which a yaw
turns against (U, V). The slow part is then seen in `azimuth_off_rad`.

Each window has the covariance of its residual, times what their correlation from sample to sample takes from their number.

Linear in what is left of theta: errors of its square, 1e-3 of the tilt at 3 deg.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.bandpass import as_series, positive
from fieldline.estimation.skiprope.signals import FieldGeometry, corrected_signals, field_vector
from fieldline.estimation.skiprope.spectrum import strongest_line
from fieldline.estimation.skiprope.tuning import tune

WINDOW_PERIODS = 3.0
MEMORY_PERIODS = 10.0
PENDULOUS = (3.0, 20.0)  # times the cone's frequency


class HarmonicCone(NamedTuple):
    """m windows; phasors of (a1, a2) at their middles."""

    frequency_hz: float
    middle_s: np.ndarray  # (m,)
    phasor: np.ndarray  # (m, 2) complex [rad]
    covariance: np.ndarray  # (m, 4, 4) [rad^2] of Re z1, Im z1, Re z2, Im z2
    yaw_rad: np.ndarray  # (m,) slow part about W
    window_s: float
    azimuth_off_rad: np.ndarray  # (m,) azimuth of the known field less that of the measured one's slow part


def harmonic_cone(
    seconds,
    field_b,
    geometry: FieldGeometry,
    first_frequency_hz: float,
    *,
    memory_s: float | None = None,
    damping: float = 0.1,
) -> HarmonicCone:
    """The cone from a first guess at its frequency: tuned, fitted in windows, its frequency refined, smoothed.

    The bandpass filters give the frequency and the pendulous line (the strongest of C3 from three to twenty times as high);
    windows of three periods with quadratic slow parts give the phasors, twice, with the frequency refined between.

    Parameters
    ----------
    seconds, field_b, geometry : as in `fit_harmonics`. first_frequency_hz, damping : as in `tune`.
    memory_s : over which the ellipse may change, see `smoothed`; ten periods by default, 0 for windows by themselves.

    Errors: as those of `tune` and `fit_harmonics`.
    """
    corrected = corrected_signals(field_b, geometry)
    frequency = tune(seconds, corrected, first_frequency_hz, damping, method="linear").passes[-1].read_hz
    lines = (strongest_line(seconds, corrected[:, 2], *(many * frequency for many in PENDULOUS)),)
    for _ in range(2):
        cone = fit_harmonics(seconds, field_b, geometry, frequency, other_lines_hz=lines)
        frequency = refined_frequency(cone)
    cone = fit_harmonics(seconds, field_b, geometry, frequency, other_lines_hz=lines)
    memory = MEMORY_PERIODS / frequency if memory_s is None else memory_s
    return smoothed(cone, memory) if memory > 0.0 else cone


def fit_harmonics(
    seconds,
    field_b,
    geometry: FieldGeometry,
    frequency_hz: float,
    *,
    window_s: float | None = None,
    step_s: float | None = None,
    degree: int = 2,
    other_lines_hz=(),
    rounds: int = 1,
) -> HarmonicCone:
    """Equation (2) in windows along a record.

    Parameters
    ----------
    seconds : (n,) [s]. field_b : (n, 3) [T], body axes, as measured. geometry : the known field's.
    frequency_hz : w / 2 pi, positive. window_s, step_s : three periods every half period by default.
    degree : of the slow parts. other_lines_hz : of motions besides, such as the pendulous one. rounds : see above.

    Errors: InputError for arguments; NoEstimateError where the record is shorter than a window.
    """
    times, measured = as_series(seconds, field_b)
    period = 1.0 / positive("frequency_hz", frequency_hz)
    window, step = WINDOW_PERIODS * period if window_s is None else window_s, 0.5 * period if step_s is None else step_s
    known = field_vector(geometry)
    if measured.shape != known.shape:
        raise InputError(f"field_b {measured.shape} and the known field {known.shape} must have one row for each sample.")
    with np.errstate(invalid="ignore", divide="ignore"):
        off = measured * (geometry.magnitude_tesla / np.linalg.norm(measured, axis=1))[:, None] - known
    good = np.isfinite(off).all(axis=1)
    off, unit = off[good] / geometry.magnitude_tesla[good, None], known[good] / geometry.magnitude_tesla[good, None]
    times = times[good]
    rows = []
    middles = np.arange(times[0] + 0.5 * window, times[-1] - 0.5 * window + 1e-6, step) if len(times) else ()
    for middle in middles:
        first, last = np.searchsorted(times, (middle - 0.5 * window, middle + 0.5 * window + 1e-9))
        if last - first < 0.5 * window / max(np.median(np.diff(times)), 1e-9):
            continue
        columns = _motions(times[first:last] - middle, 0.5 * window, degree, frequency_hz, other_lines_hz)
        rows.append((middle, *_solved_again(columns, off[first:last], unit[first:last], degree, rounds)))
    if not rows:
        raise NoEstimateError(f"no window of {window:.0f} s is at least half full of good samples; give a longer record.")
    middle, phasor, covariance, yaw, azimuth_off = map(np.array, zip(*rows, strict=True))
    return HarmonicCone(float(frequency_hz), middle, phasor, covariance, yaw, float(window), azimuth_off)


def smoothed(cone: HarmonicCone, memory_s: float) -> HarmonicCone:
    """Each window's phasors from all windows, weighed by their information and by exp(-(t - t_m)^2 / 2 memory^2).

    A window in which the field is level sees half of the cone badly; its neighbours, with the field inclined, see it
    well. Right for a cone whose ellipse changes little over `memory_s` [s]. The covariance counts windows that share samples
    once: it is that of the sum, times how many share each sample.
    """
    frame = np.exp(2j * np.pi * cone.frequency_hz * (cone.middle_s - cone.middle_s[0]))
    still = cone.phasor / frame[:, None]
    turn = turns(1.0 / frame)
    information = np.linalg.inv(turn @ cone.covariance @ turn.transpose(0, 2, 1))
    values = np.stack([still[:, 0].real, still[:, 0].imag, still[:, 1].real, still[:, 1].imag], axis=1)
    weighed = np.einsum("nij,nj->ni", information, values)
    near = np.exp(-0.5 * ((cone.middle_s[:, None] - cone.middle_s) / positive("memory_s", memory_s)) ** 2)
    covariance = np.linalg.inv(np.einsum("mn,nij->mij", near, information))
    found = np.einsum("mij,mj->mi", covariance, near @ weighed)
    phasor = np.stack([found[:, 0] + 1j * found[:, 1], found[:, 2] + 1j * found[:, 3]], axis=1) * frame[:, None]
    back = turns(frame)
    shared = cone.window_s / np.median(np.diff(cone.middle_s)) if len(cone.middle_s) > 1 else 1.0
    return cone._replace(phasor=phasor, covariance=max(shared, 1.0) * (back @ covariance @ back.transpose(0, 2, 1)))


def refined_frequency(cone: HarmonicCone) -> float:
    """[Hz] by the advance of the phase of the stronger circular part from window to window, weighed by information."""
    parts = circular_parts(cone.phasor)
    main = parts[:, int(np.abs(parts).mean(axis=0).argmax())]
    phase = np.unwrap(np.angle(main * np.exp(-2j * np.pi * cone.frequency_hz * (cone.middle_s - cone.middle_s[0]))))
    if len(phase) < 2:
        return cone.frequency_hz
    weight = 1.0 / np.sqrt(np.trace(cone.covariance, axis1=1, axis2=2))
    return cone.frequency_hz + float(np.polyfit(cone.middle_s, phase, 1, w=weight)[0] / (2.0 * np.pi))


def circular_parts(phasor) -> np.ndarray:
    """(m, 2) complex: the parts (z1 + i z2) / 2 that turns with w > 0 and (z1 - i z2) / 2 that turns back."""
    z1, z2 = phasor[:, 0], phasor[:, 1]
    return np.stack([0.5 * (z1 + 1j * z2), 0.5 * (z1 - 1j * z2)], axis=1)


def cone_at(cone: HarmonicCone, seconds) -> np.ndarray:
    """(n, 2) [rad]: the tilt of the body's axis along (U, V), that is (a2, -a1), at times (n,) [s].

    Between the middles of two windows their answers are mixed in proportion; outside, the nearest is carried on.
    """
    times = np.asarray(seconds, dtype=float)
    w = 2.0 * np.pi * cone.frequency_hz
    slow = cone.phasor * np.exp(-1j * w * (cone.middle_s - cone.middle_s[0]))[:, None]
    now = [np.interp(times, cone.middle_s, part) for z in slow.T for part in (z.real, z.imag)]
    turned = np.exp(1j * w * (times - cone.middle_s[0]))
    a1, a2 = ((re + 1j * im) * turned for re, im in (now[:2], now[2:]))
    return np.stack([a2.real, -a1.real], axis=-1)


def _motions(t, half: float, degree: int, frequency_hz: float, other_lines_hz) -> np.ndarray:
    """(n, 3, k): theta of each unknown. First the harmonics (4), then slow parts (3 a power), then other lines (4 each)."""
    shapes = []
    for hz in (frequency_hz, *other_lines_hz):
        c, s = np.cos(2.0 * np.pi * hz * t), np.sin(2.0 * np.pi * hz * t)
        shapes.append([(axis, wave) for axis in (0, 1) for wave in (c, -s)])
    slow = [(axis, (t / half) ** power) for power in range(degree + 1) for axis in range(3)]
    listed = [*shapes[0], *slow, *(one for line in shapes[1:] for one in line)]
    theta = np.zeros((len(t), 3, len(listed)))
    for k, (axis, values) in enumerate(listed):
        theta[:, axis, k] = values
    return theta


def turns(factor) -> np.ndarray:
    """(m, 4, 4): a multiplication of both phasors by unit complex numbers (m,), on their real and imaginary parts."""
    turn = np.zeros((len(factor), 4, 4))
    for k in (0, 2):
        turn[:, k, k] = turn[:, k + 1, k + 1] = factor.real
        turn[:, k, k + 1], turn[:, k + 1, k] = -factor.imag, factor.imag
    return turn


def _solved_again(theta, off, unit, degree: int, rounds: int):
    """Phasors, covariance, yaw and azimuth of a window, the known directions `unit` (n, 3) turned by the slow part in turn."""
    measured, known, yaw = off + unit, unit, 0.0
    slow = slice(4, 4 + 3 * (degree + 1))
    middle = len(unit) // 2
    for last in range(max(rounds, 1) - 1, -1, -1):
        found, covariance = _solved(theta, measured - unit, unit)
        yaw += found[6]
        unit = _turned(unit, -theta[:, :, slow] @ found[slow])
        if not last:
            break
    azimuth = np.arctan2(-known[middle, 0], known[middle, 1]) - np.arctan2(-unit[middle, 0], unit[middle, 1])
    azimuth = (azimuth + np.pi) % (2.0 * np.pi) - np.pi
    return np.array([found[0] + 1j * found[1], found[2] + 1j * found[3]]), covariance, yaw, azimuth


def _turned(vectors, angles) -> np.ndarray:
    """(n, 3) vectors turned by rotation vectors (n, 3) [rad], exactly."""
    size = np.linalg.norm(angles, axis=1, keepdims=True)
    axis = angles / np.maximum(size, 1e-300)
    along = axis * np.sum(axis * vectors, axis=1, keepdims=True)
    return along + np.cos(size) * (vectors - along) + np.sin(size) * np.cross(axis, vectors)


def _solved(theta, off, unit):
    """All unknowns of a window by (2), and the covariance of its phasors."""
    turned = -np.cross(theta, unit[:, :, None], axisa=1, axisb=1, axisc=1)
    matrix, target = turned.reshape(-1, theta.shape[2]), off.reshape(-1)
    inverse = np.linalg.pinv(matrix.T @ matrix, rcond=1e-12, hermitian=True)
    found = inverse @ (matrix.T @ target)
    left = (target - matrix @ found).reshape(off.shape)
    free = max(2 * len(left) - len(found), 1)  # the magnitude is taken out: two numbers a sample
    alike = np.sum(left[1:] * left[:-1]) / max(np.sum(left**2), 1e-300)
    inflation = (1.0 + max(alike, 0.0)) / max(1.0 - alike, 1e-2)
    covariance = inverse[:4, :4] * (np.sum(left**2) / free * inflation)
    return found, covariance
