// Whether the driver ends loops early: a loop that counts its passes.
// uses: nothing

/// Passes to make, passes made, and a number that depends on every pass.
@group(2) @binding(0) var<storage, read_write> loop_words: array<u32>;

@compute @workgroup_size(1)
fn loops() {
    let wanted = loop_words[0];
    var made = 0u;
    var number = 1u;
    while made != wanted {
        // Xorshift has no closed form that a compiler could put in place of the loop.
        number ^= number << 13u;
        number ^= number >> 17u;
        number ^= number << 5u;
        made += 1u;
    }
    loop_words[1] = made;
    loop_words[2] = number;
}
