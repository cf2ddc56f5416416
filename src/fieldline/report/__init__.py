"""Reports: an estimate, a calibration or a simulated run as one HTML page, and its figures as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fieldline.report.attitude_report import report_html, write_figures

if TYPE_CHECKING:
    import xarray

__all__ = ["write_report", "write_figures", "report_html"]


def write_report(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Write the report on an estimate or a simulated run as one self-contained HTML file, whole or not at all.

    Parameters
    ----------
    dataset : Dataset of `estimate_attitude`, `estimate_skiprope` or `simulate`, in SI; the report shows
        degrees, kilometres and microtesla, and says so.
    path : the file to write.

    Errors: InputError where the folder does not exist or cannot be written to.
    """
    from fieldline.report import attitude_report, simulation_report, skiprope_report

    if skiprope_report.is_skiprope(dataset):
        return skiprope_report.write_skiprope_report(dataset, path)
    if simulation_report.is_run(dataset):
        return simulation_report.write_simulation_report(dataset, path)
    return attitude_report.write_report(dataset, path)
