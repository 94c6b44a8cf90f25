#!/usr/bin/env bash
# Hold the shaders, and what naga makes of them, against other compilers. Each must also refuse what was spoilt.
#   tools/shaders.sh spirv      spirv-val on SPIR-V
#   tools/shaders.sh hlsl       the HLSL front of glslang on HLSL
#   tools/shaders.sh tint       Tint on the WGSL, and pipelines of it by Dawn on lavapipe (needs node and npm)
# Exit codes: 0 all is taken, 1 something is refused, 3 a compiler is missing and cannot be fetched.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tools/steps.sh

readonly FOLDER=$PWD/target/shaders DRIVERS=$PWD/target/drivers WEBGPU=webgpu@0.6.2
export FOLDER DRIVERS

refused() {
    echo "shaders: $*" >&2
    exit 1
}

# SPIR-V of one file.
spirv_val() {
    "$DRIVERS/spirv-tools/usr/bin/spirv-val" --target-env vulkan1.1 "$1" || { echo "$1 is refused" && return 1; }
}

# HLSL of one file, whose name has the entry point in its middle.
glslang() {
    local entry
    entry=$(basename "$1" | cut -d . -f 2)
    "$DRIVERS/glslang-tools/usr/bin/glslangValidator" -D -V -S comp -e "$entry" "$1" -o "$FOLDER/of-hlsl.$$.$RANDOM" ||
        { echo "$1 is refused" && return 1; }
}
export -f spirv_val glslang

# All files of an ending, and one that was spoilt.
check() {
    local command=$1 ending=$2 log=$FOLDER/$1.log
    find "$FOLDER" -name "*.$ending" -print0 | xargs -0 -P "$(nproc)" -I '{}' bash -c "$command {}" >"$log" 2>&1 ||
        { tail -n 20 "$log" >&2 && refused "$command refuses what naga writes; all it says is in $log"; }
    mv "$FOLDER/walk.walk.0.$ending" "$FOLDER/walk.walk.spoilt"
    if [ "$ending" = spv ]; then
        head -c -4 "$FOLDER/walk.walk.spoilt" >"$FOLDER/walk.walk.0.spv"
    else
        sed 's/float3/flaot3/' "$FOLDER/walk.walk.spoilt" >"$FOLDER/walk.walk.0.hlsl"
    fi
    ! "$command" "$FOLDER/walk.walk.0.$ending" >/dev/null 2>&1 || refused "$command takes a module that was spoilt"
    echo "$(find "$FOLDER" -name "*.$ending" | wc -l) modules are taken by $command, a spoilt one is not"
}

rm -rf "$FOLDER"
cargo run --quiet --release --locked --example shaders -- "$FOLDER"
case ${1:-} in
spirv)
    bash tools/drivers.sh spirv-tools
    check spirv_val spv
    ;;
hlsl)
    bash tools/drivers.sh glslang-tools
    check glslang hlsl
    ;;
tint)
    command -v node >/dev/null && command -v npm >/dev/null || { echo "shaders: node and npm are needed" >&2 && exit 3; }
    bash tools/drivers.sh lavapipe
    [ -e "$DRIVERS/tint/node_modules/webgpu" ] ||
        npm install --silent --no-audit --no-fund --prefix "$DRIVERS/tint" "$WEBGPU" || exit 3
    on_driver lavapipe node tools/tint.mjs "$DRIVERS/tint/node_modules/webgpu" "$FOLDER"
    ;;
*)
    echo "shaders: name spirv, hlsl or tint" >&2
    exit 2
    ;;
esac
