"""How internal friction damps the libration of a tethered pair in a year: a study of TiPS, `python benchmarks/tips_libration.py`.

Flies a year by the implicit method (one to two minutes each), prints the largest angle of every second month and draws
docs/gallery/tether_tips.png. Not part of the tests.

Known (Naval Research Laboratory: specification of TiPS, 1996; SLR Electronic Report 16, 20 June 1997; SLR Electronic Mail 44,
4 March 1997): 4 km of line of 5.4 kg, 37.6 kg below and 10.4 kg above, a circular orbit of 1022 km and 63.4 deg; a libration of
40 deg at first, 4 (+3, -1) deg in the plane after eight and a half months, 5 to 7 deg in and across the plane after a year.

Assumed: a straight line without nodes, half of its mass at either end; a point Earth, no air, no heat, no current; the
motion begins at 40 deg in the plane and 10 deg across it. The braid is soft at its tenth of a newton, and its friction is
that of a Kelvin-Voigt line: T = EA (strain + tau strain rate), EA = 600 N, tau = 160 s, a loss factor of 0.27 at the
frequency of libration. Only one number of these matters and is fitted, that of

    a'/a = -6 m L n^4 (tau / EA) / (1 + 3 n^2 tau^2)                                                        (1)

m: reduced mass; small angles in the plane, the tension swinging by 6 m L n^2 a about its mean. Out of the plane the tension
swings with the square of the angle, and friction takes far less.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import fieldline as fl

FIGURE = Path(__file__).parents[1] / "docs" / "gallery" / "tether_tips.png"
RALPH_KG, NORTON_KG, LINE_KG, LENGTH_M = 37.6, 10.4, 5.4, 4000.0
STIFFNESS_N, TAU_S = 600.0, 160.0
RADIUS_M = 6_378_136.6 + 1_022e3
DAYS = 365
STEP_S = 600.0  # of the output


def scenario(in_plane_deg: float, across_deg: float) -> fl.Scenario:
    """A year of the pair."""
    hang = {"upward": True, "in_plane_deg": in_plane_deg, "out_of_plane_deg": across_deg}
    line = {"from_body": "ralph", "to_body": "norton", "name": "tether", "rest_length_m": LENGTH_M, "stiffness_n": STIFFNESS_N}
    return fl.Scenario.from_dict(
        {
            "time": {"start_utc": "1996-06-20T10:34:00Z", "duration_s": 86400.0 * DAYS, "output_step_s": STEP_S},
            "environment": {"gravity": "point", "uniform_field_i_tesla": (2e-5, 0.0, 0.0)},
            "orbit": {"elements": {"altitude_km": 1022.0, "inclination_deg": 63.4}},
            # three parts in 1e10 of the swing a second are left to the method, a two-hundredth of what friction takes
            "integrator": {
                "method": "rosenbrock",
                "position_tolerance_m": 1e-5,
                "velocity_tolerance_m_s": 1e-8,
                "relative_tolerance": 1e-12,
            },
            "body": [
                {"name": "ralph", "kind": "point", "mass_kg": RALPH_KG},
                {"name": "norton", "kind": "point", "mass_kg": NORTON_KG, "hang": hang},
            ],
            "line": [line | {"damping_n_s": STIFFNESS_N * TAU_S, "mass_per_length_kg_m": LINE_KG / LENGTH_M}],
        }
    )


def envelope(angle_rad: np.ndarray, days: float = 2.0) -> np.ndarray:
    """(n,) [deg] largest angle of every two days."""
    count = round(days * 86400.0 / STEP_S)
    whole = len(angle_rad) // count
    return np.degrees(np.abs(angle_rad[: whole * count]).reshape(whole, count).max(axis=1))


def small_rate() -> float:
    """[1/s] equation (1)."""
    n = np.sqrt(3.986004418e14 / RADIUS_M**3)
    low, high = RALPH_KG + 0.5 * LINE_KG, NORTON_KG + 0.5 * LINE_KG
    reduced = low * high / (low + high)
    return 6.0 * reduced * LENGTH_M * n**4 * TAU_S / STIFFNESS_N / (1.0 + 3.0 * (n * TAU_S) ** 2)


def main() -> None:
    """Two years, side by side."""
    figure, axes = plt.subplots(1, 2, figsize=(10.5, 3.6), constrained_layout=True, sharey=True)
    for panel, across in zip(axes, (0.0, 10.0), strict=True):
        shape = fl.line_shape(fl.simulate(scenario(40.0, across)))
        plane, side = envelope(shape["in_plane"].values), envelope(shape["across"].values)
        days = 2.0 * np.arange(len(plane)) + 1.0
        panel.plot(days, plane, color="#0072b2", label="in the plane")
        panel.plot(days, side, color="#d55e00", label="across it")
        panel.fill_between([330.0, 365.0], 5.0, 7.0, color="#009e73", alpha=0.35, linewidth=0, label="told of TiPS")
        panel.errorbar([257.0], [4.0], yerr=[[1.0], [3.0]], fmt="s", color="#009e73", markersize=4, capsize=3)
        panel.set(xlabel="days", title=f"begun at 40° in the plane and {across:.0f}° across it", ylim=(0.0, 42.0))
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
        late = plane[-31:-1]
        rate = np.log(late[0] / late[-1]) / (2.0 * 86400.0 * (len(late) - 1))
        print(f"across {across:.0f} deg; the last two months: {rate:.3e} 1/s, equation (1): {small_rate():.3e} 1/s")
        for k in range(0, len(days), 30):
            print(f"  day {days[k]:4.0f}: {plane[k]:5.2f} {side[k]:5.2f} deg")
        print(f"  day {days[-1]:4.0f}: {plane[-1]:5.2f} {side[-1]:5.2f} deg")
    axes[0].set_ylabel("largest angle in two days [deg]")
    axes[0].legend(frameon=False)
    figure.savefig(FIGURE, dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
