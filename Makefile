# Two commands are enough: `make run` (the main study at quick size) and `make test`. Both make .venv themselves.
PYTHON ?= python3
OUT ?= out
PY := .venv/bin/python
OLD := .venv-oldest
# Bytecode is made of what is imported, and not of all that is there: half of the time.
PIP := install --quiet --disable-pip-version-check --no-compile
# Tests start Python a hundred times: where it may keep no bytecode each compiles all that it imports, 2 s for Numba.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: run test test-all test-slow test-twins test-oldest full docs clean

run: .venv/studies
	$(PY) -m studies run fig14_single_inclusion --quick --out $(OUT)

full: .venv/ready
	.venv/bin/pip $(PIP) -e '.[test,peers]'
	$(PY) -m studies run --out results --clean --wait 3600

# The manual, without a network; `make test` builds it too.
docs: .venv/ready
	$(PY) -m sphinx -q -W --keep-going -b html docs $(OUT)/manual
	@echo $(OUT)/manual/index.html

# Warnings are errors (pyproject.toml).
test: .venv/ready
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m pytest -n 2 --dist worksteal -m "not slow"

# Quick rows of studies whose figures take long, and what others see in less time.
test-slow: .venv/ready
	$(PY) -m pytest -n 2 --dist worksteal -m slow

test-all: test test-slow test-twins test-oldest

# Kernels beside their slow twins, both as plain Python.
test-twins: .venv/ready
	NUMBA_DISABLE_JIT=1 $(PY) -m pytest -m twin

test-oldest: $(OLD)/ready
	$(OLD)/bin/python -m pytest -n 2 --dist worksteal

# What studies need; what tests need besides.
.venv/studies: pyproject.toml
	test -x $(PY) || $(PYTHON) -m venv .venv
	.venv/bin/pip $(PIP) -e '.[studies]'
	touch $@

.venv/ready: pyproject.toml
	test -x $(PY) || $(PYTHON) -m venv .venv
	.venv/bin/pip $(PIP) -e '.[test]'
	touch .venv/studies $@

$(OLD)/ready: pyproject.toml tests/oldest.txt
	$(PYTHON) -m venv $(OLD)
	$(OLD)/bin/pip $(PIP) -c tests/oldest.txt -e '.[test]'
	touch $@

clean:
	rm -rf .venv $(OLD) out
