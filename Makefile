# Two commands do everything on a fresh machine: `make demo` and `make test`.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
SEED ?= 1
N ?= 20

.PHONY: venv demo demo-calibration cell test test-long check lint types imports lock campaign campaign-mating bench bench-metrology bench-looks bench-guard clean

venv: $(VENV)/.installed

$(VENV)/.installed: requirements.lock pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation -e .
	touch $@

demo: venv
	$(BIN)/cellctl demo --seed $(SEED)

demo-calibration: venv
	$(BIN)/cellctl demo --calibrate --seed $(SEED)

cell: venv
	$(BIN)/cellctl demo --stay --seed $(SEED)

campaign: venv
	$(BIN)/python -m benchmarks.campaign -n $(N)

campaign-mating: venv
	$(BIN)/python -m benchmarks.campaign_mating
	$(BIN)/python -m benchmarks.campaign_mating_pins

bench: bench-metrology bench-looks bench-guard

bench-metrology: venv
	$(BIN)/python -m benchmarks.metrology

bench-looks: venv
	$(BIN)/python -m benchmarks.metrology_looks

bench-guard: venv
	$(BIN)/python -m benchmarks.guard

lint: venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: venv
	$(BIN)/mypy

imports: venv
	$(BIN)/lint-imports

check: lint types imports

test: check
	$(BIN)/pytest -n 2 -m "not long" --durations 25

test-long: venv
	$(BIN)/pytest -n 2 -m long

lock: venv
	$(BIN)/uv pip compile pyproject.toml --extra dev --extra gige --generate-hashes --no-emit-index-url \
		--universal --fork-strategy fewest --custom-compile-command "make lock" --quiet -o requirements.lock

clean:
	rm -rf $(VENV) build *.egg-info runs .pytest_cache .mypy_cache .ruff_cache
