# make figures: everything the paper shows.  make test: everything that proves it.
# make blind: the full set of blind tests and its scoreboard; hours on two cores, goes on where it was stopped.
# make reproduce: two clean minimal runs, the same bytes.  make compare: the full run against committed numbers.
# make slurm: the main job through a real scheduler, the same bytes (root, Debian's slurm-wlm).
# make report: one page with all that a run found.  make faults: kills, damages and fills up runs, half an hour.
# make fuzz: COUNT damaged configurations, data files and flow files each; a traceback, a hang or a warning fails.
PYTHON ?= python3
BIN := .venv/bin
CORES ?= 2
SEED ?= $(shell git rev-parse HEAD 2>/dev/null || echo blind)
CASES ?= --null 400 --liar 96 --single 1230 --double 100 --outside 90 --without 60 --sabotage 24 --puzzle 48
SHARE ?= 1/1
COUNT ?= 10000
FUZZERS := tests/test_configuration_fuzz.py tests/readers/test_reading_fuzz.py tests/cfd/test_flow_fuzz.py
SNAKEMAKE := PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/snakemake --cores $(CORES)

.PHONY: figures minimal report test blind reproduce compare slurm faults fuzz clean

figures: .venv/installed
	$(SNAKEMAKE)

minimal: .venv/installed
	$(SNAKEMAKE) --configfile config/minimal.yaml

report: .venv/installed
	$(SNAKEMAKE) results/report.html

test: .venv/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow/rules
	$(BIN)/pytest --numprocesses $(CORES)

blind: .venv/installed
	$(SNAKEMAKE) results/radiation_variations/60kW.nc results/radiation_variations/80kW.nc $(foreach power,50 70 90 100 110 120 130,results/radiation/$(power)kW.nc)
	$(BIN)/python workflow/blind/run.py --seed $(SEED) $(CASES) --share $(SHARE) --publish docs/scoreboard

reproduce: .venv/installed
	$(BIN)/python workflow/reproduce.py

compare: figures report
	$(BIN)/python workflow/reproduce.py --results results
	PLASMAPYRO_RESULTS=results $(BIN)/pytest -q tests/blind/test_main_story.py tests/pages/test_commands_on_results.py tests/report

slurm: figures
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python workflow/slurm_check.py

faults: .venv/installed
	$(BIN)/python workflow/faults.py

fuzz: .venv/installed
	PLASMAPYRO_FUZZ=$(COUNT) $(BIN)/pytest -q --numprocesses $(CORES) $(FUZZERS)

.venv/installed: environment.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --requirement environment.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

clean:
	rm -rf results
