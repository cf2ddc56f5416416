"""Reports: an estimate or a calibration as one HTML page, and its figures as files."""

from fieldline.report.attitude_report import report_html, write_figures, write_report

__all__ = ["write_report", "write_figures", "report_html"]
