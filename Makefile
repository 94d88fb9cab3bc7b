# make setup   installs what is missing, into .venv (quick when nothing is missing)
# make demo    setup, then runs the main job: bring the can from table A to table B
# make test    setup with a headless browser, then runs linters, type checks and tests
# make quick   setup, then runs one test alone: make quick TESTS="tests/skills/test_pick.py -k slipped"
# make lint    setup, then runs linters and type checks
# make docs    setup, then builds the API reference in build/docs
# make clean   removes .venv, build outputs and caches

# The first supported Python that is found; `make PYTHON=…` names another.
PYTHON ?= $(shell for name in python3 python3.12 python3.11; do \
	$$name -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null \
	&& echo $$name && break; done)
BIN := .venv/bin
# Options for the demo, such as `make demo ARGS="--seed 3 --view"`.
ARGS ?=
# Options for pytest, such as `make test TESTS="tests/skills -k navigate"`.
TESTS ?=
# Number of processes that run tests; each takes up to 1.5 GB.
JOBS ?= 2

.PHONY: help setup demo test quick lint docs clean
help:
	@sed -n 's/^# \(make .*\)/\1/p' Makefile

setup:
	@if [ -z "$(PYTHON)" ]; then \
		echo "make setup: no Python 3.11 or 3.12 found (python3, python3.12, python3.11); install one," >&2; \
		echo "on Debian 12 and Ubuntu 24.04: apt install python3" >&2; exit 1; fi
	@$(PYTHON) setup/environment.py

demo: setup
	@mkdir -p runs
	@$(BIN)/momantu-bt run trees/bring_object.yaml --report runs/demo.json $(ARGS)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

# One thread per process: the numerical libraries would otherwise compete for few cores.
test: lint
	@$(BIN)/python setup/browser.py
	OMP_NUM_THREADS=1 LP_NUM_THREADS=1 $(BIN)/pytest -q -n $(JOBS) --dist loadfile $(TESTS)

quick: setup
	@if [ -z "$(TESTS)" ]; then \
		echo 'make quick: which test? make quick TESTS="tests/skills/test_pick.py -k slipped"' >&2; exit 1; fi
	@OMP_NUM_THREADS=1 LP_NUM_THREADS=1 $(BIN)/pytest -q $(TESTS)

docs: setup
	@$(BIN)/python setup/reference.py

clean:
	rm -rf .venv build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
