# make figures: everything the paper shows.  make test: everything that proves it.
# make blind: the full set of blind tests and its scoreboard; hours on two cores, goes on where it was stopped.
# make reproduce: two clean minimal runs, the same bytes.  make compare: the full run against committed numbers.
# make slurm: the main job through a real scheduler, the same bytes (root, Debian's slurm-wlm).
# make report: one page with all that a run found.  make faults: kills, damages and fills up runs, half an hour.
# make fuzz: COUNT damaged configurations, data files and flow files each; a traceback, a hang or a warning fails.
# make campaign: a synthetic campaign of ten tests with a hidden law, after make figures: two minutes.
# make simulations: what the package brings along, from the results of a run.
# make light: the built wheel alone in a clean environment of each Python there is: size, time, example to page.
# make site: these documents as a site in build/site, with formulas; read without a network.
# make lock: both lock files anew from pyproject.toml, kept versions kept (needs uv; --upgrade-package NAME moves one).
PYTHONS := python3.11 python3.12 python3.13 python3.14 python3 $(wildcard $(HOME)/.pyenv/versions/3.1[1-4]*/bin/python3)
SUITABLE := -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))'
PYTHON ?= $(firstword $(foreach each,$(PYTHONS),$(shell $(each) $(SUITABLE) 2>/dev/null && echo $(each))))
BIN := .venv/bin
CORES ?= 2
SEED ?= $(shell git rev-parse HEAD 2>/dev/null || echo blind)
CASES ?= --null 400 --liar 96 --single 1230 --double 100 --outside 90 --without 60 --sabotage 24 --puzzle 48
SHARE ?= 1/1
COUNT ?= 10000
FUZZERS := tests/test_configuration_fuzz.py tests/readers/test_reading_fuzz.py tests/cfd/test_flow_fuzz.py
SNAKEMAKE := PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/snakemake --cores $(CORES)

PIP := $(BIN)/pip install --quiet --disable-pip-version-check
LOCK := uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes --no-annotate --custom-compile-command "make lock"

.PHONY: figures minimal report test style blind reproduce compare slurm faults fuzz lock simulations campaign light site clean

figures: .venv/installed
	$(SNAKEMAKE)

minimal: .venv/installed
	$(SNAKEMAKE) --configfile config/minimal.yaml

report: .venv/installed
	$(SNAKEMAKE) results/report.html

test: .venv/tested
	$(MAKE) --jobs $(CORES) site style
	$(BIN)/pytest --numprocesses $(CORES) --dist worksteal

style: .venv/tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow/rules

blind: .venv/installed
	$(SNAKEMAKE) results/radiation_variations/60kW.nc results/radiation_variations/80kW.nc $(foreach power,50 70 90 100 110 120 130,results/radiation/$(power)kW.nc)
	$(BIN)/python workflow/blind/run.py --seed $(SEED) $(CASES) --share $(SHARE) --publish docs/scoreboard

reproduce: .venv/tested
	$(BIN)/python tests/runs/reproduce.py

compare: figures report .venv/tested
	$(BIN)/python tests/runs/reproduce.py --results results
	PLASMAPYRO_RESULTS=results $(BIN)/pytest -q --numprocesses $(CORES) tests/blind/test_main_story.py tests/pages/test_commands_on_results.py tests/report \
	  tests/radiation/test_stored_table.py \
	  --deselect tests/blind/test_main_story.py::test_effects_hidden_in_the_default_test_are_named_sized_and_cured \
	  tests/test_public_functions.py::test_the_shipped_simulations_are_those_of_a_run

slurm: figures .venv/tested
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python tests/runs/slurm_check.py

faults: .venv/tested
	$(BIN)/python tests/runs/faults.py

fuzz: .venv/tested
	PLASMAPYRO_FUZZ=$(COUNT) $(BIN)/pytest -q --numprocesses $(CORES) $(FUZZERS)

.venv/installed: environment.lock pyproject.toml
	@$(or $(PYTHON),false) $(SUITABLE) 2>/dev/null || { echo "make: no Python 3.11, 3.12, 3.13 or 3.14 found" \
	  "(tried: $(or $(PYTHON),$(PYTHONS))); install one with its venv module, or name it: make PYTHON=/path/to/python"; exit 1; }
	$(PYTHON) -m venv .venv
	$(PIP) --require-hashes --requirement environment.lock
	$(PIP) --no-deps --no-build-isolation --editable .
	touch $@

.venv/tested: .venv/installed environment-test.lock
	$(PIP) --require-hashes --requirement environment.lock --requirement environment-test.lock
	touch $@

simulations: .venv/installed
	$(SNAKEMAKE) results/analysis/gas_signal.nc $(foreach power,50 60 70 80 90 100 110 120 130,results/radiation_variations/$(power)kW.nc)
	$(BIN)/python workflow/ship.py

site: .venv/tested
	OMP_NUM_THREADS=1 $(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet docs build/site
	! grep -rlE '<(script|link|img)[^>]* (src|href)="(https?:)?//' build/site --include=*.html

campaign: figures
	$(BIN)/python workflow/campaign.py

light: .venv/installed
	workflow/light_check.sh $(BIN)/python $(PYTHONS)

lock:
	$(LOCK) --extra workflow --extra build --output-file environment.lock
	$(LOCK) --extra test --constraints environment.lock --output-file environment-test.lock \
	  $$(sed -n 's/^\([a-z0-9-]*\)==.*/--no-emit-package \1/p' environment.lock)

clean:
	rm -rf results
