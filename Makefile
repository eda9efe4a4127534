# Two commands do everything on a fresh machine: `make demo` and `make test`.
# Another Python has its own environment: make test PYTHON=python3.13 VENV=.venv-3.13
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
SEED ?= 1
N ?= 20

.PHONY: venv producer demo demo-antenna demo-antenna-calibration demo-insertion demo-calibration ship-demo-calibration cell campaign campaign-mating campaign-faults campaign-tornado campaign-decks campaign-antenna campaign-insertion campaign-planning campaign-planned-demo bench bench-metrology bench-looks bench-hand-eye bench-guard bench-console bench-page page-pictures bench-power-cut bench-robot soak soak-robot bench-cameras soak-cameras bench-antenna-vision \
	format lint types imports check test test-in-time test-behind test-parallel test-talking test-computing test-version test-cell test-figures test-explore test-long coverage coverage-begin coverage-add coverage-report lock clean install rollback bundle

venv: $(VENV)/.installed

# The question is put in words that Python 2 understands too.
define TOO_OLD
import sys
if sys.version_info < (3, 11):
    sys.exit("cellctl needs Python 3.11 or newer; $(PYTHON) is %d.%d. Name another one: make PYTHON=python3.12" % sys.version_info[:2])
endef
export TOO_OLD

$(VENV)/.installed: requirements.lock pyproject.toml
	@$(PYTHON) -c "$$TOO_OLD"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation -e .
	touch $@

demo: venv
	$(BIN)/cellctl demo --seed $(SEED)

demo-antenna: venv
	$(BIN)/cellctl demo --process antenna-module --seed $(SEED) $(ARGS)

demo-antenna-calibration: venv
	$(BIN)/cellctl demo --process antenna-module --calibrate --seed $(SEED) $(ARGS)

demo-insertion: venv
	$(BIN)/cellctl demo --process peg-in-hole --cell connector --seed $(SEED) $(ARGS)

demo-calibration: venv
	$(BIN)/cellctl demo --calibrate --seed $(SEED) $(ARGS)

# The fake GenTL producer in FOLDER, for other programs; tests and demo compile their own.
FOLDER ?= .
producer: venv
	$(BIN)/python -m fakes.gentl.build $(FOLDER)

# RUN is the folder that demo-calibration has written; see docs/decisions/0004.
ship-demo-calibration: venv
	$(BIN)/python -m fakes.demo.ship $(RUN) config/demo-calibration

cell: venv
	$(BIN)/cellctl demo --stay --seed $(SEED)

campaign: venv
	$(BIN)/python -m benchmarks.campaign -n $(N)

campaign-mating: venv
	$(BIN)/python -m benchmarks.mating.campaign
	$(BIN)/python -m benchmarks.mating.campaign_pins

# Takes hours; interrupted, it goes on where it was. ONLY=FAULT/PHASE, with *, tries a part of it.
campaign-faults: venv
	$(BIN)/python -m benchmarks.faults.campaign --page docs/fault-matrix.md $(if $(ONLY),--only '$(ONLY)')

# Takes an hour and more; interrupted, it goes on where it was.
campaign-tornado: venv
	$(BIN)/python -m benchmarks.tornado --page docs/imperfections.md

# Takes an hour and more; interrupted, it goes on where it was.
campaign-decks: venv
	$(BIN)/python -m benchmarks.decks.campaign --page docs/decks.md

# Takes half an hour; QUICK=1 draws few cells and insertions, in a few minutes each.
campaign-antenna: venv
	$(BIN)/python -m benchmarks.antenna.chain.campaign $(if $(QUICK),--quick)
	$(BIN)/python -m benchmarks.antenna.insertion.campaign $(if $(QUICK),--quick)

# Searches take twenty minutes, whole cycles two to three hours; QUICK=1 draws few, in four minutes.
campaign-insertion: venv
	$(BIN)/python -m benchmarks.insertion.searches.campaign $(if $(QUICK),--quick)
	$(BIN)/python -m benchmarks.insertion.cycle_campaign $(if $(QUICK),--quick)
	$(BIN)/python -m benchmarks.insertion.trap_campaign $(if $(QUICK),--quick)
	$(BIN)/python -m benchmarks.insertion.fault_campaign $(if $(QUICK),--quick)
	$(BIN)/python -m benchmarks.insertion.task_sweep $(if $(QUICK),--quick)

# A hundred random cells take hours, for MuJoCo looks at every way each millimetre. N cells.
campaign-planning: N = 100
campaign-planning: venv
	$(BIN)/python -m benchmarks.planning.campaign -n $(N)

# Takes forty minutes: plans the cell of the deck, calibrates it there, and makes ten parts in it and in the taught one.
campaign-planned-demo: N = 10
campaign-planned-demo: venv
	$(BIN)/python -m benchmarks.planning.planned_demo -n $(N)

bench: bench-metrology bench-looks bench-hand-eye bench-guard

bench-metrology: venv
	$(BIN)/python -m benchmarks.metrology.accuracy
	$(BIN)/python -m benchmarks.metrology.deck_over_frame

bench-looks: venv
	$(BIN)/python -m benchmarks.metrology.looks

bench-hand-eye: venv
	$(BIN)/python -m benchmarks.calibration.hand_eye_comparison

bench-guard: venv
	$(BIN)/python -m benchmarks.guard.latency

# Wants Chromium. Renews the pictures of docs/operator-page.md: a fake cell makes a part, a procedure and a fault.
page-pictures: venv
	$(BIN)/python -m benchmarks.page.pictures

# What 50 readers of the page cost the cell, and a page that is frozen or gone; on a computer that has nothing else to do.
bench-page: venv
	$(BIN)/python -m benchmarks.page.clients

bench-console: venv
	$(BIN)/python -m benchmarks.console

# Wants root, who may mount an image. N power cuts for each kind of write: about a second each.
bench-power-cut: N = 100
bench-power-cut: venv
	$(BIN)/python -m benchmarks.power_cut -n $(N)

# On a computer that has nothing else to do. From the disk and not from memory, by root: --from-disk.
.PHONY: bench-start
bench-start: export PYTHONDONTWRITEBYTECODE =
bench-start: venv
	$(BIN)/python -m benchmarks.cold_start $(ARGS)

bench-robot: venv
	$(BIN)/python -m benchmarks.robot.rpc
	$(BIN)/python -m benchmarks.robot.acks
	$(BIN)/python -m benchmarks.robot.slow_jobs
	$(BIN)/python -m benchmarks.robot.stops

# Takes about a quarter of an hour; N motions on each of three ways to an arm.
soak-robot: N = 10000
soak-robot: venv
	$(BIN)/python -m benchmarks.robot.soak --moves $(N)

bench-cameras: venv
	$(BIN)/python -m benchmarks.cameras.throughput
	$(BIN)/python -m benchmarks.cameras.depth

# Takes half an hour. A short run: python -m benchmarks.cameras.soak --cycles 20 --pulls 10 --grabs 500
soak-cameras: venv
	$(BIN)/python -m benchmarks.cameras.soak

# Parts one after another on the fake cell for an hour; MINUTES. On a computer that has nothing else to do.
soak: MINUTES = 60
soak: venv
	$(BIN)/python -m benchmarks.soak --minutes $(MINUTES)

bench-antenna-vision: venv
	$(BIN)/python -m benchmarks.antenna.vision

# As a service of this PC, by root; see systemd/install.sh for PREFIX, PYTHON and INTO.
install rollback: export PYTHON := $(PYTHON)
install:
	@systemd/install.sh install

rollback:
	@systemd/install.sh rollback

# One archive for a PC without a network; KEY signs it.
bundle: venv
	@PYTHON=$(BIN)/python systemd/bundle.sh

format: venv
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

lint: venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: venv
	$(BEHIND) $(BIN)/mypy

imports: venv
	$(BIN)/lint-imports

# Beside each other, because the type checker fills one processor for most of a minute.
check: venv
	@$(MAKE) --no-print-directory -j 3 --output-sync=target lint types imports

# Tests that wait and whole cells leave the processors idle for part of their time. What only computes
# takes what they leave, and so does the type checker: both are behind everything that moves or listens.
test: lint imports
	$(MAKE) --no-print-directory -j 2 BEHIND="nice -n 19" test-in-time test-behind

test-in-time:
	$(MAKE) --no-print-directory test-talking
	$(MAKE) --no-print-directory test-cell

test-behind:
	$(MAKE) --no-print-directory types
	$(MAKE) --no-print-directory test-computing

# The tests are spread over the processors already; threads of BLAS beside them only wait for each
# other, and waiting costs them a third of the processors' time.
test-parallel test-talking test-computing test-version test-cell test-figures test-explore test-long coverage coverage-add: export OPENBLAS_NUM_THREADS = 1

# Many containers forbid Python to keep compiled modules. Here each of the programs that the tests
# start would compile all of cellctl anew, and each worker all tests.
test-parallel test-talking test-computing test-version test-cell test-figures test-explore test-long coverage coverage-add: export PYTHONDONTWRITEBYTECODE =

# Four workers fill two processors, since many tests wait: for programs, servers and timers. Not more
# where there are more processors: time limits within tests are those of two.
# What failed beside other tests is run once more, alone, unless it is more than a few.
AGAIN := --last-failed --last-failed-no-failures none --most-again 3
STANDARD := -m "not cell and not long and not figures"
test-parallel: venv
	$(BIN)/pytest -n 4 --ignore tests/cell $(STANDARD) --durations 25 || $(BIN)/pytest $(STANDARD) $(AGAIN)

# The two halves of these. What computes holds nothing against a clock and comes to no harm by waiting
# for a processor; it says what it found when it has ended, since other tests speak meanwhile.
COMPUTING := vision calibration force geometry planning cli/offline cli/planning records/report \
	$(addprefix fakes/,demo render scenes world) \
	$(addprefix benchmarks/,antenna calibration decks mating metrology planning samples) \
	$(addprefix processes/antenna_module/,chain checks commands connector insertion report vision) \
	$(addprefix processes/deck_to_frame/,checks report) \
	$(addprefix processes/peg_in_hole/,insertion offline plan plausible report search verdict)
TALKING := --ignore tests/cell $(COMPUTING:%=--ignore tests/unit/%)
test-talking: venv
	$(BIN)/pytest -n 4 $(TALKING) $(STANDARD) --durations 25 || $(BIN)/pytest $(STANDARD) $(AGAIN)

APART := -o cache_dir=.pytest_cache/computing --timeout 900
test-computing: venv
	@said=$$({ $(BEHIND) $(BIN)/pytest -n 2 $(APART) $(COMPUTING:%=tests/unit/%) $(STANDARD) --durations 10 || \
		$(BEHIND) $(BIN)/pytest $(APART) $(STANDARD) $(AGAIN); } 2>&1); ended=$$?; \
		printf '%s\n' "$$said"; exit $$ended

# What may differ from Python to Python: programs that talk, store, schedule and end. What computes
# or draws rests on numpy, scipy and OpenCV, of which the lock holds one version for all Pythons, and
# the page's scripts run in a browser: `test-parallel` tries these on one Python.
COMPUTES := vision calibration force geometry planning processes procedures fakes benchmarks \
	cli/offline cli/planning records/report hmi/page
WHERE_PYTHON_MATTERS := $(COMPUTES:%=--ignore tests/unit/%) tests/contracts tests/wire tests/programs tests/unit
test-version: venv
	$(BIN)/pytest -n 3 $(STANDARD) $(WHERE_PYTHON_MATTERS) || $(BIN)/pytest $(STANDARD) $(AGAIN) $(WHERE_PYTHON_MATTERS)

# A whole cell keeps real time with one test at a time only: without workers, and after the others.
test-cell: venv
	$(BIN)/pytest tests/cell -m "not long and not figures" --durations 25

# Accuracy over many draws, sweeps over every key, and of the other sweeps what is not their typical
# case, whole cells last: what holds for all code, at more seconds than whoever changes one part of
# it will wait.
# `.ci/run` runs them after `make test`.
test-figures: venv
	$(BIN)/pytest -n 3 -m "figures and not cell and not long" --durations 25 || \
		$(BIN)/pytest -m "figures and not cell and not long" $(AGAIN)
	$(BIN)/pytest tests/cell -m "figures and not long" --durations 10

# New examples, and ten times as many, for every test that draws its own.
test-explore: venv
	$(BIN)/pytest -n 3 -m "hypothesis and not cell and not long" --hypothesis-profile explore --timeout 900

test-long: venv
	$(BIN)/pytest -n 2 -m "long and not cell" --durations 0
	$(BIN)/pytest tests/cell -m long --durations 0
	rm -rf runs/faults-tenth
	$(BIN)/python -m benchmarks.faults.campaign --tenth $(SEED) --out runs/faults-tenth

# Leaves out the tests marked long, and takes those marked figures. The figures of each program that the tests start are combined.
# Code that is being measured runs several times slower, hence the longer time limit, and a test that
# fails must not cost the figures of all others: the report is printed in any case.
# In pieces: make coverage-begin, then make coverage-add TESTS=tests/unit/guard as often as there are
# pieces, then make coverage-report.
coverage: coverage-begin
	@failed=0; \
	$(MAKE) coverage-add TESTS=tests WORKERS="-n 3" || failed=1; \
	$(MAKE) coverage-add TESTS=tests/cell CELLS=cell || failed=1; \
	$(MAKE) coverage-report || failed=1; \
	exit $$failed

coverage-begin: venv
	$(BIN)/coverage erase

CELLS = not cell
coverage-add: venv
	$(BIN)/coverage run -m pytest $(TESTS) -q $(WORKERS) --timeout 900 -m "$(CELLS) and not long" || \
		$(BIN)/coverage run -m pytest $(TESTS) -q --timeout 900 -m "$(CELLS) and not long" $(AGAIN)

coverage-report: venv
	$(BIN)/coverage combine --quiet --keep
	$(BIN)/coverage report

lock: venv
	$(BIN)/uv pip compile pyproject.toml --extra dev --generate-hashes --no-emit-index-url \
		--universal --fork-strategy fewest --custom-compile-command "make lock" --quiet -o requirements.lock

clean:
	rm -rf $(VENV) build *.egg-info runs .pytest_cache .mypy_cache .ruff_cache .coverage .coverage.*
