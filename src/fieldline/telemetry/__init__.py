"""Telemetry: tables of attitude sensors in, attitude files out."""

from fieldline.telemetry.aem import write_attitude_aem
from fieldline.telemetry.attitude_csv import write_attitude_csv
from fieldline.telemetry.attitude_netcdf import write_attitude_netcdf
from fieldline.telemetry.reading import read_telemetry, telemetry_of
from fieldline.telemetry.record import Quality, Recognised, Telemetry
from fieldline.telemetry.replay import measurements_of
from fieldline.telemetry.telemetry_csv import write_telemetry_csv

__all__ = [
    "Quality",
    "Recognised",
    "Telemetry",
    "measurements_of",
    "read_telemetry",
    "telemetry_of",
    "write_attitude_aem",
    "write_attitude_csv",
    "write_attitude_netcdf",
    "write_telemetry_csv",
]
