# make demo    estimate the flown orbit that comes with the package, and say where the report is
# make test    the whole suite, and the kernels' tests with JIT off and with bounds checking
# make lint    format, rules, types and layers
# make bench   the tables of docs/benchmarks.md, remade
# make clean   remove all that make made
#
# Only Python 3.11 or later and make are needed; everything is installed into the folder .venv.

PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo "$$p" && break; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check -qq install
# a file's tests stay in one process: they share what they have flown
PYTEST := $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile
# code compiled with bounds checking must not meet the other in one cache
BOUNDS_CACHE := $(CURDIR)/$(VENV)/numba-bounds

.DEFAULT_GOAL := demo
.PHONY: demo test suite kernels-plain kernels-bounds lint bench clean

$(VENV)/made:
	@test -n "$(PYTHON)" || { echo "Fieldline needs Python 3.11 or later, and none of python3, python3.11 ... is one. Install it, or name it: make PYTHON=/path/to/python"; exit 1; }
	@echo "making $(VENV) with $$($(PYTHON) --version)"
	@$(PYTHON) -m venv $(VENV) || { echo "$(PYTHON) cannot make virtual environments; on Debian and Ubuntu install the package python3-venv."; exit 1; }
	@touch $@

$(VENV)/made-run: $(VENV)/made pyproject.toml
	@echo "installing Fieldline"
	@$(PIP) -e .
	@touch $@

$(VENV)/made-test: $(VENV)/made pyproject.toml
	@echo "installing Fieldline and what its tests need"
	@$(PIP) -e '.[test]'
	@touch $@ $(VENV)/made-run

$(VENV)/made-lint: $(VENV)/made pyproject.toml
	@echo "installing Fieldline and the linters"
	@$(PIP) -e '.[test,lint]'
	@touch $@ $(VENV)/made-test $(VENV)/made-run

$(VENV)/made-bench: $(VENV)/made pyproject.toml
	@echo "installing Fieldline and what it is measured against"
	@$(PIP) -e '.[bench]'
	@touch $@ $(VENV)/made-run

demo: $(VENV)/made-run
	@$(BIN)/fieldline demo --out demo

# the suite comes last: its closing line is the one to read
test:
	@$(MAKE) --no-print-directory kernels-plain
	@$(MAKE) --no-print-directory kernels-bounds
	@$(MAKE) --no-print-directory suite

kernels-plain: $(VENV)/made-test
	@echo "kernels' tests, JIT off"
	@NUMBA_DISABLE_JIT=1 $(PYTEST) -m "kernels and not slow"

# flights stay out: to compile the whole loop with bounds checks takes minutes; with JIT off it flies, its kernels are here
kernels-bounds: $(VENV)/made-test
	@echo "kernels' tests, bounds checked"
	@NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(BOUNDS_CACHE) $(PYTEST) -m "kernels and not slow and not flight"

suite: $(VENV)/made-test
	@echo "compiling the plant, a minute or two where it is not in the cache"
	@$(BIN)/python tests/support/compile_once.py
	@echo "the whole suite"
	@$(PYTEST)

lint: $(VENV)/made-lint
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .
	@$(BIN)/pyright --pythonpath $(BIN)/python
	@$(BIN)/lint-imports

bench: $(VENV)/made-bench
	@$(BIN)/python benchmarks/run.py --write docs/benchmarks.md

clean:
	rm -rf $(VENV) demo dist build .pytest_cache .ruff_cache .hypothesis .import_linter_cache src/*.egg-info
	find src tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +
