#!/usr/bin/env bash
# Run every check: format, lints, documentation, tests. Ends non-zero when one of them failed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

failed=()

# Run one named check and go on whatever comes of it.
step() {
    local name=$1 start=$SECONDS result=passed
    shift
    echo "== $name"
    "$@" || { result=FAILED && failed+=("$name"); }
    echo "== $name: $result, $((SECONDS - start)) s"
}

bash tools/setup.sh
step format cargo fmt --check
step lints cargo clippy --release --locked --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" step documentation cargo doc --release --locked --no-deps --document-private-items
step tests cargo test --release --locked --no-fail-fast

if [ "${#failed[@]}" != 0 ]; then
    echo "FAILED: ${failed[*]}"
    exit 1
fi
echo "all passed, $SECONDS s"
