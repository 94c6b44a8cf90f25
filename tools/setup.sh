#!/usr/bin/env bash
# See that everything the build and the tests need is there, and install what is missing where that is possible.
# Exit codes: 0 all is there, 3 something is missing and cannot be installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly VENV=target/venv LOG=target/setup.log
# Find ldconfig also where only root has it on the path.
PATH=$PATH:/usr/sbin:/sbin

fail() {
    printf 'setup: %s\n' "$@" >&2
    exit 3
}

# Hold the compiler's version against the one that Cargo.toml asks for.
check_rust() {
    local needed found
    needed=$(sed -n 's/^rust-version = "\(.*\)"$/\1/p' Cargo.toml)
    command -v cargo >/dev/null || fail "cargo was not found; Rust $needed or later is needed"
    found=$(rustc --version 2>/dev/null | cut -d ' ' -f 2) || true
    [ -n "$found" ] || fail "cargo was found, but no rustc that runs; Rust $needed or later is needed"
    [ "$(printf '%s\n' "$needed" "${found%%-*}" | sort -V | head -n 1)" = "$needed" ] ||
        fail "rustc $found was found; Rust $needed or later is needed"
}

# A driver is a JSON file in one of the loader's folders or where its two variables point.
has_vulkan_driver() {
    local paths path
    IFS=: read -r -a paths <<<"/usr/share/vulkan/icd.d:/etc/vulkan/icd.d:${VK_DRIVER_FILES:-}:${VK_ICD_FILENAMES:-}"
    for path in "${paths[@]}"; do
        [[ -f $path ]] && return
        [[ -n $path ]] && compgen -G "$path/*.json" >/dev/null && return
    done
    return 1
}

has_vulkan_loader() {
    # Read the whole list: a pipe that closes early would count as a failure.
    [[ $(ldconfig -p 2>/dev/null) == *libvulkan.so.1* ]]
}

# Install Debian packages; without the means, say which.
install_packages() {
    local run=()
    command -v apt-get >/dev/null || fail "missing: $* (names of Debian packages); install their like on this system"
    if [ "$(id -u)" != 0 ]; then
        sudo -n true 2>/dev/null || fail "missing: $*" "run: sudo apt-get install $*"
        run=(sudo -n)
    fi
    echo "setup: installing $*"
    # Go on after a failed update: the lists that are there may do.
    "${run[@]+"${run[@]}"}" apt-get -q update </dev/null >>"$LOG" 2>&1 || true
    "${run[@]+"${run[@]}"}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 \
        install --no-install-recommends "$@" </dev/null >>"$LOG" 2>&1 || {
        tail -n 20 "$LOG" >&2
        fail "apt-get could not install $*; its output is in $LOG"
    }
}

venv_works() {
    "$VENV/bin/python" -c 'import OpenEXR, numpy, mitsuba, pyradiance; OpenEXR.File' >/dev/null 2>&1
}

# Mitsuba compiles its llvm variants with the LLVM that it finds, and old ones fail at that.
llvm_works() {
    "$VENV/bin/python" -c '
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
mi.render(mi.load_dict(mi.cornell_box()), spp=1).numpy()' >/dev/null 2>&1
}

# Make the Python environment that reads what the program writes: OpenEXR files, curves, BSDFs.
make_venv() {
    local python=python3
    rm -rf "$VENV"
    if ! python3 -m venv "$VENV" >>"$LOG" 2>&1; then
        # Use the system's Python from here on: the one on the path may be another without venv.
        install_packages python3 python3-venv
        python=/usr/bin/python3
        rm -rf "$VENV"
        "$python" -m venv "$VENV" >>"$LOG" 2>&1 || fail "$python cannot make $VENV; its output is in $LOG"
    fi
    echo "setup: installing the wheels OpenEXR, numpy, mitsuba and pyradiance into $VENV"
    "$VENV/bin/python" -m pip install --quiet --only-binary :all: \
        'OpenEXR>=3.3,<4' numpy 'mitsuba>=3.7,<4' 'pyradiance>=1.2,<2' </dev/null >>"$LOG" 2>&1 || {
        tail -n 20 "$LOG" >&2
        fail "pip could not install OpenEXR, numpy, mitsuba and pyradiance; its output is in $LOG"
    }
    venv_works || fail "OpenEXR, numpy, mitsuba and pyradiance were installed into $VENV, but do not load"
}

check_rust
mkdir -p target

missing=()
# Other systems bring their own graphics interface.
if [ "$(uname -s)" = Linux ]; then
    has_vulkan_driver || missing+=(mesa-vulkan-drivers)
    has_vulkan_loader || missing+=(libvulkan1)
fi
command -v exrheader >/dev/null || missing+=(openexr)
[ "${#missing[@]}" = 0 ] || install_packages "${missing[@]}"
venv_works || make_venv
llvm_works || install_packages libllvm19
llvm_works || fail "Mitsuba's variant llvm_ad_rgb does not run: it needs a newer LLVM (19 does; the variable DRJIT_LIBLLVM_PATH names its file)"
