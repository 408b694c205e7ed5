# Each of these alone does all its own set-up, into .venv:
#   make run [FILE=motion.bvh]   open the studio; without a screen, its main job on a virtual one, into out/
#   make test                    lint, types, import contracts, all tests
#   make bench                   the speed bars, as ratios, into tests/benchmarks/RESULTS.md
#   make bench-codecs            size and error of every encoder over the corpus, into the same page (minutes)
#   make check-decoder          every clip of the corpus, whole, through the C decoder and Python's (minutes)
#   make fuzz-decoder [N=…]      N damaged files (1000000) into the C decoder; needs clang or gcc
#   make avatars                 the avatars that ship, anew, into avatars/ (minutes)
# PYTHON=… names the python3 (3.11 or newer) to build .venv with.

.PHONY: run test bench bench-codecs check-decoder fuzz-decoder avatars lint clean pins
.DEFAULT_GOAL := run

bin := .venv/bin

run:
	@.ci/setup run
	@.ci/launch $(if $(FILE),"$$FILE")

# xcb: on a Wayland desktop the tests' windows belong on the virtual screen too.
test: lint
	QT_QPA_PLATFORM=xcb $(bin)/python -m pytest -q -rs -n auto --maxprocesses 4 --dist loadfile

lint:
	@.ci/setup test
	$(bin)/ruff check
	$(bin)/ruff format --check
	$(bin)/mypy
	$(bin)/lint-imports

bench:
	@.ci/setup bench
	$(bin)/python tests/benchmarks/run.py

bench-codecs:
	@.ci/setup bench
	$(bin)/python tests/benchmarks/run.py --codecs

check-decoder:
	@.ci/setup test
	$(bin)/python tests/decoder/check_corpus.py

avatars:
	@.ci/setup avatars
	$(bin)/python -m avatars.make

fuzz-decoder:
	$(or $(PYTHON),python3) tests/decoder/fuzz.py --inputs $(or $(N),1000000)

clean:
	rm -rf .venv build dist out .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find qmd_studio tests -name __pycache__ -prune -exec rm -rf {} +

# Renews the pinned versions (needs uv); the files name neither hosts nor hashes.
compile := uv pip compile --universal --no-header --no-emit-index-url --no-annotate --python-version 3.11 --quiet --upgrade
pins:
	$(compile) pyproject.toml -o requirements.txt
	$(compile) --group dev -c requirements.txt -o requirements-dev.txt
	$(compile) --group bench -c requirements.txt -o requirements-bench.txt
	$(compile) --group avatars -c requirements.txt -o requirements-avatars.txt
