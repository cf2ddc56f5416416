"""What a wheel brings beside the modules: coefficients, sample, style sheet."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "fieldline"


def test_patterns_of_the_package_data_take_every_file():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = settings["tool"]["setuptools"]["package-data"]["fieldline"]
    others = [path for path in PACKAGE.rglob("*") if path.is_file() and path.suffix not in (".py", ".pyc", ".nbi", ".nbc")]
    assert len(others) >= 6
    taken = {path for pattern in patterns for path in PACKAGE.glob(pattern)}
    assert sorted(str(path.relative_to(PACKAGE)) for path in set(others) - taken) == []
