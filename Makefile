# make setup   everything that is missing, into .venv (quick when nothing is)
# make demo    setup, then the main job: bring the can from table A to table B
# make test    setup with a headless browser, then linters, types and tests
# make lint    setup, then linters and types alone

# The first Python that is new and old enough; `make PYTHON=…` names another.
PYTHON ?= $(shell for name in python3 python3.12 python3.11; do \
	$$name -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null \
	&& echo $$name && break; done)
BIN := .venv/bin
# Options for the demo, such as `make demo ARGS="--seed 3 --view"`.
ARGS ?=
# Options for pytest, such as `make test TESTS="tests/skills -k navigate"`.
TESTS ?=
# Processes that run tests; each takes up to 1.5 GB.
JOBS ?= 2

.PHONY: help setup demo test lint clean
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

# One thread per process: the numerical libraries would otherwise quarrel over few cores.
test: lint
	@$(BIN)/python setup/browser.py
	OMP_NUM_THREADS=1 LP_NUM_THREADS=1 $(BIN)/pytest -q -n $(JOBS) --dist loadfile $(TESTS)

clean:
	rm -rf .venv build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
