# Two commands are enough: `make run` (the main study at quick size) and `make test`. Both make .venv themselves.
PYTHON ?= python3
OUT ?= out
PY := .venv/bin/python

.PHONY: run test lint full clean

run: .venv/ready
	$(PY) -m studies run fig14_single_inclusion --quick --out $(OUT)

full: .venv/ready
	.venv/bin/pip install --quiet --disable-pip-version-check -e '.[test,peers]'
	$(PY) -m studies run --out results

test: .venv/ready
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m pytest -n 2 --dist worksteal

.venv/ready: pyproject.toml
	$(PYTHON) -m venv .venv
	.venv/bin/pip install --quiet --disable-pip-version-check -e '.[test]'
	touch $@

clean:
	rm -rf .venv out
