"""The whole chain in the plant: stopped, attitude found from nothing, pointed; and wheels with and without unloading."""

import numpy as np
import pytest

import fieldline as fl
from fieldline.errors import InputError
from fieldline.frames.attitude import quaternion_from_dcm, rotation_error_b
from fieldline.frames.orbital import dcm_oi
from fieldline.simulate.scenario.templates import template


def rows(run, name):
    """(n, ...) of the only body."""
    return np.asarray(run[name].values).reshape(run.sizes["time"], -1)


def angle_deg(a, b):
    """(n,) between attitudes."""
    return np.degrees(np.linalg.norm(rotation_error_b(a, b), axis=1))


def pointing_deg(run):
    """(n,) angle between body and orbital axes."""
    turns = dcm_oi(rows(run, "position_i"), rows(run, "velocity_i"))
    return angle_deg(rows(run, "q_bi"), np.array([quaternion_from_dcm(turn) for turn in turns]))


@pytest.mark.kernels
@pytest.mark.slow
def test_magnetometer_and_torquers_alone_come_from_tumbling_to_pointing():
    scenario = fl.Scenario.from_toml(template("chain", "chain")).replace(**{"time.duration_orbits": 9.0, "seed": 1})
    run = fl.simulate(scenario)
    hours = (run.time.values - run.time.values[0]) / np.timedelta64(1, "h")
    rate = np.degrees(np.linalg.norm(rows(run, "omega_bi_b"), axis=1))
    known = np.isfinite(rows(run, "q_bi_known")).all(axis=1)
    assert rate[0] > 6.9 and rate[hours > 2.5].max() < 0.6
    assert not known[hours < 0.6].any() and known[hours > 2.0].all()
    error = angle_deg(rows(run, "q_bi")[known], rows(run, "q_bi_known")[known])
    assert error[:10].max() < 2.0
    late = hours > 9.0
    assert np.sqrt(np.mean(error[late[known]] ** 2)) < 6.0
    pointing = pointing_deg(run)
    assert pointing[hours < 1.0].max() > 90.0
    assert np.sqrt(np.mean(pointing[late] ** 2)) < 15.0


def wheels(law, **parameters):
    """Three orbits of the packaged satellite with wheels of 0.05 N m s: largest filling, and pointing after an orbit [deg]."""
    text = template("wheels", "wheels").replace("momentum_max_n_m_s = 0.5", "momentum_max_n_m_s = 0.05")
    scenario = fl.Scenario.from_toml(text.replace("momentum_n_m_s = 0.1 ", "momentum_n_m_s = 0.02 "))
    table = {"target": "nadir", "natural_frequency_rad_s": 0.05} | parameters
    changes = {"software.0.law": law, "software.0.parameters": table, "time.duration_orbits": 4.0}
    changes["body.0.disturbance_torque_i_n_m"] = [0.0, 4e-6, 0.0]  # what air does in a day, in four orbits
    run = fl.simulate(scenario.replace(**changes, **{"time.output_step_s": 30.0}))
    late = np.arange(run.sizes["time"]) > run.sizes["time"] // 2
    return np.abs(rows(run, "wheel_momentum")).max(axis=1)[late], pointing_deg(run)[late], run


@pytest.mark.kernels
@pytest.mark.slow
def test_unloaded_wheels_stay_empty_where_others_fill_and_let_go():
    filled, astray, _ = wheels("wheel-pointing")
    empty, held, _ = wheels("wheel-pointing-with-desaturation")
    assert filled.max() > 0.0499 and astray.max() > 1.0
    assert empty.max() < 0.02 and held.max() < 0.05


@pytest.mark.kernels
@pytest.mark.slow
def test_a_cancelled_dipole_is_a_tenth_of_itself():
    def torque(**more):
        _, _, run = wheels("wheel-pointing-with-desaturation", start_n_m_s=0.045, stop_n_m_s=0.04, **more)
        each = run["torque_b"].transpose("time", "load", ...).values.reshape(run.sizes["time"], run.sizes["load"], 3)
        names = [str(name) for name in run["load"].values]
        both = each[:, names.index("torquers")] + each[:, names.index("dipoles")]
        return float(np.median(np.linalg.norm(both, axis=1)[len(both) // 2 :]))

    assert torque(cancel_residual=True) < 0.3 * torque()


def test_an_estimator_is_named_in_its_role_and_with_its_parameters():
    scenario = fl.Scenario.from_toml(template("chain", "chain"))
    with pytest.raises(InputError, match=r'software\[0\].role must be "estimator" for the law "magnetometer-attitude"'):
        scenario.replace(**{"software.0.role": "controller"}).check()
    with pytest.raises(InputError, match='no such parameter; did you mean "window_s"'):
        scenario.replace(**{"software.0.parameters": {"windw_s": 100.0}}).check()
    with pytest.raises(InputError, match=r'software\[1\].role must be "controller"'):
        scenario.replace(**{"software.1.role": "estimator"}).check()
