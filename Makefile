# Two commands: `make trials` runs the experiment, `make test` checks everything.
PYTHON ?= python3
BIN := .venv/bin

.PHONY: trials test setup pictures

trials: setup
	@$(BIN)/herd run detection-case-study

test: setup
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-cache
	@$(BIN)/pytest -n 2 --dist loadfile

setup: .venv/ready

.venv/ready: pyproject.toml constraints.txt scripts/bootstrap.sh
	@PYTHON="$(PYTHON)" sh scripts/bootstrap.sh

# The pictures in the README and in docs/.
pictures: setup
	@$(BIN)/python -m scripts.picture
	@$(BIN)/python -m scripts.formations
