"""Every spelling of a column that the manual promises is recognised, with its axis and unit, and no other is."""

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.telemetry.columns import recognise
from fieldline.telemetry.units import UNITS_OF, find_unit, parse_unit

DEG = np.pi / 180.0
MAGNETOMETER = [
    ("mag_x_nT", "x", 1e-9),
    ("MAG_X_NT", "x", 1e-9),
    ("bx_uT", "x", 1e-6),
    ("By_µT", "y", 1e-6),
    ("magX [mG]", "x", 1e-7),
    ("MAG1_X(nT)", "x", 1e-9),
    ("B_VFM.z", "z", None),
    ("Bx", "x", None),
    ("magnetometer.x", "x", None),
    ("magnetometer_z_uT", "z", 1e-6),
    ("mag_y_T", "y", 1.0),
    ("mag_y_G", "y", 1e-4),
    ("mag_y_mT", "y", 1e-3),
    ("MagneticFieldX (Gauss)", "x", 1e-4),
    ("mag[0]", "x", None),
    ("mag[2] [nT]", "z", 1e-9),
    ("mag(y)", "y", None),
    ("magXnT", "x", 1e-9),
    ("imu.mag.x", "x", None),
    ("hx_nT", "x", 1e-9),
    ("xmag_nT", "x", 1e-9),
    ("ADCS_MAG_RAW_X", "x", None),
    ("mag_x_raw", "x", None),
    ("mag_x / nT", "x", 1e-9),
]
OTHERS = [
    ("gyro_x_dps", "gyro", "x", DEG),
    ("gyro_y_deg_s", "gyro", "y", DEG),
    ("gyro_z_mdps", "gyro", "z", 1e-3 * DEG),
    ("omega_x_rad_s", "gyro", "x", 1.0),
    ("wz (rad/s)", "gyro", "z", 1.0),
    ("GyroX [°/s]", "gyro", "x", DEG),
    ("angular_rate_x_deg/s", "gyro", "x", DEG),
    ("dipole_x_A_m2", "dipole_command", "x", 1.0),
    ("dipole_cmd_y_mA_m2", "dipole_command", "y", 1e-3),
    ("mtq_z [A·m²]", "dipole_command", "z", 1.0),
    ("mtq_z_Am^2", "dipole_command", "z", 1.0),
    ("wheel_speed_x_rpm", "wheel_speed", "x", 2 * np.pi / 60),
    ("rw1_rpm", "wheel_speed", "", 2 * np.pi / 60),
    ("mag_temp_degC", "temperature", "", 1.0),
    ("temperature [K]", "temperature", "", 1.0),
    ("solar_current_mA", "solar_current", "", 1e-3),
    ("i_solar_A", "solar_current", "", 1.0),
    ("css_mx", "sun_sensor", "-x", 1.0),
    ("css_px", "sun_sensor", "+x", 1.0),
    ("css_+x", "sun_sensor", "+x", 1.0),
    ("css_-z", "sun_sensor", "-z", 1.0),
    ("sun_px", "sun_sensor", "+x", 1.0),
    ("sun_sensor_y_neg", "sun_sensor", "-y", 1.0),
    ("cssX+", "sun_sensor", "+x", 1.0),
    ("css_ny_mA", "sun_sensor", "-y", 1.0),
]
NOTHING = [
    *("B_NEC.x", "mag_pred_x", "acc_x", "mag_residual_x_nT", "css_x", "mtq_current_x_mA", "torque_x", "mag_norm_nT", "B_error"),
    *("quat_x", "igrf_x_nT", "sun_vector_x", "mag_eci_x_nT", "omega_est_x_rad_s", "voltage", "", "x", "mag_x_flag"),
]


@pytest.mark.parametrize(("name", "axis", "factor"), MAGNETOMETER)
def test_magnetometer_names(name, axis, factor):
    column = recognise(name)
    assert column is not None
    assert (column.quantity, column.axis) == ("magnetometer", axis)
    assert (column.unit.factor if column.unit else None) == factor


@pytest.mark.parametrize(("name", "quantity", "axis", "factor"), OTHERS)
def test_other_names(name, quantity, axis, factor):
    column = recognise(name)
    assert column is not None
    assert (column.quantity, column.axis) == (quantity, axis)
    assert column.unit is not None
    assert column.unit.factor == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize("name", NOTHING)
def test_names_that_are_no_sensor(name):
    assert recognise(name) is None


def test_axes_of_one_instrument_share_a_group():
    for pattern in ("mag_{}_nT", "MAG1_{}(nT)", "B{} [uT]", "magnetometer.{}", "gyro_{}_dps"):
        groups = {recognise(pattern.format(axis)).group for axis in "xyz"}
        assert len(groups) == 1


def test_two_instruments_have_two_groups():
    assert recognise("mag1_x_nT").group != recognise("mag2_x_nT").group


@pytest.mark.parametrize("quantity", UNITS_OF)
def test_every_spelling_of_every_unit_is_found(quantity):
    for unit, spellings in UNITS_OF[quantity].items():
        for spelling in (unit.name, *spellings.split()):
            found = find_unit(spelling, quantity)
            assert found is not None
            assert found.name == unit.name


def test_a_scale_is_a_unit():
    assert parse_unit("15.36 nT", "magnetometer", "--unit").factor == pytest.approx(15.36e-9)
    assert parse_unit("6.5 nT per count", "magnetometer", "--unit").factor == pytest.approx(6.5e-9)
    assert parse_unit(1e-9, "magnetometer", "--unit").factor == 1e-9


@pytest.mark.parametrize("text", ["furlong", "", "nT nT", "0 nT", "nan nT", "1e999 nT"])
def test_a_unit_that_is_none_names_the_known_ones(text):
    with pytest.raises(InputError, match=r"unit|scale"):
        parse_unit(text, "magnetometer", "--unit")
