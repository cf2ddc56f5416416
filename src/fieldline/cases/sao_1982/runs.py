"""The report's runs of two masses: the spinning test case, the thruster, and the annex's tests.

What the report does not say is assumed, and does not show in what it prints: EA = 2.2e5 N and critical damping for the first
two (any EA from 1e4 to 2e6 N gives the same angles to 4e-7 rad in the spinning case). For the annex's tests only the two
frequencies of the swing and of the stretch show, and are inferred from its times: both near 0.4 to 0.45 rad/s, here by a
solid ball of 100 kg and 1 m radius on its surface and EA = 3.2e5 N.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.spinning_subsatellite import SpinningSubsatellite, spin_for_angle
from fieldline.cases.erbs_like import number
from fieldline.cases.sao_1982.dumbbell import critical_angular_damping, strung
from fieldline.cases.sao_1982.flight import Pair, Start, pair_at, scenario_of, turning_start
from fieldline.cases.sao_1982.printout import printed
from fieldline.cases.sao_1982.surroundings import GM_M3_S2
from fieldline.errors import InputError, nearest

BRANCHES = {"inverted": -1.0, "hanging": 1.0}
SHUTTLE_KG, SUBSATELLITE_KG = 86363.0, 100.0
LENGTH_M, ALTITUDE_M, OFFSET_M = 20e3, 220e3, 0.5
AXIAL_KG_M2, TRANSVERSE_KG_M2 = 2e5, 1e5
STIFFNESS_N = 2.2e5
FASTEST_RAD_S = 2000.0
PRINTED_SPIN_RAD_S = -0.04919339283


def spin(
    theta_deg: float = 20.0,
    *,
    branch: str = "inverted",
    spin_rad_s: float | None = None,
    duration_s: float = 300.0,
    output_step_s: float = 10.0,
    placement: str = "attachment-rigid",
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    offset_m: float = OFFSET_M,
    lower_mass_kg: float = SUBSATELLITE_KG,
    upper_mass_kg: float = SHUTTLE_KG,
    length_m: float = LENGTH_M,
    altitude_m: float = ALTITUDE_M,
    stiffness_n: float = STIFFNESS_N,
    damping: float | str = "critical",
    inclination_deg: float = 0.0,
    eccentricity: float = 0.0,
    oblate: bool = False,
    anomaly: dict | None = None,
    air: dict | None = None,
    nodes: int = 0,
    line_mass_kg: float = 0.0,
):
    """The spinning subsatellite that stands at theta against the orbit normal (s. 3.1.2), flown by the plant.

    Parameters
    ----------
    theta_deg : tilt of its axis, 0 to 180 without the ends; psi = 90 deg, phi = 0 and no other rates than psi' = n at start.
    branch : "inverted", the attachment at -offset on the axis (the report's case: its centre of mass is above the
        attachment), or "hanging", at +offset.
    spin_rad_s : phi'; by default that of the stationary motion. The report's number is PRINTED_SPIN_RAD_S; it is the
        hanging branch's rate about the axis, and serves the inverted one because C = 2 A.
    placement : where masses and attachment start, see `flight`. damping : b [N s/m] or "critical".
    oblate, anomaly, air : J2, a mass anomaly, drag, of nodes too; see `surroundings` and `flight.scenario_of`.
    nodes, line_mass_kg : of a line with mass (s. 3.2); damp it little, its steps get short otherwise.

    Returns
    -------
    Dataset over `seconds`, see `printout`: theta, psi, phi and the same with _orbital, direction cosines, tension and more;
    attributes orbital_rate_rad_s, tension_n, spin_rad_s, stationary_spin_rad_s.
    Errors: InputError for what cannot be; RunError where the run breaks.
    """
    settings = dict(locals())
    if branch not in BRANCHES:
        raise InputError(f'unknown branch "{branch}"; {nearest(str(branch), BRANCHES)}')
    theta = _tilt(theta_deg)
    whole = strung(pair_at(altitude_m, lower_mass_kg, upper_mass_kg, length_m), nodes, line_mass_kg, GM_M3_S2)
    two = whole.dumbbell
    body = SpinningSubsatellite(
        axial_inertia_kg_m2=axial_inertia_kg_m2,
        transverse_inertia_kg_m2=transverse_inertia_kg_m2,
        tension_n=two.tension_n,
        offset_m=offset_m,
        orbital_rate_rad_s=two.orbital_rate_rad_s,
    )
    # An attachment on the far side of the axis is the study's branch above 180 deg, seen from below the tether.
    stationary = spin_for_angle(body, theta if branch == "hanging" else -theta)
    about = float(stationary) if spin_rad_s is None else number("spin_rad_s", spin_rad_s, -100.0, 100.0)
    if abs(about) > FASTEST_RAD_S:
        raise InputError(
            f"a spin of {about:.3g} rad/s would stand at theta_deg = {theta_deg:g} with offset_m = {offset_m:g}, too fast to be "
            f"followed: {FASTEST_RAD_S:g} is the most. Take a larger tilt, a smaller offset, or give spin_rad_s."
        )
    inertia = _inertia(axial_inertia_kg_m2, transverse_inertia_kg_m2)
    pair = Pair(two, inertia, (0.0, 0.0, BRANCHES[branch] * offset_m), stiffness_n, damping, strung=whole)
    start = turning_start(theta, 0.5 * np.pi, 0.0, 0.0, two.orbital_rate_rad_s, about, placement)
    scenario = scenario_of(
        "sao_1982_spin",
        pair,
        start,
        duration_s=duration_s,
        output_step_s=output_step_s,
        inclination_deg=inclination_deg,
        eccentricity=eccentricity,
        oblate=oblate,
        anomaly=anomaly,
        air=air,
    )
    title = f"Spinning subsatellite at {theta_deg:g} deg, {branch}"
    return _flown(scenario, pair, "sao_1982_spin", title, settings, spin_rad_s=about, stationary_spin_rad_s=stationary)


def thruster(
    torque_n_m: float = 40.0,
    duration_s: float = 500.0,
    *,
    output_step_s: float = 10.0,
    placement: str = "attachment-rigid",
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    offset_m: float = OFFSET_M,
    stiffness_n: float = STIFFNESS_N,
    damping: float | str = "critical",
    nodes: int = 0,
    line_mass_kg: float = 0.0,
):
    """A subsatellite at rest on its tether, spun up by a constant torque about the axis along the tether (s. 3.3).

    Starts at theta = psi = 90 deg and phi = 0, turning with the orbit about its normal: psi' = n and no other rate, which is
    what reproduces the printed table. Masses, length and height are the report's; nodes and the Dataset as in `spin`.
    """
    settings = dict(locals())
    whole = strung(pair_at(ALTITUDE_M, SUBSATELLITE_KG, SHUTTLE_KG, LENGTH_M), nodes, line_mass_kg, GM_M3_S2)
    two = whole.dumbbell
    inertia = _inertia(axial_inertia_kg_m2, transverse_inertia_kg_m2)
    pair = Pair(two, inertia, (0.0, 0.0, number("offset_m", offset_m, 1e-6)), stiffness_n, damping, strung=whole)
    right = 0.5 * np.pi
    scenario = scenario_of(
        "sao_1982_thruster",
        pair,
        turning_start(right, right, 0.0, 0.0, two.orbital_rate_rad_s, 0.0, placement),
        duration_s=duration_s,
        output_step_s=output_step_s,
        torque_b_n_m=(0.0, 0.0, number("torque_n_m", torque_n_m, -1e6, 1e6)),
    )
    return _flown(scenario, pair, "sao_1982_thruster", f"Thruster of {torque_n_m:g} N m about the tether", settings)


def _tilt(theta_deg: float) -> float:
    """theta [rad]; the study's angles above 180 deg are those of the inverted branch."""
    given = isinstance(theta_deg, int | float | np.number) and not isinstance(theta_deg, bool)
    if given and 180.0 < theta_deg < 360.0:
        raise InputError(
            f"theta_deg must be a number, 0.001 to 179.999; got {theta_deg:g}. The study's angles above 180 are those of the "
            f'inverted branch, here branch = "inverted" and theta_deg = {theta_deg - 180.0:g}.'
        )
    return float(np.radians(number("theta_deg", theta_deg, 1e-3, 180.0 - 1e-3)))


def _inertia(axial_kg_m2: float, transverse_kg_m2: float) -> tuple[float, float, float]:
    """Principal moments of a symmetric rigid body [kg m^2]."""
    axial = number("axial_inertia_kg_m2", axial_kg_m2, 1e-12, 1e15)
    transverse = number("transverse_inertia_kg_m2", transverse_kg_m2, 1e-12, 1e15)
    if axial > 2.0 * transverse * (1.0 + 1e-12):
        raise InputError(
            f"axial_inertia_kg_m2 must be at most twice transverse_inertia_kg_m2 = {transverse:g}, as of every rigid body; "
            f"got {axial:g}."
        )
    return (transverse, transverse, axial)


class AnnexRun(NamedTuple):
    """A test of III-1.5: turn from the line along (in-plane, out-of-plane) [deg], damping of line and joint, rates."""

    turned_deg: float
    direction: tuple[float, float]
    linear: bool
    angular: bool
    rate_i: tuple[float, float, float] = (0.0, 0.0, 0.0)
    duration_s: float = 40.0
    words: str = ""


DIAGONAL = (float(np.sqrt(0.5)), float(np.sqrt(0.5)))
ANNEX_RUNS = {
    "unspun": AnnexRun(0.0, (1.0, 0.0), True, True, words="no rate at the start"),
    "in-plane": AnnexRun(20.0, (1.0, 0.0), True, True, words="20 deg in the plane"),
    "in-plane-linear": AnnexRun(20.0, (1.0, 0.0), True, False, duration_s=300.0, words="20 deg in the plane, joint free"),
    "diagonal": AnnexRun(20.0, DIAGONAL, True, True, duration_s=120.0, words="20 deg diagonally"),
    "diagonal-undamped": AnnexRun(20.0, DIAGONAL, False, False, duration_s=60.0, words="20 deg diagonally, no damping"),
    "diagonal-rates": AnnexRun(
        20.0, DIAGONAL, True, True, (0.0, 0.1, 0.05), 120.0, "20 deg diagonally with rates in and out of the plane"
    ),
}


def annex_run(
    name: str = "in-plane",
    *,
    output_step_s: float = 0.5,
    duration_s: float | None = None,
    radius_m: float = 1.0,
    stiffness_n: float = 3.2e5,
    placement: str = "attachment",
):
    """One of the annex's test runs (III-1.5), a solid ball on a line of 20 km; names in ANNEX_RUNS. Dataset as of `spin`.

    The ball hangs by a point of its surface; the lever is turned from the line by 20 deg. Both dampings are critical where
    they act. Its inertial rate is zero at the start but for "diagonal-rates": 0.1 rad/s about the track, 0.05 about the normal.
    """
    settings = dict(locals())
    plain = str(name).replace("_", "-")
    if plain not in ANNEX_RUNS:
        raise InputError(f'unknown run "{name}"; {nearest(plain, ANNEX_RUNS)}')
    run = ANNEX_RUNS[plain]
    radius = number("radius_m", radius_m, 1e-3, 1e3)
    two = pair_at(ALTITUDE_M, SUBSATELLITE_KG, SHUTTLE_KG, LENGTH_M)
    inertia = 0.4 * SUBSATELLITE_KG * radius**2
    joint = critical_angular_damping(inertia, two.tension_n, radius) if run.angular else 0.0
    pair = Pair(two, (inertia,) * 3, (radius, 0.0, 0.0), stiffness_n, "critical" if run.linear else 0.0, joint)
    scenario = scenario_of(
        f"sao_1982_{plain}",
        pair,
        _turned(run, placement),
        duration_s=run.duration_s if duration_s is None else duration_s,
        output_step_s=output_step_s,
    )
    return _flown(scenario, pair, "sao_1982_annex", f"Annex III-1.5: {run.words}", settings, angular_damping_n_m_s=joint)


def _turned(run: AnnexRun, placement: str) -> Start:
    """The lever, body x, turned from the vertical towards the track and the orbit's normal."""
    from scipy.spatial.transform import Rotation

    from fieldline.cases.sao_1982.euler_angles import euler_angles

    along, across = run.direction
    turn = Rotation.from_rotvec(np.radians(run.turned_deg) * np.array([0.0, -across, along]))
    theta, psi, phi = euler_angles(turn.as_matrix().T)
    rate_b = turn.inv().apply(run.rate_i)
    return Start(float(theta), float(psi), float(phi), tuple(map(float, rate_b)), placement)


def _flown(scenario, pair: Pair, case: str, title: str, settings: dict, **extra):
    """Fly it and print it."""
    from fieldline.simulate.run import simulate

    data = printed(simulate(scenario), scenario, case, title, settings)
    tension = pair.dumbbell.tension_n if pair.strung is None else float(pair.strung.tension_n[0])
    data.attrs |= {"orbital_rate_rad_s": pair.dumbbell.orbital_rate_rad_s, "tension_n": tension} | extra
    return data
