"""Momentum dumped by coils, (11) and (12) of the study, and what gas jets would cost for the same.

In axes that do not turn, with b = B/|B| along the orbit,

    dH/dt = -K (H - b (b . H))                                                                             (1)

so the part of H along the field stays until the field has turned. To order K over the orbital rate, H decays at K times
the mean of I - b b^T, whose eigenvalues lie between 0.18 (along the axis of an equatorial orbit) and 0.98.

Jets on an arm throw out propellant for every dumped newton metre second,

    m = |H| / (arm g0 I_sp)                                                                                (2)

and coils draw power while they work; their mass is paid once. The study gives no numbers for jets; cold nitrogen at
70 s and an arm of 1.2 m (half of its coil's 2.44 m) are assumed.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.cases.ames_1961.dipole_field import SOURCE, across_field_eigenvalues, field, settings_text
from fieldline.cases.ames_1961.flight import clipped, field_at
from fieldline.cases.ames_1961.line_pointing import three
from fieldline.cases.erbs_like import number
from fieldline.constants import SECONDS_PER_DAY
from fieldline.control.coils import dumping_moment
from fieldline.frames.vectors import add, axpy, cross, put, vec

STANDARD_GRAVITY_M_S2 = 9.80665  # ISO 80000-3
SECONDS_PER_YEAR = 365.25 * SECONDS_PER_DAY
COLD_GAS_ISP_S = 70.0
JET_ARM_M = 1.2


@njit(cache=True)
def momentum_rate(t, momentum, field_i, step, gain, limit, load):
    """dH/dt [N m]: the coils' torque on the wheels' momentum (tuple) in the field at t, and a constant load."""
    field = field_at(t, field_i, step)
    moment, _ = clipped(dumping_moment(field, momentum, gain), limit)
    return add(cross(moment, field), load)


@njit(cache=True)
def dump_kernel(momentum0, field_i, step, gain, limit, load, momentum, moment):
    """Fill (n, 3) momenta and (n, 3) moments at the rows of field_i (n, 3), `step` apart, by RK4."""
    h = momentum0
    for k in range(field_i.shape[0]):
        put(momentum, k, h)
        put(moment, k, clipped(dumping_moment(vec(field_i, k), h, gain), limit)[0])
        t = k * step
        k1 = momentum_rate(t, h, field_i, step, gain, limit, load)
        k2 = momentum_rate(t + 0.5 * step, axpy(0.5 * step, k1, h), field_i, step, gain, limit, load)
        k3 = momentum_rate(t + 0.5 * step, axpy(0.5 * step, k2, h), field_i, step, gain, limit, load)
        k4 = momentum_rate(t + step, axpy(step, k3, h), field_i, step, gain, limit, load)
        h = axpy(step / 6.0, axpy(2.0, k2, axpy(2.0, k3, add(k1, k4))), h)


def dump(
    inclination_deg: float = 35.0,
    gain_per_s: float = 3e-4,
    orbits: float = 6.0,
    momentum=(1.0, 1.0, 1.0),
    *,
    altitude_m: float = 805e3,
    tilt_deg: float = 17.0,
    load_n_m=(0.0, 0.0, 0.0),
    moment_limit_a_m2: float = 1e9,
    step_s: float = 10.0,
):
    """Momentum of an inertially fixed vehicle's wheels under (11), as an xarray Dataset over `seconds`.

    Parameters
    ----------
    inclination_deg, altitude_m, tilt_deg : of the orbit and the dipole, as in `field`.
    gain_per_s : K of (11). momentum : H at the start [N m s], inertial axes.
    load_n_m : constant torque that fills the wheels meanwhile. moment_limit_a_m2 : each coil's.

    Returns
    -------
    Dataset: momentum [N m s], moment [A m^2], fraction |H|/|H0|, along_field [N m s]; eigenvalues of the mean of I - b b^T.
    """
    settings = dict(locals())
    start = three("momentum", momentum)
    size = float(np.linalg.norm(start))
    number("|momentum|", size, 1e-12)
    number("orbits", orbits, 1e-3, 1000.0)
    period = field(inclination_deg, altitude_m, tilt_deg, duration_s=20.0).attrs["period_s"]
    steps = int(np.ceil(orbits * period / number("step_s", step_s, 1e-2, 120.0)))
    step = orbits * period / steps
    along = field(inclination_deg, altitude_m, tilt_deg, duration_s=orbits * period, step_s=step)
    field_i = np.ascontiguousarray(along["field_i"].values)
    found, moment = np.empty_like(field_i), np.empty_like(field_i)
    gain, limit = number("gain_per_s", gain_per_s, 0.0, 1.0), number("moment_limit_a_m2", moment_limit_a_m2, 1e-9)
    dump_kernel(start, field_i, step, gain, limit, three("load_n_m", load_n_m), found, moment)
    return _dataset(along, found, moment, size, settings)


def coils_against_jets(
    momentum_n_m_s: float = 1.0,
    *,
    per_s: float = 6050.0,
    years: float = 1.0,
    arm_m: float = JET_ARM_M,
    specific_impulse_s: float = COLD_GAS_ISP_S,
    coil_mass_kg: float = 0.473,
    coil_power_w: float = 2.21,
    coils: int = 3,
    duty: float = 1.0,
    supply_kg_per_w: float = 0.2,
):
    """What it takes to dump momentum_n_m_s every per_s for some years: propellant (2), or coils and their supply.

    Dataset of scalars: propellant_per_dump_kg, propellant_kg over the years (tank and jets not counted), coil_kg (coils
    and the supply's share at supply_kg_per_w), energy_per_dump_j, even_after_days: from when on the coils weigh less.
    """
    import xarray as xr

    bounds = {"momentum_n_m_s": 1e-12, "per_s": 1.0, "years": 1e-6, "arm_m": 1e-3, "specific_impulse_s": 1.0}
    given = {k: v for k, v in locals().items() if k != "xr"}
    for name, least in bounds.items():
        number(name, given[name], least)
    each = momentum_n_m_s / (arm_m * STANDARD_GRAVITY_M_S2 * specific_impulse_s)  # (2)
    power = coils * coil_power_w * number("duty", duty, 0.0, 1.0)
    mass = coils * coil_mass_kg + power * supply_kg_per_w
    values = {
        "propellant_per_dump_kg": (each, "kg", "propellant for one dump"),
        "propellant_kg": (each * years * SECONDS_PER_YEAR / per_s, "kg", "propellant over the years"),
        "coil_kg": (mass, "kg", "coils and their share of the power supply"),
        "energy_per_dump_j": (power * per_s, "J", "electrical energy for one dump"),
        "even_after_days": (mass / each * per_s / SECONDS_PER_DAY, "d", "when the propellant outweighs the coils"),
    }
    variables = {name: ((), value, {"units": units, "long_name": words}) for name, (value, units, words) in values.items()}
    return xr.Dataset(variables, attrs={"source": f"{SOURCE}; jets assumed"})


def _dataset(along, momentum: np.ndarray, moment: np.ndarray, size: float, settings: dict):
    """The signals with their units."""
    import xarray as xr

    b = along["field_i"].values / along["magnitude"].values[:, None]
    vector = ("seconds", "axis")
    variables = {
        "momentum": (vector, momentum, {"units": "N m s", "long_name": "momentum of the wheels", "axes": "i"}),
        "moment": (vector, moment, {"units": "A m2", "long_name": "moment of the coils", "axes": "i"}),
        "fraction": ("seconds", np.linalg.norm(momentum, axis=1) / size, {"units": "1", "long_name": "|H|/|H0|"}),
        "along_field": ("seconds", (momentum * b).sum(axis=1), {"units": "N m s", "long_name": "part along the field"}),
        "eigenvalue": ("mode", across_field_eigenvalues(along), {"units": "1", "long_name": "of the mean of I - b b^T"}),
    }
    return xr.Dataset(
        variables,
        coords={"seconds": along["seconds"], "axis": list("xyz")},
        attrs={
            "title": f"Momentum dumped at {settings['inclination_deg']:g} deg, K = {settings['gain_per_s']:g} /s",
            "case": "ames_1961_dump",
            "source": f"{SOURCE}, equations (11) and (12)",
            "settings_json": settings_text(settings),
            "period_s": along.attrs["period_s"],
        },
    )
