# make demo    plan the shipped demo on a fresh environment and check the plan
# make test    the quick tests, on two processes, then the kernels' tests as plain Python with coverage; tests/README.md
# make test-all  every test: the quick, the slow, those in a browser, of the proxy and of models, and the soak of the service
# make test-browser  the reports of all shipped scenarios in a real Chromium (Debian: apt-get install chromium)
# make pictures  docs/pictures anew, from reports in that Chromium
# make test-gltf  animated models of all shipped scenarios, by the Khronos validator (npm fetches it)
# make test-proxy  the shipped proxy in front of two services, by a real HAProxy (Debian: apt-get install haproxy)
#              SMOKE=1 runs only the quick tests of the browser or of the proxy
# make kernels compile the inner loops once, for this processor; demo and test do it by themselves
# make check   ruff, mypy, import rules
# make serve   the HTTP service on 127.0.0.1:8000
# make problems  the three benchmark sets, and the independent recheck of every answer
# make bench   the whole benchmark, peers included: results, tables, plots, page; BESIDE=COMMIT compares with a commit
# make bench-quick  a sample of it, in under 3 minutes
# make soak    random answers for an hour, judged by other means; MINUTES=5 or PLANS=100, SEED=1, ONLY="shifts plans refusals"
# make prove-random  1,000 random plans before both checkers, which must agree; PLANS=100 for fewer, SEED=1 for others
# make check-deployment  the Kubernetes manifests and compose.yaml against the published schemas, and their numbers
# make lock    deploy/*.lock anew, with hashes; UPGRADE=1 takes the newest releases
# make sbom    what the image has installed, as CycloneDX: out/sbom.cdx.json
# make audit   known vulnerabilities of what is locked (it asks an advisory service)
# make image   the image, from the base in deploy/base-image, which make pin-base writes
# make soak-service  the service under harm, in two hours; SHORT=1 in 3 minutes, ONLY="ROW ..." for some rows
# make clean   remove what these made

VENV := .venv
BIN := $(VENV)/bin
OUT := out
SCENE ?= demo
HOST ?= 127.0.0.1
PORT ?= 8000
BUDGET ?= 1.0

# The first interpreter that is 3.11 or later; override with PYTHON=...
is_recent = $(1) -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1
PYTHON ?= $(firstword $(foreach name,python3 python3.13 python3.12 python3.11 python3.14 python,\
	$(shell $(call is_recent,$(name)) && echo $(name))))

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo kernels test test-all test-kernels test-browser test-gltf test-proxy pictures check format serve \
	problems bench bench-quick soak prove-random soak-service check-deployment lock sbom audit pin-base image clean

help:
	@sed -n '/^# make/s/^# //p' $(firstword $(MAKEFILE_LIST))

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "assur needs Python 3.11 or later, and none was found; say: make PYTHON=/path/to/python3 ..." >&2; exit 2; }
	@$(call is_recent,$(PYTHON)) || { echo "assur needs Python 3.11 or later; $(PYTHON) is not" >&2; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' >/dev/null 2>&1 || { echo "$(PYTHON) has no venv module (Debian: apt-get install python3-venv)" >&2; exit 2; }
	$(PYTHON) -m venv $(VENV)

# Tests of kernels that run as plain Python, too, where coverage can see their lines.
PLAIN := tests/planner/kernels tests/planner/timing/test_rough_motions.py tests/planner/timing/test_knots.py \
	tests/planner/test_gjk.py tests/planner/test_separation.py

# A stamp per set of extras: pip runs again only when one of these has changed since. It makes the links in src/assur, too.
INSTALLED_FROM := pyproject.toml deploy/packaging/backend.py
install = $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable "$(1)" && touch $@

# What users have: plots, and clients of the service.
OF_USERS := .[plot,client]

$(VENV)/installed: $(BIN)/python $(INSTALLED_FROM)
	$(call install,$(OF_USERS))

$(VENV)/installed-test: $(BIN)/python $(INSTALLED_FROM)
	$(call install,.[test])

$(VENV)/installed-dev: $(BIN)/python $(INSTALLED_FROM)
	$(call install,.[dev])

# Compiled once: the command looks whether they are there before it loads the compiler.
kernels: $(VENV)/installed
	$(BIN)/assur kernels

demo: kernels
	@mkdir -p $(OUT)
	$(BIN)/assur plan scenes/cells/$(SCENE).yaml --out $(OUT)/$(SCENE).json
	$(BIN)/assur check $(OUT)/$(SCENE).json
	$(BIN)/assur report $(OUT)/$(SCENE).json --out $(OUT)/$(SCENE).html

QUICK := -m "not slow"

test: $(VENV)/installed-test
	$(BIN)/assur kernels
	$(BIN)/python -m pytest -n 2 --dist worksteal $(QUICK)
	$(MAKE) --no-print-directory test-kernels

test-all: $(VENV)/installed-test
	$(BIN)/assur kernels
	$(BIN)/python -m pytest -n 2 --dist worksteal
	$(MAKE) --no-print-directory test-kernels test-gltf test-browser test-proxy
	$(MAKE) --no-print-directory soak-service SHORT=1

# Once more as plain Python, where coverage sees their lines.
test-kernels: $(VENV)/installed-test
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest -n 2 $(PLAIN) --cov=planner/kernels --cov-report=term

# The browser that runs the reports; none is downloaded.
CHROMIUM ?= $(firstword $(foreach name,chromium chromium-browser google-chrome,$(shell command -v $(name) 2>/dev/null)))

$(VENV)/installed-browser: $(BIN)/python $(INSTALLED_FROM)
	$(call install,.[browser])

test-browser: $(VENV)/installed-browser
	@test -n "$(CHROMIUM)" || { echo "there is no Chromium (Debian: apt-get install chromium); or say: make test-browser CHROMIUM=/path/to/it" >&2; exit 2; }
	$(BIN)/assur kernels
	CHROMIUM="$(CHROMIUM)" $(BIN)/python -m pytest -n 2 --dist worksteal $(if $(SMOKE),$(QUICK)) tests/browser

pictures: $(VENV)/installed-browser
	CHROMIUM="$(CHROMIUM)" $(BIN)/python -m tests.browser.pictures

# The Khronos validator of glTF, which is a package of npm.
NPM ?= $(shell command -v node >/dev/null 2>&1 && command -v npm 2>/dev/null)
GLTF_VALIDATOR := $(VENV)/gltf-validator

$(GLTF_VALIDATOR)/installed: Makefile
	@test -n "$(NPM)" || { echo "there is no node with npm (Debian: apt-get install npm)" >&2; exit 2; }
	@mkdir -p $(GLTF_VALIDATOR)
	$(NPM) install --silent --no-audit --no-fund --prefix $(GLTF_VALIDATOR) gltf-validator@2.0.0-dev.3.10 && touch $@

test-gltf: $(VENV)/installed-test $(GLTF_VALIDATOR)/installed
	$(BIN)/assur kernels
	GLTF_VALIDATOR="$(GLTF_VALIDATOR)" $(BIN)/python -m pytest -n 2 --dist worksteal tests/gltf

# The proxy that compose.yaml puts in front of the service. Debian has it where not every path leads.
HAPROXY ?= $(firstword $(shell command -v haproxy 2>/dev/null) $(wildcard /usr/sbin/haproxy))

test-proxy: $(VENV)/installed-test
	@test -n "$(HAPROXY)" || { echo "there is no HAProxy (Debian: apt-get install haproxy); or say: make test-proxy HAPROXY=/path/to/it" >&2; exit 2; }
	$(BIN)/assur kernels
	HAPROXY="$(HAPROXY)" $(BIN)/python -m pytest $(if $(SMOKE),$(QUICK)) tests/proxy

check: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(VENV)/installed-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

serve: $(VENV)/installed
	$(BIN)/assur serve --host $(HOST) --port $(PORT)

# The moving goals once met in position and once with their velocity.
RUNS := static:position moving_bodies:position moving_goal:position moving_goal:velocity

problems: $(VENV)/installed-test
	@mkdir -p $(OUT)
	@set -e; for run in $(RUNS); do \
		set_="$${run%%:*}"; match="$${run##*:}"; answers="$(OUT)/$$set_-$$match.jsonl"; \
		$(BIN)/python -m benchmarks.run_problems "benchmarks/problems/$$set_.json" \
			--budget-s $(BUDGET) --stop first --match "$$match" --out "$$answers"; \
		$(BIN)/python -m benchmarks.recheck "benchmarks/problems/$$set_.json" "$$answers" --match "$$match"; \
	done

# The scripts of the benchmark, each in a process of its own.
SCRIPTS := first_answer durations demo_cycle session session_cycle kept_cell scaling legs service side_by_side
each_script = for script in $(SCRIPTS); do \
		beside=; if [ $$script = first_answer ]; then beside="$(if $(BESIDE),--beside $(BESIDE))"; fi; \
		$(BIN)/python -m benchmarks.$$script $$beside $(1) || status=1; done

# What was measured stands in the page even where an answer was not clean: as refused.
bench: $(VENV)/installed-test
	@status=0; $(call each_script,); rm -f benchmarks/results/profile.jsonl; \
		for run in $(RUNS); do for commit in "" $(if $(BESIDE),--commit=$(BESIDE)); do \
			$(BIN)/python -m benchmarks.profile "$${run%%:*}" --match "$${run##*:}" $$commit \
				--out benchmarks/results/profile.jsonl || status=1; done; done; \
		$(BIN)/python -m benchmarks.report; exit $$status

bench-quick: $(VENV)/installed-test
	@status=0; $(call each_script,--quick); exit $$status

# For a time, or until each campaign has looked at so many answers.
MINUTES ?= 60
PLANS ?=
SEED ?= 0

soak: $(VENV)/installed-test
	$(BIN)/assur kernels
	$(BIN)/python -m benchmarks.judge $(if $(PLANS),--count $(PLANS),--minutes $(MINUTES)) --seed $(SEED) \
		$(foreach campaign,$(ONLY),--only $(campaign)) --out $(OUT)/soak

check-deployment: $(VENV)/installed-test
	$(BIN)/python -m deploy.check

$(VENV)/installed-supply: $(BIN)/python $(INSTALLED_FROM)
	$(call install,.[supply])

# Cython is left out, and why stands in deploy/locks.py. What is locked already stays, unless UPGRADE is set.
UPGRADE ?=
compile_lock = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	--no-emit-find-links --custom-compile-command "make lock" $(if $(UPGRADE),--upgrade) -o deploy/$(1) $(2)

lock: $(VENV)/installed-supply
	$(call compile_lock,requirements.lock,--no-emit-package cython pyproject.toml)
	$(BIN)/python -m deploy.locks | $(call compile_lock,requirements-build.lock,-)

# An environment with nothing but what is locked, as the image has it.
LOCKED := $(OUT)/locked

$(LOCKED)/installed: deploy/requirements.lock
	@rm -rf $(LOCKED) && mkdir -p $(OUT)
	$(PYTHON) -m venv --without-pip $(LOCKED)
	$(BIN)/python -m pip --python $(LOCKED)/bin/python install --quiet --require-hashes --no-deps -r deploy/requirements.lock
	touch $@

sbom: $(VENV)/installed-supply $(LOCKED)/installed
	$(BIN)/python -m deploy.sbom $(LOCKED)/bin/python $(OUT)/sbom.cdx.json

audit: $(VENV)/installed-supply
	$(BIN)/python -m deploy.audit

# The base image by its digest. Who builds the image asks the registry for it, and keeps the file that this writes.
TAG := $(firstword $(shell sed -n 's/^FROM \([^ ]*\) AS build$$/\1/p' Dockerfile))
BASE ?= $(shell cat deploy/base-image 2>/dev/null)
COMMIT = $(shell git rev-parse HEAD 2>/dev/null)
VERSION = $(shell sed -n 's/^version = "\(.*\)"$$/\1/p' pyproject.toml)

pin-base:
	@digest="$$(docker buildx imagetools inspect $(TAG) --format '{{.Manifest.Digest}}')" && \
		case "$$digest" in sha256:*) echo "$(TAG)@$$digest" | tee deploy/base-image;; *) echo "no digest of $(TAG): $$digest" >&2; exit 2;; esac

image:
	@case "$(BASE)" in *@sha256:*) ;; *) echo "which base image? make pin-base writes the digest of $(TAG) into deploy/base-image; or say: make image BASE=$(TAG)@sha256:..." >&2; exit 2;; esac
	docker build --build-context "$(TAG)=docker-image://$(BASE)" --build-arg VERSION="$(VERSION)" --build-arg COMMIT="$(COMMIT)" \
		--label org.opencontainers.image.base.name="$(BASE)" --tag assur:$(VERSION) .
prove-random: $(VENV)/installed-test
	$(BIN)/assur kernels
	$(BIN)/python -m benchmarks.judge --only proofs --count $(or $(PLANS),1000) --seed $(SEED) --out $(OUT)/proofs

# Through HAProxy, where there is one (Debian: apt-get install haproxy).
soak-service: $(VENV)/installed-test
	$(BIN)/assur kernels
	$(BIN)/python -m benchmarks.soak_service $(if $(SHORT),--short) $(foreach row,$(ONLY),--only $(row)) \
		--seed $(SEED) --out $(OUT)/soak-service/results.json

clean:
	rm -rf $(VENV) .venv-peers $(OUT) build .coverage .coverage.* htmlcov .hypothesis .mypy_cache .pytest_cache .ruff_cache .import_linter_cache *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
