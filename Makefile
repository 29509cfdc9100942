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
test: driver build components ## Formatting, lints, every shader permutation, all tests
	cargo fmt --all --check
	cargo clippy $(CARGO_FLAGS) --all-targets -- -D warnings
	@$(MAKE) --no-print-directory check
	cargo test $(CARGO_FLAGS)

# AIRLIGHT_REQUIRE lists the programs whose absence is a finding; in CI those that can be had.
.PHONY: check
check: build ## Every shader permutation through both compilers and all back ends
	@require="$${AIRLIGHT_REQUIRE-}"; \
	if [ -z "$$require" ] && [ "$${CI-}" = true ]; then \
	    require=spirv-val; \
	    if command -v tint >/dev/null; then require="$$require,tint"; fi; \
	fi; \
	set -x; $(VALIDATE) check wgsl $${require:+--require "$$require"}

.PHONY: validation-layer
validation-layer: driver rust ## Tests on the GPU under the Vulkan validation layer, which must say nothing
	./scripts/validation_layer.sh

.PHONY: bench
bench: driver build ## Ratios against baselines, interleaved in one run
	$(AIRLIGHT) bench

.PHONY: bless
bless: driver build ## Accept changed snapshots and write the manifest; then look at the diff
	$(VALIDATE) manifest wgsl
	INSTA_UPDATE=always AIRLIGHT_BLESS=1 cargo test $(CARGO_FLAGS)
	# insta notes the path of the source as this machine has it.
	sed -i.bak "1,6{/^source: /d;}" tests/tests/snapshots/*.snap && rm -f tests/tests/snapshots/*.bak

.PHONY: docs
docs: rust ## The book, in docs/book, and the API documentation, in target/doc
	@if command -v mdbook >/dev/null; then mdbook build docs; \
	else echo "docs: mdbook is not on the PATH, so the book is left out; install it with 'cargo install mdbook --locked'"; fi
	cargo doc --workspace --locked --no-deps $(FEATURES)

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
