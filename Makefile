# Everything from a fresh clone: make demo, make test, make docs. Needs Python 3.11 to 3.14, make and git.
# The first that runs (a shim may be there and not run) and can make an environment is taken.
# 3.14 comes late: what we need has wheels for it, but we do not test there. 3.15 has no rhino3dm.
PYTHONS := python3.13 python3.12 python3.11 python3.14 python3
USABLE := import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info < (3, 15))
PYTHON ?= $(shell for each in $(PYTHONS); do \
  if $$each -c '$(USABLE)' >/dev/null 2>&1; then echo $$each; break; fi; done)
BIN := .venv/bin
PACKAGES := kernel nodes fabrication viewer interfaces
# The editable install links files, so it is made anew when the list of files or pyproject.toml changes.
STATE := $(shell { find $(PACKAGES) -name '*.py' | LC_ALL=C sort; cat pyproject.toml; } | cksum | cut -d' ' -f1)
INSTALLED := .venv/installed-$(STATE)
# What users import names every parameter and result; inside, docstrings say what signatures do not.
FOR_USERS := nodes/library/*.py nodes/graphs/graph.py nodes/graphs/editor.py nodes/graphs/history.py \
  nodes/graphs/node.py nodes/graphs/ports.py nodes/graphs/sweeps/sweep.py \
  kernel/meshes/mesh.py kernel/sphere_meshes/sphere_mesh.py
# The root folder is a package; pytest must not import it by the name of the clone.
PYTEST = $(BIN)/python -m pytest -q -c pyproject.toml --rootdir tests
# Two processes of tests keep two cores busy: a thread of OpenBLAS in each is enough. If one dies
# the run ends there and says at which test: with another in its place it could wait for ever.
PARALLEL = OPENBLAS_NUM_THREADS=1 $(PYTEST) -n 2 --dist loadfile --max-worker-restart 0
# Sets of instructions between which OpenBLAS chooses by the processor; sums differ in the last
# bits. Haswell is what AMD processors get, Prescott the oldest. Ignored where there is no x86.
CORETYPES := Haswell Prescott

.PHONY: demo test test-long test-kernels release-check lint bench docs figures install system browser clean

demo: system
	$(BIN)/spheremesh panel -o out/demo --moulds 8 --thickness 0.02

test: lint browser
	$(PARALLEL) tests
	$(PYTEST) -p no:cacheprovider --doctest-modules --pyargs $(addprefix spheremesh.,$(PACKAGES))

test-long: system
	$(PARALLEL) -m long tests

test-kernels: system
	@for each in $(CORETYPES); do echo "OPENBLAS_CORETYPE=$$each"; \
	  OPENBLAS_CORETYPE=$$each $(PARALLEL) tests/kernel || exit 1; done

# The oldest libraries, none that is optional, and the wheel from an empty folder (noxfile.py).
release-check: system
	@$(BIN)/python -c 'import nox' 2>/dev/null || $(BIN)/python -m pip install -qq --group release
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/nox

lint: system
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports
	$(BIN)/numpydoc lint $$(git ls-files $(FOR_USERS))
	$(BIN)/numpydoc lint --ignore PR01,RT01 $$(git ls-files $(addsuffix /*.py,$(PACKAGES)))
	$(BIN)/vulture
	$(BIN)/deptry .

# About half an hour: docs/benchmarks.md, and lines in benchmarks/tables/history.jsonl.
bench: system
	@$(BIN)/python -c 'import pyceres' 2>/dev/null || $(BIN)/python -m pip install -qq --group bench
	$(BIN)/python benchmarks/tables/run.py

docs: system
	@$(BIN)/python -c 'import furo, myst_parser' 2>/dev/null || $(BIN)/python -m pip install -qq --group docs
	$(BIN)/python docs/site/build.py out/docs

# All pictures of README and docs, those of page and studio too, and the gallery with its numbers.
figures: system browser
	$(BIN)/python examples/pictures.py docs/images
	$(BIN)/python examples/page_pictures.py docs/images
	$(BIN)/python examples/figures/gallery.py

install: $(INSTALLED)

$(INSTALLED):
	@echo 'installing spheremesh and what it needs into .venv'
	@test -x $(BIN)/python || $(or $(PYTHON),false) -c '$(USABLE)' || { \
	  echo 'spheremesh needs Python 3.11 to 3.14 with venv (in Debian and Ubuntu the package python3-venv): make PYTHON=python3.12 ...' >&2; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install -qq --upgrade pip setuptools
	@$(BIN)/python -m pip install -qq -e . --group dev
	@rm -f .venv/installed-* && touch $@

# OCP (the kernel of CadQuery) needs two system libraries on Linux that slim images lack.
system: install
	@$(BIN)/python -c 'import OCP.gp' 2>/dev/null || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    apt-get update -q && apt-get install -q -y libgl1 libx11-6; \
	  else \
	    echo 'CadQuery objects and the tests need libGL.so.1 and libX11.so.6: install the packages libgl1 and libx11-6 (Debian, Ubuntu) or mesa-libGL and libX11 (Fedora).' >&2; \
	  fi; }

# Tests of the page use the system's Chromium; without it they are skipped.
browser: install
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    apt-get update -q && apt-get install -q -y chromium || true; \
	  else \
	    echo 'tests of the page are skipped: they need Chromium (in Debian and Fedora the package chromium).' >&2; \
	  fi; }

clean:
	rm -rf .venv build out spheremesh.egg-info
