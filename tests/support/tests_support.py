"""What several tests of the estimator share: the packaged sample, time axes, simulated flights with a known truth."""

from importlib.resources import files

import numpy as np

from fieldline.estimation.reference import reference_along_orbit
from fieldline.frames.attitude import rotation_error_b
from fieldline.orbit import read_orbit
from fieldline.simulate import Magnetometer, fly_free

SAMPLE_CSV = str(files("fieldline") / "data" / "suchai3_2023-08-24.csv")
SAMPLE_TLE = str(files("fieldline") / "data" / "suchai3.tle")
FILTER_DEGREE = 8  # truth is IGRF-14 to degree 13: the filter's field is 60 nT off in the mean


def times_utc(count: int, step_s: float, start: str = "2023-08-24T14:44:09") -> np.ndarray:
    """(count,) times from the sample's first."""
    return np.datetime64(start, "ns") + (np.arange(count) * step_s * 1e9).astype("timedelta64[ns]")


def orbit():
    """The sample's orbit, 97.4 deg and 480 km."""
    return read_orbit(SAMPLE_TLE)


def tumbler(seed: int, *, count: int = 2281, step_s: float = 5.0, calibrated: bool = True, **more):
    """A random body (inertia, residual dipole, attitude, up to 5 deg/s) over two orbits, 100 nT of noise."""
    rng = np.random.default_rng(seed + 100)
    moments = np.sort(rng.uniform(0.5, 1.0, 3))
    moments = 0.03 * (moments if moments[2] < moments[:2].sum() else np.array([0.8, 0.9, 1.0]))
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    inertia = turn @ np.diag(moments) @ turn.T
    sensor = {"noise_std_tesla": 1e-7, "quantum_tesla": 1e-8}
    if not calibrated:
        sensor |= {"bias_s": 2e-5 * rng.standard_normal(3), "matrix": np.eye(3) + 0.01 * _symmetric(rng)}
    reference = reference_along_orbit(times_utc(count, step_s), orbit())
    return fly_free(
        reference,
        seed=seed,
        inertia_kg_m2=0.5 * (inertia + inertia.T),
        dipole_a_m2=0.005 * rng.standard_normal(3),
        magnetometer=Magnetometer(**sensor),
        **more,
    )


def _symmetric(rng) -> np.ndarray:
    matrix = rng.standard_normal((3, 3))
    return matrix + matrix.T


def attitude_error_deg(flight, estimate) -> np.ndarray:
    """(n,) [deg] angle between true and estimated attitude."""
    return np.degrees(np.linalg.norm(rotation_error_b(flight.q_bi, estimate["q_bi"].values), axis=1))


def nees(flight, estimate) -> float:
    """Mean of e^T P^-1 e / 3 over the arc: 1 for an estimate exactly as good as it says, less for a cautious one."""
    error = rotation_error_b(flight.q_bi, estimate["q_bi"].values)
    covariance = estimate["attitude_covariance_b"].values
    return float(np.mean(np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error)) / 3.0)
