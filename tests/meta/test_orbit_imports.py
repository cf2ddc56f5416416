"""Orbits and Earth rotation load no heavy library before they need it."""

import subprocess
import sys

HEAVY = {"erfa", "sgp4", "scipy", "pandas", "xarray", "numba", "matplotlib", "xml.etree.ElementTree"}


def test_import_is_cheap():
    code = "import sys, fieldline.orbit, fieldline.frames.earth_rotation; print(*sys.modules)"
    loaded = set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())
    assert not HEAVY & loaded
