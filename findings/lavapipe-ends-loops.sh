#!/usr/bin/env bash
# Mesa's lavapipe of Debian 12 ends the loops of a shader after 65,535 passes of all of them together, nested ones included, and
# goes on behind them: no error, no lost device, wrong numbers.
#
# Seen with mesa-vulkan-drivers 22.3.6-1+deb12u2 (LLVM 15) through wgpu 0.32.0 for Python. A compute shader of one invocation counts
# the passes of two nested loops whose bounds it reads from a buffer:
#     outer × inner    passes that WGSL asks for    passes that are made
#     1 × 65000        65000                        65000
#     1 × 70000        70000                        65535
#     70000 × 1        70000                        21845
#     30000 × 2        60000                        32768
# What stands behind the loops is executed each time. The lavapipe of the backports, 25.0.7, makes all passes. Ends with 0 if this is
# seen again, with 1 if it is not, with 3 if the packages are not to be had.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# Unpack the driver, the loader and what they need, but for the C library and its like.
chmod 755 .
apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks --no-replaces --no-enhances \
    mesa-vulkan-drivers libvulkan1 | grep -E '^[a-z0-9]' |
    grep -vE '^(libc6|libgcc-s1|gcc-.*-base|libstdc\+\+6|libcrypt1|debconf.*|dpkg|perl.*|tar|cdebconf|libc-bin)$' |
    sed 's/^mesa-vulkan-drivers$/&=22.3.6-1+deb12u2/' | sort -u >packages
xargs apt-get -q download -o APT::Sandbox::User="$(id -un)" <packages >apt.log 2>&1 || { tail -n 5 apt.log && exit 3; }
for package in *.deb; do dpkg -x "$package" root; done
libraries=$folder/root/usr/lib/$(uname -m)-linux-gnu:$folder/root/lib/$(uname -m)-linux-gnu
driver=$(find root -name libvulkan_lvp.so | head -n 1)
printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.3.0"}}' "$folder/$driver" >icd.json

python3 -m venv venv
venv/bin/pip -q install --only-binary :all: wgpu==0.32.0 numpy==2.4.6 || exit 3

cat >loops.py <<'PYTHON'
import numpy as np
import wgpu

SHADER = """
@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@compute @workgroup_size(1)
fn main() {
    let outer = words[0];
    let inner = words[1];
    var passes = 0u;
    var state = words[2];
    for (var i = 0u; i < outer; i++) {
        for (var j = 0u; j < inner; j++) {
            state = state * 747796405u + 2891336453u;
            passes++;
        }
    }
    words[3] = passes;
    words[4] = state;
    words[5] = 7u;
}
"""
adapter = wgpu.gpu.enumerate_adapters_sync()[0]
print(adapter.info["device"], adapter.info["description"])
device = adapter.request_device_sync()
pipeline = device.create_compute_pipeline(
    layout="auto", compute={"module": device.create_shader_module(code=SHADER), "entry_point": "main"}
)


def passes(outer, inner):
    usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    buffer = device.create_buffer_with_data(data=np.array([outer, inner, 1, 0, 0, 0], np.uint32), usage=usage)
    entries = [{"binding": 0, "resource": {"buffer": buffer}}]
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)
    encoder = device.create_command_encoder()
    work = encoder.begin_compute_pass()
    work.set_pipeline(pipeline)
    work.set_bind_group(0, group)
    work.dispatch_workgroups(1)
    work.end()
    device.queue.submit([encoder.finish()])
    words = np.frombuffer(device.queue.read_buffer(buffer), np.uint32)
    return int(words[3]), int(words[5])


found = {pair: passes(*pair) for pair in [(1, 65000), (1, 70000), (70000, 1), (30000, 2)]}
for (outer, inner), (made, behind) in found.items():
    print(f"{outer} x {inner}: {made} of {outer * inner} passes; behind the loops: {behind}")
expected = {(1, 65000): (65000, 7), (1, 70000): (65535, 7), (70000, 1): (21845, 7), (30000, 2): (32768, 7)}
raise SystemExit(0 if found == expected else 1)
PYTHON
XDG_RUNTIME_DIR=$folder VK_DRIVER_FILES=$folder/icd.json VK_ICD_FILENAMES=$folder/icd.json LD_LIBRARY_PATH=$libraries \
    venv/bin/python loops.py
