#!/usr/bin/env bash
# Fetch Vulkan drivers beside the system's and tools that judge shaders, by the names of their Debian packages. Nothing is
# installed: all lies in target/drivers/, one folder each. A driver's folder has an icd.json, for VK_DRIVER_FILES and
# VK_ICD_FILENAMES, and a folder lib, for LD_LIBRARY_PATH.
#   tools/drivers.sh [swiftshader] [lavapipe] [spirv-tools] [glslang-tools]     without names: all of them
# Exit codes: 0 all is there, 3 something cannot be fetched here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly DRIVERS=$PWD/target/drivers
readonly APT=$DRIVERS/apt LOG=$DRIVERS/log

fail() {
    printf 'drivers: %s\n' "$@" >&2
    exit 3
}

# apt with folders of its own: the sources of the system and the backports of its release.
readonly OPTIONS=(-q -o "Dir::State::lists=$APT/lists" -o "Dir::Cache=$APT/cache" -o "Dir::Etc::sourcelist=/dev/null"
    -o "Dir::Etc::sourceparts=$APT/sources" -o "APT::Sandbox::User=$(id -un)")

# Take over the sources of the system, add the backports, and fetch the lists.
set_up_apt() {
    local release uri key component
    [ -z "$(find "$APT/ready" -mtime -1 2>/dev/null)" ] || return 0
    command -v apt-get >/dev/null && command -v dpkg >/dev/null ||
        fail "apt-get and dpkg were not found; these drivers come from packages of Debian"
    mkdir -p "$APT/lists/partial" "$APT/cache/archives/partial" "$APT/sources"
    release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    find /etc/apt/sources.list /etc/apt/sources.list.d -maxdepth 1 -type f \( -name '*.list' -o -name '*.sources' \) \
        -exec cp {} "$APT/sources" \; 2>/dev/null || true
    read -r uri component < <(apt-get indextargets --format '$(REPO_URI) $(COMPONENT) $(RELEASE)' 'Identifier: Packages' |
        sed -n "s/ $release\$//p" | grep ' main$') || fail "no source of apt has the release $release"
    key=$(grep -hs '^Signed-By: */' "$APT"/sources/*.sources | head -n 1 | cut -d ' ' -f 2) || true
    printf 'deb %s%s %s-backports %s\n' "${key:+[signed-by=$key] }" "$uri" "$release" "$component" \
        >"$APT/sources/of-backports.list"
    apt-get "${OPTIONS[@]}" update </dev/null >>"$LOG" 2>&1 || fail "apt-get update failed; its output is in $LOG"
    touch "$APT/ready"
}

# Unpack packages into a folder; each may name its suite after a slash.
unpack() {
    local folder=$1 package
    shift
    set_up_apt
    echo "drivers: fetching $* into ${folder#"$PWD/"}"
    rm -rf "$folder" "$APT/download"
    mkdir -p "$folder" "$APT/download"
    (cd "$APT/download" && apt-get "${OPTIONS[@]}" download "$@" </dev/null >>"$LOG" 2>&1) ||
        fail "apt-get could not download $*; its output is in $LOG"
    for package in "$APT"/download/*.deb; do
        dpkg -x "$package" "$folder"
    done
    rm -rf "$APT/download"
}

# Keep the library of a driver and those that it needs beside it, and say where it lies.
register() {
    local folder=$DRIVERS/$1 library=$2 lack name
    shift
    mkdir "$folder/lib"
    for name in "$@"; do
        find "$folder/usr" -name "$name" -exec cp -P {} "$folder/lib/" \;
    done
    rm -r "$folder/usr"
    lack=$(LD_LIBRARY_PATH=$folder/lib ldd "$folder/lib/$library" 2>&1 | grep -E 'not found|No such file') || true
    [ -z "$lack" ] || fail "$library cannot be loaded: $(echo $lack)"
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.1.0"}}\n' \
        "$folder/lib/$library" >"$folder/icd.json"
}

fetch() {
    local suite
    suite=$(. /etc/os-release 2>/dev/null && echo "${VERSION_CODENAME:-}-backports")
    case $1 in
    swiftshader)
        [ -e "$DRIVERS/swiftshader/icd.json" ] && return
        unpack "$DRIVERS/swiftshader" chromium-common
        register swiftshader libvk_swiftshader.so
        ;;
    lavapipe)
        [ -e "$DRIVERS/lavapipe/icd.json" ] && return
        unpack "$DRIVERS/lavapipe" "mesa-vulkan-drivers/$suite" "libdrm2/$suite" "libdrm-amdgpu1/$suite"
        register lavapipe libvulkan_lvp.so 'libdrm*.so*'
        ;;
    spirv-tools | glslang-tools)
        [ -e "$DRIVERS/$1/usr/bin" ] && return
        unpack "$DRIVERS/$1" "$1"
        ;;
    *) fail "there is no $1; there are swiftshader, lavapipe, spirv-tools and glslang-tools" ;;
    esac
}

mkdir -p "$DRIVERS"
[ "$#" != 0 ] || set -- swiftshader lavapipe spirv-tools glslang-tools
for name in "$@"; do
    fetch "$name"
done
