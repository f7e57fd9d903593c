# `make demo` and `make test` require only Python 3.11 or later, make and a package registry.
SHELL := /bin/sh
VENV := .venv
BIN := $(VENV)/bin
# Python 3.11 first: the lock file is for it.
PYTHON := $(shell for p in python3.11 python3 python3.12 python3.13 python3.14; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo "$$p"; break; }; done)
# Three processes for two cores: many tests wait for commands that they start. Tests of a group share results within one process.
JOBS := $(shell n=$$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2); echo $$((n + (n + 1) / 2))) --dist loadgroup
# Tests and commands start hundreds of processes; without bytecode each of them compiles stepbot anew.
export PYTHONDONTWRITEBYTECODE :=
DEMO := robot_library/stepbot_four_bar/four_bar.robot.yaml
STAMP := $(VENV)/.stepbot-installed
# axe-core, for the tests of the page; the playwright that the package requires is not used.
AXE := axe-playwright-python==0.1.8

.PHONY: help install demo test test-long format lint types contracts generate fresh check wheels faults hostile mutation mutants library \
	benchmarks docs gate build all lock clean
.DEFAULT_GOAL := help

help:  ## print this
	@sed -n 's/^\([a-z-]*\):.*  ## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

install: $(STAMP)  ## create .venv with an editable stepbot and the development tools

$(STAMP): pyproject.toml requirements-ci.txt Makefile
	@test -n "$(PYTHON)" || { echo "Python 3.11 or later not found; set its path: make PYTHON=/path/to/python3.11"; exit 2; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { \
		echo "$(PYTHON) cannot make virtual environments; on Debian and Ubuntu: apt-get install python3-venv"; \
		rm -rf $(VENV); exit 2; }
	@echo "installing into $(VENV), about a minute"
	@if $(BIN)/python .ci/lock.py --fits; then \
		$(BIN)/python -m pip install --quiet --require-hashes -r requirements-ci.txt && \
		$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation -e .; \
	else $(BIN)/python -m pip install --quiet -e '.[dev]'; fi
	@$(BIN)/python -m pip install --quiet --no-deps $(AXE) || echo "$(AXE) could not be installed: tests with axe-core are skipped"
	@$(BIN)/python -m compileall -q src cli  # as pip does: without write permission for bytecode, Python would compile in each run
	@touch $@

demo: install  ## convert the four-bar linkage to all formats and verify the files
	$(BIN)/stepbot convert $(DEMO) -o build/demo/four_bar
	@command -v stepbot >/dev/null || echo "stepbot is not on the PATH, so: $(BIN)/stepbot view build/demo/four_bar"

test: install  ## run the tests that take less than about a third of a second; SLOW=1 runs the others too, as CI does
	$(BIN)/pytest -n $(JOBS) -m "not long$(if $(SLOW),, and not slow)"

test-long: install  ## run the tests that `make test SLOW=1` skips; some require build123d, dask, pre-commit
	$(BIN)/python -m pip install --quiet -e '.[dask,draw,hooks,newton,verify]'
	$(BIN)/pytest -n $(JOBS) -m long
	$(BIN)/pytest -n $(JOBS) -m hypothesis --hypothesis-profile long
	$(BIN)/pytest -n $(JOBS) tests/simulators tests/translation tests/conformance \
		tests/cli/test_cache.py tests/cli/test_diff_robots.py tests/cli/test_verify.py  # once more, with the engines of stepbot[newton,verify]

format: install  ## format the code
	$(BIN)/ruff format
	$(BIN)/ruff check --fix

lint: install  ## check format and style
	$(BIN)/ruff format --check
	$(BIN)/ruff check

types: install  ## check types
	$(BIN)/mypy

contracts: install  ## check import contracts
	$(BIN)/lint-imports

generate: install  ## update files generated from the code: schemas, tables in docs, help in the README
	$(BIN)/python docs/generate.py

fresh: install  ## check that generated files are up to date
	$(BIN)/python docs/generate.py --check

check: lint types contracts fresh  ## run all checks that are not tests

wheels: install  ## test the wheel in every installed Python from 3.11 to 3.14, including pyenv's
	$(BIN)/python .ci/wheels.py

faults: install  ## run commands on 2,000 damaged files (minutes); FAULTS=20000 takes less than an hour on two cores
	$(BIN)/python -m tests.hostile --only mutants --count $(or $(FAULTS),2000)

hostile: install  ## run all fault injection experiments and update benchmarks/RELIABILITY.md (hours)
	$(BIN)/python -m tests.hostile --page

mutation: install  ## remove and change parts of written files one by one, and update benchmarks/MUTATION.md (hours)
	$(BIN)/python -m pip install --quiet -e '.[verify]'
	$(BIN)/python -m tests.mutation.page
	$(BIN)/python -m tests.mutation.changed

mutants: install  ## change 400 places of the source one by one, and list what no test notices (hours); MINUTES=60 stops earlier
	$(BIN)/python -m tests.mutation.source --page $(if $(MINUTES),--minutes $(MINUTES))

docs: install  ## build the documentation as a site in build/site; with REPORTS=1 also the reports of the library
	$(BIN)/python -m pip install --quiet -e '.[docs]'
	@test -z "$(REPORTS)" || $(BIN)/stepbot batch robot_library -o build/reports --html
	$(BIN)/python docs/website.py

library: install  ## draw, convert, verify and render every robot of the library, and update its pages
	$(BIN)/python -m pip install --quiet -e '.[draw,verify]'
	$(BIN)/python -m robot_library

benchmarks: install  ## run every benchmark once on small input; benchmarks/NOTES.md describes measuring
	$(BIN)/python -m benchmarks smoke

gate: install  ## fail if stepbot needs 5 % more processor time than at the last tag on one of ten files, or at AGAINST=REVISION
	@if [ -n "$(AGAINST)" ] || git describe --tags >/dev/null 2>&1; then \
		$(BIN)/python -m benchmarks gate $(if $(AGAINST),--against $(AGAINST)); \
	else echo "PROCESSOR TIME IS NOT COMPARED: there is no tag; make gate AGAINST=REVISION"; fi

build: docs  ## build wheel and sdist, with the documentation
	rm -rf dist && $(BIN)/python -m hatchling build

all: SLOW := 1
all: check wheels test test-long faults library benchmarks gate build  ## everything except hostile, mutation and mutants

lock: install  ## pin the installed versions again, on Python 3.11, Linux x86-64
	mkdir -p build && $(BIN)/python .ci/lock.py > build/requirements-ci.txt && mv build/requirements-ci.txt requirements-ci.txt

clean:  ## remove build results
	rm -rf build dist .mypy_cache .ruff_cache .pytest_cache .import_linter_cache
