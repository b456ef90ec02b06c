# Two commands: `make trials` runs the experiment, `make test` checks everything.
PYTHON ?= python3
BIN := .venv/bin

.PHONY: trials test checks kernel laws setup pictures

trials: setup
	@$(BIN)/herd run detection-case-study

# Both processes of the tests would compile the kernel as they start: it is compiled beside the checks, and the laws too.
test: setup
	@$(MAKE) --no-print-directory -j 2 kernel checks laws
	@$(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder

checks:
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-cache

kernel laws:
	@$(BIN)/python -m scripts.compile $@

setup: .venv/ready

.venv/ready: pyproject.toml constraints.txt scripts/bootstrap.sh
	@PYTHON="$(PYTHON)" sh scripts/bootstrap.sh

# The pictures in the README and in docs/.
pictures: setup
	@$(BIN)/python -m scripts.picture
	@$(BIN)/python -m scripts.formations
	@$(BIN)/python -m scripts.tasks
	@$(BIN)/python -m scripts.robot_herd
