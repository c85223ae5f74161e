# make run        environment, install, build, the paper's bump test with table and figures
# make test       the same set-up, then every test (10 minutes at most); make test-all adds the long ones
# make test-fast  tests that build nothing, in less than a minute
# make lint       style, types and the direction of imports; part of every kind of test
# make docs       the documentation site into site/, strictly: nothing is fetched, every link leads somewhere
# make fuzz       hostile input for MINUTES per target (1), see docs/reference/hostile-input.md
# make LOCKED=1 …  the same with the versions of requirements/locked.txt; make lock renews them
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --dist loadfile

MINUTES ?= 1
LOCK := requirements/locked.txt

.PHONY: run lint test test-fast test-all docs fuzz wheel lock clean

run: $(VENV)/installed
	$(BIN)/seat-cosim build
	$(BIN)/seat-cosim reproduce bump

lint: $(VENV)/installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: lint
	$(BIN)/seat-cosim build
	$(PYTEST) -m "not long"

test-fast: lint
	$(PYTEST) -m "not builds and not slow and not long"

test-all: lint
	$(BIN)/seat-cosim build
	$(PYTEST)

docs: $(VENV)/installed-docs
	$(BIN)/python -m seat_cosim.reference
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet

fuzz: $(VENV)/installed-fuzz
	$(BIN)/seat-cosim build
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.system.hostile.fuzz --minutes $(MINUTES)

# A wheel that carries native FMUs, systems and the master's loop in C for all platforms, and a source distribution.
# The date of all files in the wheel is fixed: the same sources give the same bytes.
wheel: $(VENV)/installed-release
	$(BIN)/seat-cosim build --flavour fmi2 --flavour fmi3 --platforms all --output fmus/built
	rm -rf dist
	SOURCE_DATE_EPOCH=315532800 $(BIN)/python -m build --outdir dist --sdist --wheel .
	$(BIN)/python -m twine check --strict dist/*

# The newest versions that pyproject.toml allows, for all platforms, with the hashes of their files.
lock: $(VENV)/installed-release
	$(BIN)/uv pip compile pyproject.toml --all-extras --universal --python-version 3.11 --generate-hashes \
	    --no-header --no-annotate --quiet --upgrade --output-file $(LOCK)

$(VENV)/python: Makefile
	$(PYTHON) -m venv $(VENV)
	$(if $(LOCKED),$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r $(LOCK))
	@touch $@

$(VENV)/installed: $(VENV)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/installed-test: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[native,test]"
	@touch $@

$(VENV)/installed-fuzz: $(VENV)/installed-test
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[fuzz]" || echo "not installed: atheris"
	@touch $@

$(VENV)/installed-release: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[native,release]"
	@touch $@

$(VENV)/installed-docs: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[native,docs]"
	@touch $@

clean:
	rm -rf $(VENV) results fmus/fmi2 fmus/fmi3 fmus/python fmus/built fmus/*.ssp cosim/engine/built build dist site *.egg-info
