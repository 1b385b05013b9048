# Every target sets up .venv if necessary; only Python 3.11 or newer and make are required.

VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
KERNELS := forests mappings mil rl trees volumes worlds/keepaway

.PHONY: run test check coverage bench docs release-check clean

run: $(STAMP)
	$(BIN)/relforest learn corridor --episodes 500 --iterations 5 --seed 0 --out runs/corridor

test: $(STAMP)
	$(BIN)/python -m pytest -n 2

check: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy src tests $(wildcard benchmarks)
	$(BIN)/lint-imports

# Coverage cannot see compiled code, so the packages that have kernels are tested once more as plain Python.
coverage: $(STAMP)
	PYTEST_ADDOPTS="--cov --cov-report= --cov-fail-under=0" $(MAKE) test
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest -n 2 --cov --cov-append --cov-report=term $(KERNELS:%=tests/%)

bench: $(STAMP)
	set -e; for file in benchmarks/bench_*.py; do echo "== $$file"; $(BIN)/python "$$file"; done

# The site in build/site; it runs the examples, and any broken link is an error.
docs: $(STAMP) $(VENV)/.docs-installed
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "open build/site/index.html"

$(VENV)/.docs-installed: $(STAMP) docs/site/requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement docs/site/requirements.lock
	@touch $@

# Builds what is published, and tries it in new environments; see docs/releasing.md.
release-check:
	.ci/release-check

clean:
	rm -rf $(VENV) build dist .coverage .coverage.* .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find src tests -type d -name __pycache__ -prune -exec rm -rf {} +

$(STAMP): pyproject.toml requirements.lock
	@set -e; python=; \
	for candidate in python3.11 python3.12 python3.13 python3; do \
	  if $$candidate -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then python=$$candidate; break; fi; \
	done; \
	if [ -z "$$python" ]; then echo "relforest needs Python 3.11 or newer, but none was found on PATH." >&2; exit 1; fi; \
	echo "setting up $(VENV) with $$python"; \
	$$python -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@
