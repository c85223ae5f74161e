# make run        environment, install, build, the paper's bump test with table and figures
# make test       the same set-up, then every test (10 minutes at most); make test-all adds the long ones
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin

.PHONY: run test test-all clean

run: $(VENV)/installed
	$(BIN)/seat-cosim build --flavour fmi2
	$(BIN)/seat-cosim reproduce bump

test: $(VENV)/installed-test
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -m "not long"

test-all: $(VENV)/installed-test
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest

$(VENV)/python: Makefile
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/installed: $(VENV)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[native]"
	@touch $@

$(VENV)/installed-test: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[native,test]"
	@touch $@

clean:
	rm -rf $(VENV) results fmus/fmi2 fmus/fmi3 fmus/python build dist *.egg-info
