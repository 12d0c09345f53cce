# Two commands do all set-up on a machine with Python 3.11: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PACKAGE := $(VENV)/.package
STAMP := $(VENV)/.installed
WORKERS ?= 2

# Tests start many Python processes; each would compile all modules anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test slow-tests lint types wheel examples docs benchmarks clean

demo: $(PACKAGE)
	$(BIN)/artigen demo -o out/demo

# Workers of two threads each would wait for one another's.
TESTS = $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal --ignore tests/docs $(PYTEST_FLAGS)

# A quarter of the time goes into checking the shapes of all arrays; JAXTYPING_DISABLE=0 checks them, as the gate does.
test: export OMP_NUM_THREADS ?= 1
test: export JAXTYPING_DISABLE ?= 1
test: $(STAMP)
	$(TESTS) -m "not slow"

# Whole ways: data sets that are killed and go on, training runs, robots that open doors.
slow-tests: export OMP_NUM_THREADS ?= 1
slow-tests: $(STAMP)
	$(TESTS) -m slow

lint: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: $(STAMP)
	$(BIN)/pyright --pythonpath $(BIN)/python

wheel: $(STAMP)
	$(BIN)/python benchmarks/wheel_smoke.py

examples: $(STAMP)
	$(BIN)/python examples/run_all.py

# What the pages show runs from top to bottom.
docs: export OMP_NUM_THREADS ?= 1
docs: $(STAMP)
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal tests/docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

# torch's default wheel brings gigabytes of CUDA; constraints.txt pins a version with a CPU build. Python compiles what it imports
# when it does, which is a fraction of what pip would compile.
INSTALL = $(BIN)/python -m pip install -q --no-compile -c constraints.txt
$(PACKAGE): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --upgrade pip
	$(INSTALL) -e .
	touch $(PACKAGE)

$(STAMP): $(PACKAGE)
	$(INSTALL) -e '.[dev]'
	touch $(STAMP)

clean:
	rm -rf $(VENV) out dist build
