#!/usr/bin/env bash
# Run every check: format, lints, documentation, tests. Ends non-zero when one of them failed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tools/steps.sh

readonly VOILE=(measure voile --incident "[[30, 20]]" --exit 4 --walks 40000 --quiet --force)

# The kernel on a further driver: walk by walk, function by function, the self-test, and a preset by the program, whose light
# must not differ from that of the machine's own engine. Of these drivers none ends loops early. What tools/long-tests.sh has
# besides is left out: controls that the tests make on the system's driver, and more kernels of the same parts.
check_driver() {
    local driver=$1 adapter=$2 listing
    local -x XDG_CACHE_HOME=$PWD/target/tmp/cache
    on_driver "$driver" cargo test --quiet --release --locked --test light -- lockstep:: primitives:: \
        --skip noticed --skip bent --skip carried --skip tables_agree_in_cells || return
    listing=$(on_driver "$driver" target/release/fiberwalk engines) || { echo "$listing" && return 1; }
    grep "gpu 1 .*$adapter" <<<"$listing" || return
    ! grep -E 'does not load|ends the loops' <<<"$listing" || return
    on_driver "$driver" target/release/fiberwalk "${VOILE[@]}" --engine gpu --seed 2 -o "target/on-$driver" >/dev/null &&
        target/release/fiberwalk compare "target/on-$driver" target/on-own
}

# Both further drivers side by side: each compiles its kernels on one core.
check_drivers() {
    local other result=0
    bash tools/drivers.sh swiftshader lavapipe || return
    target/release/fiberwalk "${VOILE[@]}" -o target/on-own >/dev/null || return
    check_driver swiftshader SwiftShader >target/on-swiftshader.log 2>&1 &
    other=$!
    check_driver lavapipe 'Mesa .*bpo' || result=1
    wait "$other" || result=1
    cat target/on-swiftshader.log
    return "$result"
}

bash tools/setup.sh
step format cargo fmt --check
step lints cargo clippy --release --locked --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" step documentation cargo doc --release --locked --no-deps --document-private-items
step tests cargo test --release --locked --no-fail-fast --lib --bins --tests
if command -v apt-get >/dev/null; then
    step drivers check_drivers
    step SPIR-V bash tools/shaders.sh spirv
else
    echo "== left out: further drivers and spirv-val, which come from packages of Debian"
fi
finish
