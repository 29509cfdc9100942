# SPDX-License-Identifier: MIT OR Apache-2.0
# Everything is done in the profile `release` and built once. `make help` lists the targets.

SHELL := /bin/bash
.DEFAULT_GOAL := help
export PATH := $(PATH):$(HOME)/.cargo/bin

TARGET := $(or $(CARGO_TARGET_DIR),target)
AIRLIGHT := $(TARGET)/release/airlight
VALIDATE := $(TARGET)/release/airlight-validate
# Metal is a feature, since Vulkan is the default back end.
FEATURES := $(if $(filter Darwin,$(shell uname -s)),--features airlight/metal)
CARGO_FLAGS := --release --workspace --locked $(FEATURES)

.PHONY: help
help: ## This list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1	\2/p' Makefile | expand -t 18

.PHONY: driver
driver: ## Find a Vulkan driver, or install the software driver where there is none and it may
	@./scripts/driver.sh

.PHONY: build
build: rust ## Both commands, in target/release
	cargo build $(CARGO_FLAGS) --bins

.PHONY: gallery
gallery: driver build ## Every picture from real data, in gallery/
	$(AIRLIGHT) gallery --out gallery

.PHONY: test
test: driver components ## Formatting, lints, every shader permutation, all tests
	cargo fmt --all --check
	cargo clippy $(CARGO_FLAGS) --all-targets -- -D warnings
	# The commands together with the tests, whose dependencies have features of their own: so nothing is built twice.
	cargo build $(CARGO_FLAGS) --all-targets
	@$(MAKE) --no-print-directory check-built
	cargo test $(CARGO_FLAGS)

# AIRLIGHT_REQUIRE lists the programs whose absence is a finding; in CI those that can be had.
.PHONY: check
check: build check-built ## Every shader permutation through both compilers and all back ends

.PHONY: check-built
check-built:
	@require="$${AIRLIGHT_REQUIRE-}"; \
	if [ -z "$$require" ] && [ "$${CI-}" = true ]; then \
	    require=spirv-val; \
	    if command -v tint >/dev/null; then require="$$require,tint"; fi; \
	fi; \
	set -x; $(VALIDATE) check wgsl $${require:+--require "$$require"}

# Recorded with the tests of snapshots, one after another since they share a recorder, and repeated in a browser.
.PHONY: portability
portability: driver rust ## Every pass of the snapshots again, from its flat file, in headless Chromium
	@command -v node >/dev/null || { echo "portability: node is not on the PATH; install Node.js 20 or later" >&2; exit 1; }
	@test -x "$${CHROMIUM:-/usr/bin/chromium}" || { echo "portability: there is no Chromium; install it, or set CHROMIUM to its path" >&2; exit 1; }
	cd tests/browser && npm ci --silent --no-audit --no-fund
	cd tests/browser && node --test portability/portability.test.js
	rm -rf target/portability
	cargo test $(CARGO_FLAGS) --test snapshots --test snapshots_ambient --no-run
	for test in snapshots snapshots_ambient; do \
	    AIRLIGHT_CAPTURE="$(CURDIR)/target/portability/$$test" cargo test --quiet $(CARGO_FLAGS) --test $$test -- --test-threads=1 || exit 1; \
	done
	node tests/browser/portability/run.js

.PHONY: validation-layer
validation-layer: driver rust ## Tests on the GPU under the Vulkan validation layer, which must say nothing
	./scripts/validation_layer.sh

.PHONY: bench
bench: driver build ## Ratios against baselines, interleaved in one run
	$(AIRLIGHT) bench

.PHONY: generated
generated: build ## Lists, manifest, flat files and the book's pages, from the shaders
	$(VALIDATE) list wgsl
	$(VALIDATE) manifest wgsl
	$(VALIDATE) flatten wgsl
	$(VALIDATE) docs wgsl --out docs/src

.PHONY: bless
bless: driver build generated ## Accept changed snapshots and write what follows from the shaders; then look at the diff
	INSTA_UPDATE=always AIRLIGHT_BLESS=1 cargo test $(CARGO_FLAGS)
	# insta notes the path of the source as this machine has it.
	sed -i.bak "1,6{/^source: /d;}" tests/tests/snapshots/*.snap && rm -f tests/tests/snapshots/*.bak

.PHONY: release-abi
release-abi: build ## Hold later manifests to this one: when a version is published
	$(VALIDATE) manifest --release wgsl

.PHONY: npm
npm: ## The npm package, packed and installed: in node, for TypeScript, and in headless Chromium
	@command -v npm >/dev/null || { echo "npm is not on the PATH; install node 20 or later" >&2; exit 1; }
	cd tests/browser && npm ci --no-audit --no-fund && node --test --test-concurrency=1 package/

.PHONY: docs
docs: rust ## The book, in docs/book, and the API documentation, in target/doc
	@if command -v mdbook >/dev/null; then mdbook build docs; \
	else echo "docs: mdbook is not on the PATH, so the book is left out; install it with 'cargo install mdbook --locked'"; fi
	cargo doc --workspace --locked --no-deps $(FEATURES)

.PHONY: page-test
page-test: ## The page of examples/page in headless Chromium (needs npm and Chromium)
	@command -v npm >/dev/null || { echo "npm is missing; install Node.js 20 or later" >&2; exit 1; }
	npm ci --prefix tests/browser
	node --test tests/browser/page/

.PHONY: clean
clean: rust ## Remove what was built
	cargo clean
	rm -rf gallery docs/book

.PHONY: rust
rust:
	@command -v cargo >/dev/null || { echo "cargo is not on the PATH; install Rust from https://rustup.rs" >&2; exit 1; }

.PHONY: components
components: rust
	@cargo fmt --version >/dev/null 2>&1 || { echo "rustfmt is missing; install it with 'rustup component add rustfmt'" >&2; exit 1; }
	@cargo clippy --version >/dev/null 2>&1 || { echo "clippy is missing; install it with 'rustup component add clippy'" >&2; exit 1; }
