"""`import fieldline` and `fieldline --help` are cheap, and every public name is where the face says."""

import subprocess
import sys

import pytest

import fieldline

HEAVY = ("numba", "pandas", "xarray", "scipy", "matplotlib", "erfa", "sgp4", "netCDF4", "cdflib", "pyarrow")
MOST_SECONDS = 0.3


@pytest.mark.parametrize(
    "code",
    [
        "import fieldline",
        "import sys; from fieldline.cli import main; main(['--help'])",
    ],
)
def test_nothing_heavy_is_loaded(code):
    tail = f"\nimport sys; print([m for m in {HEAVY} if m in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code + tail], capture_output=True, text=True, check=True, timeout=60)
    assert done.stderr.strip() == "[]"


def test_the_import_takes_milliseconds():
    code = "import time; a = time.perf_counter(); import fieldline; print(time.perf_counter() - a)"
    times = [
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout) for _ in range(2)
    ]
    assert min(times) < MOST_SECONDS


def test_every_public_name_loads():
    assert set(fieldline.__all__) == {"__version__", *fieldline._HOMES}
    assert set(dir(fieldline)) >= set(fieldline.__all__)
    for name in fieldline.__all__:
        assert getattr(fieldline, name) is not None


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_name"):
        fieldline.no_such_name  # noqa: B018
