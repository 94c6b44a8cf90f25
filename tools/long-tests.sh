#!/usr/bin/env bash
# Run the checks that take long or fetch much; tools/test.sh has all others. Ends non-zero when one of them failed.
#   tools/long-tests.sh [NAME...]     only these; without names: all
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tools/steps.sh

readonly WANTED=" $* "

# Run a named check if it is wanted.
long() {
    if [ "$WANTED" = "  " ] || [[ $WANTED == *" $1 "* ]]; then
        step "$@"
    fi
}

# All tests of the kernel by walks and by functions, on one of the further drivers.
check_kernel() {
    bash tools/drivers.sh "$1" && on_driver "$1" cargo test --release --locked --test light -- lockstep:: primitives::
}

# Every command of the README and of docs as it stands.
check_documented() {
    FIBERWALK_DOCUMENTED=whole cargo test --release --locked --test program -- documented:: --nocapture
}

# The whole suite three times beside a busy loop on every core: no verdict may depend on load.
check_loaded() {
    local round loops=() result=0
    for ((round = 0; round < $(nproc); round++)); do
        while :; do :; done &
        loops+=($!)
    done
    for round in 1 2 3; do
        cargo test --release --locked --no-fail-fast || result=1
    done
    kill "${loops[@]}"
    return "$result"
}

bash tools/setup.sh
long swiftshader check_kernel swiftshader
long lavapipe check_kernel lavapipe
long hlsl bash tools/shaders.sh hlsl
long tint bash tools/shaders.sh tint
long documented check_documented
long survey cargo run --release --locked --example survey
long loaded check_loaded
finish
