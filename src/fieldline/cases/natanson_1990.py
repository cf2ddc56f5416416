"""Natanson, McLaughlin and Nicklas (1990): attitude from magnetometer data only, their tests remade.

The paper's section 4 on the synthetic arc of `erbs_like`: noise-free at steps of 8 and 16 s (figures 2 to 5), digits of
6.44 mG at 240 s (figures 8 to 10), oscillating rates at 120 and 240 s (figures 6, 7, 11, 12). `run` returns all of it for
any step, digit, rate, oscillation or smoothing; the rows below give the sets behind each figure.

    figures 2 to 5    run(step_s=16, quantisation_tesla=0)
    figures 8 to 10   run(step_s=240, oscillation=True)
    figures 11, 12    run(step_s=120, quantisation_tesla=0, oscillation=True)
    beyond the paper  run(smoothing="polynomial", window_s=960, fit_s=960)

Source: Natanson, McLaughlin and Nicklas (1990), Flight Mechanics/Estimation Theory Symposium, NASA CP-3102, N91-17.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.erbs_like import ATTITUDES, LENGTH_S, Arc, erbs_like_arc, number
from fieldline.errors import InputError
from fieldline.estimation.natanson.choice import ROBUST_REACH, constant_rate_loss, least_loss, take
from fieldline.estimation.natanson.constant_rate import WORDS, Roots, Status, constant_rate_roots
from fieldline.estimation.natanson.derivatives import Derivatives, finite_differences, local_polynomial, smoothing_spline
from fieldline.estimation.natanson.limits import three_sample_verdict
from fieldline.estimation.natanson.window_fit import fit_window
from fieldline.frames.attitude import rotation_error_b

OSCILLATION_DEG_S = 0.01  # as a vector; not in the paper
SMOOTHINGS = (None, "polynomial", "spline")
CHOICES = ("paper", "robust", "nearest")
UNITS = {
    "omega": ("rad s-1", "body rate with respect to inertial axes, body axes"),
    "euler": ("deg", "Euler angles of the (212') sequence, A = R2 R1 R2"),
    "error": ("deg", "angle of the attitude error"),
}


def run(
    *,
    step_s: float = 240.0,
    quantisation_tesla: float = 6.44e-7,
    rate_deg_s=(-0.018, 0.049, -0.034),
    oscillation: bool = False,
    smoothing: str | None = None,
    points: int = 3,
    window_s: float = 960.0,
    order: int = 4,
    fit_s: float = 0.0,
    choice: str = "paper",
    beyond: str = "nan",
    attitude: str = "earth-pointing",
    ascending_node_deg: float = 0.0,
    argument_deg: float = 0.0,
    noise_tesla: float = 0.0,
    interval_s: float = 8.0,
    oscillation_deg_s: float = OSCILLATION_DEG_S,
    oscillation_period_s: float = 75.0,
    seed: int = 20,
    model: str = "IGRF-14",
):
    """The deterministic attitude along the arc, as an xarray Dataset with the truth beside it.

    Parameters
    ----------
    step_s : step of the finite differences [s], a multiple of interval_s; with smoothing, the step of the losses.
    quantisation_tesla : digit of the magnetometer [T]; 0 for none. noise_tesla : white noise besides, per axis.
    rate_deg_s : mean body rate. oscillation : whether oscillation_deg_s at oscillation_period_s is added to it.
    smoothing : None (differences over `points` = 3 or 5), "polynomial" (`order` over window_s) or "spline".
    fit_s : length of the least-squares window about each sample [s], from both roots; 0 for none.
    choice : which root `q_bi` gives: "paper" (3-14), "robust" (three steps to each side), "nearest" (needs the truth).
    beyond : what to give where the discriminant is negative: "nan", "nearest" or "previous" (the paper's).
    attitude : "earth-pointing" or "random" (from `seed`).

    Returns
    -------
    Dataset over time, root, axis, quaternion: the truth, both roots, discriminant, losses, errors of each choice.
    """
    _refuse(choice, CHOICES, "choice")
    _refuse(smoothing, SMOOTHINGS, "smoothing")
    _refuse(attitude, ATTITUDES, "attitude")
    number("fit_s", fit_s, 0.0, LENGTH_S)
    number("window_s", window_s, 1e-3, LENGTH_S)
    number("order", order, 2, 12)
    settings = {k: v for k, v in locals().items() if v is not None}
    arc = erbs_like_arc(
        rate_deg_s=rate_deg_s,
        oscillation_deg_s=oscillation_deg_s if oscillation else 0.0,
        oscillation_period_s=oscillation_period_s,
        quantisation_tesla=quantisation_tesla,
        noise_tesla=noise_tesla,
        attitude=attitude,
        ascending_node_deg=ascending_node_deg,
        argument_deg=argument_deg,
        interval_s=interval_s,
        seed=seed,
        model=model,
    )
    step_samples = _whole_steps(step_s, interval_s, len(arc.seconds))
    filters = {"step_samples": step_samples, "points": points, "smoothing": smoothing, "window_s": window_s, "order": order}
    body, inertial = (derivatives(arc.seconds, field, **filters) for field in (arc.measured_b, arc.field_i))
    roots = constant_rate_roots(body, inertial, beyond=beyond)
    dataset = _dataset(arc, roots, body, step_samples, choice)
    if fit_s > 0.0:
        _add_fits(dataset, arc, roots, fit_s, max(quantisation_tesla / np.sqrt(12.0), noise_tesla, 1e-12))
    dataset.attrs.update(_provenance(settings, roots))
    dataset.attrs["limits"] = _limits(arc, roots, step_s, np.hypot(quantisation_tesla / np.sqrt(12.0), noise_tesla), points)
    return dataset


def derivatives(seconds, field, *, step_samples, points, smoothing, window_s, order) -> Derivatives:
    """Derivatives by the case's filter; the spline's cutoff has the half-width of the polynomial's window."""
    if smoothing is None:
        return finite_differences(seconds, field, step_samples=step_samples, points=points)
    if smoothing == "polynomial":
        return local_polynomial(seconds, field, window_s=window_s, order=order)
    return smoothing_spline(seconds, field, cutoff_rad_s=6.0 / window_s)


def euler_212_deg(q_bi) -> np.ndarray:
    """(..., 3) [deg]: angles 1, 2, 3 with A = R2(angle 3) R1(angle 2) R2(angle 1); NaN stays NaN."""
    from scipy.spatial.transform import Rotation

    q = np.asarray(q_bi, dtype=float)
    angles = np.full((*q.shape[:-1], 3), np.nan)
    known = np.isfinite(q).all(axis=-1)
    if known.any():
        angles[known] = Rotation.from_quat(q[known]).as_euler("YXY", degrees=True)
    return angles


def attitude_error_deg(q_true, q_estimate) -> np.ndarray:
    """(...) [deg]: the angle between attitudes; NaN where there is no estimate."""
    estimate = np.asarray(q_estimate, dtype=float)
    true = np.broadcast_to(q_true, estimate.shape)
    error = np.full(estimate.shape[:-1], np.nan)
    known = np.isfinite(estimate).all(axis=-1)
    if known.any():
        error[known] = np.degrees(np.linalg.norm(rotation_error_b(true[known], estimate[known]), axis=-1))
    return error


def _dataset(arc: Arc, roots: Roots, body: Derivatives, step_samples: int, choice: str):
    """Truth, roots, losses and errors."""
    import xarray as xr

    losses = {
        "paper": constant_rate_loss(roots, arc.seconds, arc.measured_b, arc.field_i, step_samples=step_samples),
        "robust": constant_rate_loss(
            roots, arc.seconds, arc.measured_b, arc.field_i, step_samples=step_samples, reach=ROBUST_REACH
        ),
        "nearest": attitude_error_deg(arc.q_bi[:, None], roots.q_bi),
    }
    chosen = {name: least_loss(loss) for name, loss in losses.items()}
    q_bi = {name: take(roots.q_bi, index) for name, index in chosen.items()}
    variables = {
        "q_bi_true": (("time", "quaternion"), arc.q_bi),
        "omega_bi_b_true": (("time", "axis"), arc.omega_b, _about("omega")),
        "euler_true": (("time", "angle"), euler_212_deg(arc.q_bi), _about("euler")),
        "field_i": (("time", "axis"), arc.field_i, {"units": "T", "long_name": "field along the orbit", "axes": "i"}),
        "field_b_true": (("time", "axis"), arc.field_b, {"units": "T", "long_name": "field without digits", "axes": "b"}),
        "field_b": (("time", "axis"), arc.measured_b, {"units": "T", "long_name": "measured field", "axes": "b"}),
        "field_second_b": (("time", "axis"), body.second, {"units": "T s-2", "long_name": "its second derivative", "axes": "b"}),
        "q_bi": (("time", "quaternion"), q_bi[choice], {"long_name": f"attitude, choice of root: {choice}", "axes": "b in i"}),
        "omega_bi_b": (("time", "axis"), take(roots.omega_b, chosen[choice]), _about("omega")),
        "euler": (("time", "angle"), euler_212_deg(q_bi[choice]), _about("euler")),
        "angle_root": (("time", "root"), roots.angle_rad, {"units": "rad", "long_name": "Phi on the uncertainty circle"}),
        "q_bi_root": (("time", "root", "quaternion"), roots.q_bi),
        "omega_bi_b_root": (("time", "root", "axis"), roots.omega_b, _about("omega")),
        "error_root": (("time", "root"), losses["nearest"], _about("error")),
        "discriminant": ("time", roots.discriminant, {"units": "1", "long_name": "of (3-11), over Q^2 + R^2"}),
        "status": ("time", roots.status, {"long_name": "; ".join(f"{int(k)} {WORDS[k]}" for k in Status)}),
        "loss_paper": (("time", "root"), losses["paper"], {"units": "T s-1", "long_name": "loss (3-14), one step to each side"}),
        "loss_robust": (
            ("time", "root"),
            losses["robust"],
            {"units": "T s-1", "long_name": "loss over three steps to each side"},
        ),
    }
    for name in CHOICES:
        variables[f"error_{name}"] = ("time", attitude_error_deg(arc.q_bi, q_bi[name]), _about("error"))
        variables[f"chosen_{name}"] = ("time", chosen[name])
    coordinates = {
        "time": arc.time_utc,
        "seconds": ("time", arc.seconds),
        "axis": list("xyz"),
        "quaternion": list("xyzw"),
        "angle": [1, 2, 3],
    }
    return xr.Dataset(variables, coords=coordinates)


def _add_fits(dataset, arc: Arc, roots: Roots, fit_s: float, noise_tesla: float) -> None:
    """Least squares over fit_s about each sample that has a root and a whole window; the best of both starts."""
    half = round(0.5 * fit_s / (arc.seconds[1] - arc.seconds[0]))
    q_bi, sigma = np.full((len(arc.seconds), 4), np.nan), np.full(len(arc.seconds), np.nan)
    for k in range(half, len(arc.seconds) - half):
        known = np.isfinite(roots.q_bi[k]).all(axis=-1) & np.isfinite(roots.omega_b[k]).all(axis=-1)
        if known.any():
            window = slice(k - half, k + half + 1)
            starts = roots.q_bi[k][known], roots.omega_b[k][known]
            samples = arc.seconds[window], arc.measured_b[window], arc.field_i[window]
            fit = fit_window(*samples, *starts, noise_tesla=noise_tesla, epoch_s=arc.seconds[k])
            q_bi[k], sigma[k] = fit.q_bi[0], np.degrees(np.sqrt(np.trace(fit.covariance[0][:3, :3])))
    about = {"long_name": f"attitude by least squares over {fit_s:g} s", "axes": "b in i"}
    dataset["q_bi_fit"] = (("time", "quaternion"), q_bi, about)
    dataset["error_fit"] = ("time", attitude_error_deg(arc.q_bi, q_bi), _about("error"))
    dataset["sigma_fit"] = ("time", sigma, {"units": "deg", "long_name": "expected error of the fit, one sigma over three axes"})


def _provenance(settings: dict, roots: Roots) -> dict:
    """Attributes: source, settings, and how many samples had no solution and why."""
    import json

    plain = {k: list(v) if isinstance(v, tuple) else v for k, v in settings.items()}
    return {
        "title": "Natanson, McLaughlin and Nicklas (1990), synthetic arc like ERBS",
        "source": "NASA CP-3102 (1990), N91-17; circular orbit, 600 km, 57 deg, 1989-01-15",
        "settings_json": json.dumps(plain),
        "solved": "; ".join(roots.words()),
    }


def _limits(arc: Arc, roots: Roots, step_s: float, noise_tesla: float, points: int) -> str:
    """What differences at this step, noise and rate can tell, in words."""
    magnitude = float(np.median(np.linalg.norm(arc.field_i, axis=1)))
    spin = float(np.median(np.linalg.norm(arc.omega_b, axis=1)))
    turning = float(np.nanmedian(roots.circle.lambda_r / roots.circle.f_s))
    return three_sample_verdict(step_s, noise_tesla, magnitude, spin, turning, points)[1]


def _about(kind: str) -> dict:
    units, words = UNITS[kind]
    return {"units": units, "long_name": words}


def _refuse(value, known, name: str) -> None:
    if value not in known:
        raise InputError(f"{name} must be one of {', '.join(str(k) for k in known)}; got {value!r}.")


def _whole_steps(step_s: float, interval_s: float, count: int) -> int:
    """The step in samples, or a refusal."""
    steps = number("step_s", step_s, 1e-3) / interval_s
    if steps < 1.0 or abs(steps - round(steps)) > 1e-6:
        raise InputError(f"step_s must be a multiple of the sampling interval, {interval_s:g} s; got {step_s:g} s.")
    if 2 * round(steps) >= count:
        raise InputError(f"a step of {step_s:g} s to each side does not fit into the arc of {(count - 1) * interval_s:g} s.")
    return round(steps)
