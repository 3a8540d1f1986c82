# Every target makes its own environment in .venv: a machine with python3.11 and its venv module,
# gcc and make is enough. Another interpreter: make test PYTHON=/path/to/python3.11

PYTHON ?= python3.11
# The C is compiled with every warning an error.
export REALITYGAP_DEVELOPMENT := 1
BIN := .venv/bin
PIP := $(BIN)/python -m pip -qq --disable-pip-version-check --no-input --retries 10
STAMP := .venv/.installed

PACKAGES := embedded_sim reality models studies
PACKAGING := pyproject.toml setup.py constraints.txt
# The C that people write; cffi's own output (_core.c, _optics.c) is not among it.
C_FILES := $(shell find embedded_sim reality tests -name '[!_]*.[ch]' 2>/dev/null | sort)
BUILD_INPUTS := $(filter-out tests/%,$(C_FILES)) \
    $(wildcard embedded_sim/build_*.py reality/build_*.py)
CORE_C := $(wildcard embedded_sim/core/*.c)
CORE_H := $(wildcard embedded_sim/core/*.h)

.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help demo test slow lint site references mutants bench asan fuzz fuzz-core real blind kills clean

help: ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(STAMP) ## the whole story in a few minutes; the page is out/demo/report.html
	$(BIN)/realitygap demo --out out/demo --force

test: $(STAMP) ## the tests, in parallel, without the slow and the blind ones
	$(BIN)/python -m pytest -n auto --dist worksteal tests

slow: $(STAMP) ## the long batteries that `make test` leaves out
	$(BIN)/python -m pytest -n auto --dist worksteal -m slow tests

lint: $(STAMP) ## style, types, import rules, C formatting
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy -p realitygap
	$(BIN)/lint-imports
	$(BIN)/clang-format --dry-run --Werror $(C_FILES)

site: $(STAMP) ## the documents as a site in build/site
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --site-dir build/site

HEALTH := $(BIN)/realitygap reference --force --out models/naming/health/references
references: $(STAMP) ## sensor tables, healthy references and kept logs anew, after a change of the world or a new cause
	$(BIN)/realitygap capture --out models/belief/captured/epuck.npz --force
	$(HEALTH)/pybullet/e-puck.json --runs 40 --seed 11
	$(HEALTH)/pybullet/manoeuvres/e-puck.json --runs 13 --seed 21 --manoeuvres
	$(HEALTH)/mujoco/e-puck.json --runs 20 --seed 11 --engine mujoco
	$(BIN)/python -m tests.golden logs
	$(BIN)/python -m tests.golden answers

mutants: $(STAMP) ## whether the tests notice the faults listed in tests/mutants.toml; by hand only
	$(BIN)/python -m tests.mutants $(ONLY)

bench: $(STAMP) ## the benchmarks; numbers in out/bench.json
	$(BIN)/realitygap measure bench --out out/bench.json --force

asan: build/asan/asan_main build/asan/fuzz_main build/asan/asan_optics ## the C under the address and undefined-behaviour sanitizers
	./$<
	./build/asan/fuzz_main 20000
	./build/asan/asan_optics

fuzz-core: build/asan/fuzz_main ## random structures against the C core; CALLS=1000000 SEED=1
	./$< $(or $(CALLS),1000000) $(or $(SEED),1)

fuzz: $(STAMP) fuzz-core ## damaged inputs for every reader, REALITYGAP_FUZZ of each, and the C core; counts in out/fuzz
	REALITYGAP_FUZZ=$${REALITYGAP_FUZZ:-400} $(BIN)/python -m pytest -n auto tests/fuzz

real: $(STAMP) ## real robots' logs of REALITYGAP_DATA: the table, and pages in out/real
	$(BIN)/realitygap measure real --out out/real --force

blind: $(STAMP) ## the blind battery; results in out/blind
	$(BIN)/realitygap blind --out out/blind

KILLS ?= study=20 run=5 diagnose=5 gain=5 transfer=5 blind=5
kills: $(STAMP) ## commands killed at random instants: KILLS="study=200 run=50" KILLS_SEED=1
	$(BIN)/python -m tests.kills --kills $(KILLS) --seed $(or $(KILLS_SEED),0)

clean: ## remove the environment, builds and caches; results in out/ stay
	rm -rf .venv build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis \
	    .benchmarks .import_linter_cache
	rm -f embedded_sim/_core.c embedded_sim/_core*.so reality/_optics.c reality/_optics*.so
	find $(wildcard $(PACKAGES) tests) -name __pycache__ -type d -prune -exec rm -rf {} +

SANITIZED := $(CC) -std=c11 -g -O1 -fsanitize=address,undefined,float-cast-overflow \
    -fno-sanitize-recover=all -Wall -Wextra -Werror -Wno-psabi -ffp-contract=off

build/asan/%: tests/embedded_sim/%.c $(CORE_C) $(CORE_H)
	@mkdir -p $(@D)
	$(SANITIZED) -Iembedded_sim/core $(filter %.c,$^) -o $@ -lm

build/asan/%: tests/reality/%.c reality/optics/optics.c reality/optics/optics.h
	@mkdir -p $(@D)
	$(SANITIZED) -Ireality/optics $(filter %.c,$^) -o $@ -lm

# A changed packaging file installs anew; changed C only rebuilds the extensions.
$(STAMP): $(PACKAGING) $(BUILD_INPUTS)
	$(if $(filter $(PACKAGING),$?),$(install),$(rebuild))
	@touch $@

define check_python
import os, sys, sysconfig, ensurepip, venv; \
sys.exit(sys.version_info[:2] != (3, 11) \
or not os.path.exists(sysconfig.get_path("include") + "/Python.h"))
endef

define install
$(if $(shell $(PYTHON) -c '$(check_python)' >/dev/null 2>&1 || echo bad),$(error $\
    '$(PYTHON)' is not Python 3.11 with venv and its C headers (pybullet has no wheels for later $\
    versions); set PYTHON=/path/to/python3.11))
@echo "Installing into .venv (a few minutes the first time)"
@$(PYTHON) -m venv --clear .venv
@$(PIP) install -c constraints.txt setuptools wheel cffi
@$(PIP) install -c constraints.txt --no-build-isolation -e '.[dev]'
endef

define rebuild
@echo "Rebuilding the C extensions"
@$(BIN)/python setup.py --quiet build_ext --inplace --force
endef
