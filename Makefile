# Everything a checkout needs, from nothing but make and Python 3.11 (or 3.12).
#
#   make demo    install, then run the first scenario
#   make test    install, then run the tests
#   make check   formatter, linter, types, tests, laws, a wheel in an empty environment, docs: what a change must pass
#   make laws    property tests on fresh examples; it prints the seed that draws the same ones again
#   make fuzz    a campaign of generated inputs, which resumes; writes docs/robustness.md (a quarter of an hour)
#   make docs    the reference of public names, from their docstrings, into out/site
#   make bench   measure reasoner and estimator beside their peers, into docs/benchmarks.md (about a quarter of an hour)
#   make lowest  part of the tests with the lowest versions that pyproject.toml allows, into build/lowest
#   make setup   install only
#   make lock    choose the newest versions of all dependencies anew
#   make clean   remove everything that the others made

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

PYTHON ?= $(shell for p in python3.11 python3.12 python3; do \
	$$p -c 'import sys; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 12)))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip -qq --disable-pip-version-check
PACKAGES := rules reasoner estimation sim traces tools
TOP := __init__.py __main__.py py.typed
SCENARIO := scenarios/sim1_green.yaml
SEED := 0
WORKERS ?= 2
DRAWS ?= $(shell echo $$RANDOM$$RANDOM)
EXAMPLES ?= 10
SECONDS_OF_FUZZ ?= 900
TRACE := out/$(basename $(notdir $(SCENARIO)))-$(SEED).mcap

.PHONY: help setup demo test laws fuzz check lint wheel docs bench lowest lock clean

help:
	@sed -n '3,$${/^#/!q;s/^# \{0,1\}//p}' Makefile

setup: $(VENV)/installed $(PACKAGES:%=.types/skolem/%) $(TOP:%=.types/skolem/%)

$(VENV)/bin/python:
	@test -n "$(PYTHON)" || { echo "skolem needs Python 3.11 or 3.12 as python3.11, python3.12 or python3" >&2; exit 1; }
	@echo "making $(VENV) with $$($(PYTHON) --version)"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/installed: requirements.lock pyproject.toml | $(VENV)/bin/python
	@echo "installing the locked dependencies"
	@.ci/prepare-312 $(BIN)/python
	@$(PIP) install -r requirements.lock
	@$(PIP) install --no-deps --editable .
	@touch $@

# The folders stand at the top and the import name is skolem.FOLDER: type checkers need to see them under one roof.
$(PACKAGES:%=.types/skolem/%): .types/skolem/%:
	@mkdir -p .types/skolem
	@ln -sfn ../../$* $@

$(TOP:%=.types/skolem/%): .types/skolem/%:
	@mkdir -p .types/skolem
	@ln -sfn ../../package/$* $@

demo: setup
	$(BIN)/skolem run $(SCENARIO) --seed $(SEED) -o $(TRACE)

# Workers take neighbouring tests, which share recorded runs. Compiled tests are kept, for workers and child processes.
test: setup
	PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -q -n $(WORKERS) --dist worksteal

# Draws are random here alone: everywhere else the same inputs give the same bytes.
laws: DRAWS := $(DRAWS)
laws: setup
	@echo "property tests on fresh examples, $(EXAMPLES) for every 100 of the tests'; again: make laws DRAWS=$(DRAWS) EXAMPLES=$(EXAMPLES)"
	EXAMPLES=$(EXAMPLES) $(BIN)/python -m pytest -q -n $(WORKERS) -m hypothesis --hypothesis-profile=fresh --hypothesis-seed=$(DRAWS)

fuzz: setup
	PYTHONPATH=tests:. $(BIN)/python -m benchmarks.robustness --seconds $(SECONDS_OF_FUZZ)

check: lint test laws wheel docs

lint: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

wheel: setup
	.ci/check-wheel $(BIN)/python $(SCENARIO)

docs: setup
	$(BIN)/python -m mkdocs build --quiet

bench: setup
	$(BIN)/python -m benchmarks

# Whoever installs beside other packages may get these versions: a bound that does not hold is raised.
lowest: LOWEST := build/lowest
lowest: setup
	@$(PIP) install uv
	$(BIN)/python -m venv --clear $(LOWEST)
	$(BIN)/uv pip install --quiet --python $(LOWEST)/bin/python --resolution lowest-direct --editable '.[dev]'
	timeout 60 $(LOWEST)/bin/python -m skolem rules check
	$(LOWEST)/bin/python -m pytest -q -n $(WORKERS) -m 'not physics and not viewer' \
		tests/reasoner tests/rules tests/estimation tests/traces tests/sim tests/tools/run tests/tools/rules

lock: $(VENV)/bin/python
	@$(PIP) install uv
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --fork-strategy fewest --extra dev --extra bench --extra docs \
		--no-header --no-annotate --no-emit-index-url --no-emit-find-links --upgrade pyproject.toml -o requirements.lock

clean:
	rm -rf $(VENV) .types build dist out *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
