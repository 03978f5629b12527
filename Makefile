# One set of crates is built and tested everywhere: another selection would compile wgpu anew.
CARGO ?= cargo
TARGET_DIR = $${CARGO_TARGET_DIR:-target}

.PHONY: run test check build fuzz tour packages cargo

# The demo project: its window, or pictures in out/ and a table where there is no display.
run: build
	@.ci/show-demo "$(TARGET_DIR)/release/topout"

# Style, lints, and every test.
test: packages cargo check
	$(CARGO) build --release --workspace --all-targets --locked
	@if $(CARGO) nextest --version >/dev/null 2>&1; then \
		echo "$(CARGO) nextest run --release --workspace --locked"; \
		$(CARGO) nextest run --release --workspace --locked; \
	else \
		echo "$(CARGO) test --release --workspace --locked"; \
		$(CARGO) test --release --workspace --all-targets --locked; \
	fi

check: packages cargo
	$(CARGO) fmt --all --check
	$(CARGO) clippy --release --workspace --all-targets --locked -- -D warnings

# The schedule readers with damaged files, ten minutes each; MINUTES=1 make fuzz for less.
fuzz: packages cargo
	@.ci/fuzz

# A walk through the window without a display: pictures in out/tour.
tour: build
	@.ci/tour

build: packages cargo
	$(CARGO) build --release --workspace --locked

packages:
	@.ci/install-packages

cargo:
	@command -v $(CARGO) >/dev/null || { \
		echo "Rust is missing. Install it from https://rustup.rs, version 1.95 or newer:"; \
		echo "  curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh"; \
		exit 1; \
	} >&2
