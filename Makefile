# Needs Python >= 3.11 and make, nothing else: every target makes its own environment in .venv.
#
#   make demo     the five-bar linkage: three tables, a comparison and a figure in build/demo
#   make test     lint, types, tests
#   make test-lanes   tests of the compiled kernels, with numba (extra fast)
#   make lint     ruff and mypy alone
#   make bench    timings side by side with other ways to the same numbers (docs/benchmarks.md)
#   make setup    the development environment
#   make clean    remove the environment and everything built

SHELL := /bin/bash
VENV ?= .venv
WORKERS ?= 2
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --quiet --disable-pip-version-check
DEMO := build/demo

# The first Python that is new enough and can make an environment.
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3 python; do \
	if $$p -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; \
	then echo $$p; break; fi; done)

# One thread a process: small matrices gain nothing from more, and results must not depend on it.
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-lanes lint bench clean

help:
	@sed -n '2,$$ { /^#/!q; s/^# \{0,1\}//p }' Makefile

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "no Python >= 3.11 with venv found: install one, or say make PYTHON=/path/to/python" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/.demo-ready: pyproject.toml | $(BIN)/python
	$(PIP) install --editable ".[plot]"
	@touch $@

$(VENV)/.dev-ready: pyproject.toml | $(BIN)/python
	$(PIP) install --editable ".[dev]"
	@touch $@

setup: $(VENV)/.dev-ready

demo: $(VENV)/.demo-ready
	@mkdir -p $(DEMO)
	$(BIN)/vincula analyze example:five-bar --active o1,o5
	$(BIN)/vincula analyze example:five-bar --active o2,o4
	$(BIN)/vincula analyze example:five-bar --active all
	$(BIN)/vincula compare example:five-bar --active o1,o5 --active o2,o4 --active all
	$(BIN)/vincula plot example:five-bar --active o1,o5 --active o2,o4 --active all -o $(DEMO)/five-bar.svg
	$(BIN)/vincula plot example:five-bar --active o1,o5 --active o2,o4 --active all -o $(DEMO)/five-bar.png

lint: $(VENV)/.dev-ready
	$(BIN)/ruff check .
	$(BIN)/mypy

test: lint
	$(BIN)/pytest -q -n $(WORKERS)

# Without numba these tests are skipped: kernels take minutes to compile the first time.
test-lanes: $(VENV)/.dev-ready
	$(PIP) install --editable ".[fast]"
	$(BIN)/pytest -q -n $(WORKERS) tests/unit/kernels tests/laws/test_batch_is_loop.py tests/laws/test_batch_weights.py

# Yardsticks are installed for the benchmark alone; it goes on without those that cannot be had.
$(VENV)/.bench-ready: pyproject.toml benchmarks/requirements.txt benchmarks/requirements-gpl.txt | $(BIN)/python
	$(PIP) install --editable ".[fast,mujoco]"
	-$(PIP) install --requirement benchmarks/requirements.txt
	-$(PIP) install --requirement benchmarks/requirements-gpl.txt
	@touch $@

bench: $(VENV)/.bench-ready
	$(BIN)/python benchmarks/bench.py
	$(BIN)/python benchmarks/single.py
	$(BIN)/python benchmarks/rank_table.py

clean:
	rm -rf $(VENV) build dist .mypy_cache .pytest_cache .ruff_cache .hypothesis
