"""Every module by itself: it imports alone, cheaply, and keeps to the house's manners."""

import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

PACKAGE = Path(str(files("fieldline")))
MODULES = sorted(
    ".".join(("fieldline", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
)
LOADED_WHERE_USED = ("pandas", "xarray", "scipy", "matplotlib", "erfa", "sgp4", "netCDF4", "cdflib", "pyarrow")
MOST_LINES = 500
# What an import alone must not find is another module of ours that was loaded before: the libraries may stay.
ALONE = """
import importlib, sys, warnings
warnings.simplefilter("error")
import numpy, numba
heavy, failed = set(sys.argv[1].split()), []
for name in sys.stdin.read().split():
    for loaded in [m for m in sys.modules if m.split(".")[0] == "fieldline"]:
        del sys.modules[loaded]
    before = {m for m in heavy if m in sys.modules}
    try:
        importlib.import_module(name)
    except Exception as error:
        failed.append(f"{name}: {error!r}")
    late = {m for m in heavy if m in sys.modules} - before
    failed += [f"{name} loads {m} on import"for m in sorted(late)]
print(*failed, sep="\\n")
"""


def test_modules_are_found():
    assert len(MODULES) > 100 and "fieldline.cli" in MODULES and "fieldline.estimation.kalman" in MODULES


def test_every_module_imports_alone_and_loads_nothing_heavy():
    command = [sys.executable, "-c", ALONE, " ".join(LOADED_WHERE_USED)]
    done = subprocess.run(command, input="\n".join(MODULES), capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == ""


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_manners(path):
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") < MOST_LINES, "two rooms in one?"
    assert text.lstrip().startswith('"""'), "a module says first what it is"
    assert not re.search(r"\b(TODO|FIXME|XXX|HACK)\b|NotImplementedError", text)
    assert not re.search(r"""["'](/[A-Za-z]+/|[A-Z]:\\)""", text), "a path of one machine"
    assert not re.search(r"^\s*print\(.*#\s*debug|breakpoint\(\)|import pdb", text, re.MULTILINE)


def test_no_kernel_relaxes_arithmetic():
    """A product and a sum may be rounded once instead of twice, as every C compiler does; nothing more."""
    fused = 'fastmath={"contract"}'
    relaxed = [str(path) for path in PACKAGE.rglob("*.py") if "fastmath=" in path.read_text(encoding="utf-8").replace(fused, "")]
    assert relaxed == []
