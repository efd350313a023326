# make run: set-up and the main job. make test: set-up and the tests. Nothing else has to be installed first.
SHELL := /bin/sh
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
INSTALLED_DEV := $(VENV)/.installed-dev
# Byte-compiling every package takes as long as fetching it, and few of the modules are ever imported: Python does it
# for those that are, when they are, and is not to be kept from it.
unexport PYTHONDONTWRITEBYTECODE
PIP := "$(BIN)/python" -m pip install -qq --disable-pip-version-check --no-compile
export RERUN_ANALYTICS = 0

.PHONY: screens run test install lint types rooms acceptance docs system lock clean clean-results help

help:            ## list the targets
	@grep -hE '^[a-z-]+:.*##' Makefile | sed 's/:.*##/\t/'

run: $(INSTALLED)  ## install what runs, compile the kernels, run the pipeline quickstart
	@"$(BIN)/vines" run quickstart

test: $(INSTALLED_DEV)  ## install what tests too, then run the tests
	@"$(BIN)/vines" warm-up
	@"$(BIN)/python" -m pytest -n auto --dist loadfile -m "not full" $(PYTEST_ARGS)

install: $(INSTALLED_DEV)  ## make .venv from the hashed locks (run, dev), byte-compiled, to be used by hand
	@"$(BIN)/python" -m compileall -q -j 0 "$(VENV)"

$(INSTALLED): requirements.lock pyproject.toml vines/__init__.py
	@test -x "$(BIN)/python" || $(PYTHON) -m venv "$(VENV)"
	@echo "installing what vines needs to run (half a minute the first time)"
	@$(PIP) --require-hashes -r requirements.lock
	@$(PIP) --no-deps --no-build-isolation -e .
	@touch "$(INSTALLED)"

$(INSTALLED_DEV): $(INSTALLED) requirements-dev.lock
	@echo "installing what develops and tests vines (half a minute the first time)"
	@$(PIP) --require-hashes -r requirements-dev.lock
	@touch "$(INSTALLED_DEV)"

lint: $(INSTALLED_DEV)  ## ruff: style and format
	@"$(BIN)/ruff" check .
	@"$(BIN)/ruff" format --check .

types: $(INSTALLED_DEV)  ## basedpyright
	@"$(BIN)/basedpyright"

rooms: $(INSTALLED_DEV)  ## import-linter: the rooms of the house
	@"$(BIN)/lint-imports" --no-cache

acceptance: $(INSTALLED_DEV)  ## everything in full; writes docs/acceptance.md
	@"$(BIN)/python" -m benchmarks.acceptance

screens: $(INSTALLED_DEV)  ## the viewer's page in Chromium and Rerun without our layout, which make test leaves out
	@"$(BIN)/python" -m pytest -q -m full tests/viewer/test_web.py tests/viewer/test_picture.py

system:          ## Debian packages for tests: software Vulkan and Chromium for pictures, SLURM for job arrays
	@if ldconfig -p | grep -q libvulkan.so.1 && ls /usr/share/vulkan/icd.d/lvp_icd*.json >/dev/null 2>&1 \
	  && command -v chromium >/dev/null && command -v slurmctld >/dev/null && command -v slurmd >/dev/null \
	  && command -v munged >/dev/null && command -v sbatch >/dev/null; then \
	  echo "software Vulkan, Chromium and SLURM are there"; \
	else \
	  apt-get update -qq && \
	  apt-get install -y -qq --no-install-recommends \
	    mesa-vulkan-drivers libvulkan1 chromium slurmctld slurmd slurm-client munge; \
	fi

# The widest first: the others take its versions.
COMPILE := "$(BIN)/pip-compile" --quiet --generate-hashes --allow-unsafe --strip-extras \
  --no-emit-index-url --no-emit-find-links

docs: $(INSTALLED_DEV)  ## make the pages of docs/ a site, in site/; a warning is an error
	@"$(BIN)/python" -m sphinx --quiet --fail-on-warning -b html docs site
	@echo "site/index.html"

lock: $(INSTALLED_DEV)  ## renew requirements-dev.lock, requirements.lock and requirements-node.lock
	@$(COMPILE) --upgrade --extra dev --build-deps-for wheel --output-file=requirements-dev.lock pyproject.toml
	@$(COMPILE) --upgrade --build-deps-for wheel --constraint=requirements-dev.lock \
	  --output-file=requirements.lock pyproject.toml
	@$(COMPILE) --upgrade --constraint=requirements-dev.lock \
	  --output-file=requirements-node.lock requirements-node.in

clean:           ## remove the virtual environment and what can be made again; results stay
	rm -rf "$(VENV)" data/cache

clean-results:   ## remove all results
	rm -rf data/results data/points data/pipelines data/staging
