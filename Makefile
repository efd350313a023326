# make run: set-up and the main job. make test: set-up and the tests. Nothing else has to be installed first.
SHELL := /bin/sh
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
export RERUN_ANALYTICS = 0

.PHONY: run test install lint types rooms acceptance system lock clean clean-results help

help:            ## list the targets
	@grep -hE '^[a-z-]+:.*##' Makefile | sed 's/:.*##/\t/'

run: install     ## install, compile the kernels, run the pipeline quickstart
	@"$(BIN)/vines" run quickstart

test: install    ## install, then run the tests
	@"$(BIN)/vines" warm-up
	@"$(BIN)/python" -m pytest -n auto --dist loadfile -m "not full" $(PYTEST_ARGS)

install: $(STAMP)  ## make .venv from the hashed lock

$(STAMP): requirements.lock pyproject.toml
	@test -x "$(BIN)/python" || $(PYTHON) -m venv "$(VENV)"
	@echo "installing the locked packages (about two minutes the first time)"
	@"$(BIN)/python" -m pip install -qq --disable-pip-version-check --require-hashes -r requirements.lock
	@"$(BIN)/python" -m pip install -qq --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch "$(STAMP)"

lint: install    ## ruff: style and format
	@"$(BIN)/ruff" check .
	@"$(BIN)/ruff" format --check .

types: install   ## basedpyright
	@"$(BIN)/basedpyright"

rooms: install   ## import-linter: the rooms of the house
	@"$(BIN)/lint-imports" --no-cache

acceptance: install  ## everything in full; writes docs/acceptance.md
	@"$(BIN)/python" -m benchmarks.acceptance

system:          ## Debian packages for the viewer's pictures in tests: software Vulkan, and Chromium for the web page
	@if ldconfig -p | grep -q libvulkan.so.1 && ls /usr/share/vulkan/icd.d/lvp_icd*.json >/dev/null 2>&1 \
	  && command -v chromium >/dev/null; then \
	  echo "software Vulkan and Chromium are there"; \
	else \
	  apt-get update -qq && \
	  apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers libvulkan1 chromium; \
	fi

lock:            ## renew requirements.lock
	@"$(BIN)/pip-compile" --quiet --upgrade --generate-hashes --allow-unsafe --strip-extras --extra dev \
	  --no-emit-index-url --no-emit-find-links --output-file=requirements.lock pyproject.toml

clean:           ## remove the virtual environment and what can be made again; results stay
	rm -rf "$(VENV)" data/cache

clean-results:   ## remove all results
	rm -rf data/results data/points data/pipelines data/staging
