// The light of a walk by channel, in fixed point.
// uses: layout, rng

/// Fibers absorb.
override ABSORBING: bool = false;
/// Colour channels.
override CHANNELS: u32 = 1;

/// Add a walk's light to its exit bin, and what fibers kept of it to the absorbed light: q = ⌊w·2¹² + u⌋.
fn score(start: u32, bin: u32, id: vec2u, log_gain: f32, lengths: vec4f) {
    let exits = 2u * P.exit_cells;
    let ended = bin == exits + 2u;
    // Light that touched no fiber, and lost light, are counted as walks.
    if bin >= exits && !ended {
        return;
    }
    let u = uniform_open(threefry(P.seed, vec4u(id, 0u, PURPOSE_EXIT)).x);
    let moments = start * P.start_words + exits + OUTCOMES;
    for (var channel = 0u; channel < CHANNELS; channel++) {
        let weight = min(exp(log_gain - dot(absorption[channel], lengths)), 1.0) * f32(WEIGHT);
        // Compare fractions: the sum of a large weight and u would be rounded.
        let whole = floor(weight);
        let q = select(u32(whole) + select(0u, 1u, u >= 1.0 - (weight - whole)), 0u, ended);
        if !ended {
            add_moments(moments + 4u * (bin * CHANNELS + channel), q);
        }
        add_moments(moments + 4u * (exits * CHANNELS + channel), WEIGHT - q);
    }
}

/// Add q to Σq and q² to Σq², each a low and a high word.
fn add_moments(at: u32, q: u32) {
    add_pair(at, q);
    add_pair(at + 2u, q * q);
}

fn add_pair(at: u32, value: u32) {
    let low = atomicAdd(&bins[at], value);
    if low + value < low {
        atomicAdd(&bins[at + 1u], 1u);
    }
}
