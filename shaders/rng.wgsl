// Counter-based random numbers, and how their bits are used.
// uses: layout

/// Threefry4x32-13 with key (seed, 0, 0).
fn threefry(seed: vec2u, counter: vec4u) -> vec4u {
    let k0 = seed.x;
    let k1 = seed.y;
    let k4 = 0x1bd11bdau ^ k0 ^ k1;
    var x = counter + vec4u(k0, k1, 0u, 0u);
    x = threefry_even(x, 10u, 26u);
    x = threefry_odd(x, 11u, 21u);
    x = threefry_even(x, 13u, 27u);
    x = threefry_odd(x, 23u, 5u);
    x += vec4u(k1, 0u, 0u, k4 + 1u);
    x = threefry_even(x, 6u, 20u);
    x = threefry_odd(x, 17u, 11u);
    x = threefry_even(x, 25u, 10u);
    x = threefry_odd(x, 18u, 20u);
    x += vec4u(0u, 0u, k4, k0 + 2u);
    x = threefry_even(x, 10u, 26u);
    x = threefry_odd(x, 11u, 21u);
    x = threefry_even(x, 13u, 27u);
    x = threefry_odd(x, 23u, 5u);
    x += vec4u(0u, k4, k0, k1 + 3u);
    return threefry_even(x, 6u, 20u);
}

/// Mix neighbours.
fn threefry_even(x: vec4u, turn_first: u32, turn_second: u32) -> vec4u {
    let a = x.x + x.y;
    let c = x.z + x.w;
    return vec4u(a, rotate_left(x.y, turn_first) ^ a, c, rotate_left(x.w, turn_second) ^ c);
}

/// Mix across.
fn threefry_odd(x: vec4u, turn_first: u32, turn_second: u32) -> vec4u {
    let a = x.x + x.w;
    let c = x.z + x.y;
    return vec4u(a, rotate_left(x.y, turn_second) ^ c, c, rotate_left(x.w, turn_first) ^ a);
}

fn rotate_left(word: u32, bits: u32) -> u32 {
    return (word << bits) | (word >> (32u - bits));
}

/// (2k + 1)·2⁻²⁴ with k the 23 high bits: in the open unit interval, exact.
fn uniform_open(word: u32) -> f32 {
    return f32(i32(((word >> 8u) | 1u))) * 0x1p-24;
}

/// (2k + 1)·2⁻¹⁰ with k the 9 low bits.
fn uniform_fine(word: u32) -> f32 {
    return f32(i32(((word & 0x1ffu) << 1u) | 1u)) * 0x1p-10;
}
