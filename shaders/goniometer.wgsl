// Where walks start and where they are counted.
// uses: layout, rng, concentric

/// Incident directions are a list, not cells.
override LISTED: bool = false;

/// The direction m = −wi in which a walk of an incident cell sets out.
fn start_direction(cell: u32, words: vec4u) -> vec3f {
    let entry = bitcast<vec4f>(incident[cell]);
    if LISTED {
        return -entry.xyz;
    }
    // Draw a place inside the cell; disc radius = sin θ.
    let place = vec2f(uniform_open(words.x), uniform_open(words.y));
    let azimuth = concentric_azimuth(entry.xy + P.incident_edge * place);
    let radius = azimuth.z;
    return -vec3f(azimuth.xy * radius, sqrt((1.0 - radius) * (1.0 + radius)));
}

/// The bin of a walk that left along m: reflection cells, transmission cells, direct, lost.
fn exit_bin(m: vec3f, hits: u32) -> u32 {
    let square = disc_to_square(m.xy);
    let place = (square + 1.0) * (0.5 * f32(P.exit_n));
    let last = P.exit_n - 1u;
    let cell = min(u32(place.y), last) * P.exit_n + min(u32(place.x), last);
    let scattered = select(P.exit_cells + cell, cell, m.z > 0.0);
    let bin = select(scattered, 2u * P.exit_cells, hits == 0u);
    // Test the bits: a compiler may take it that no number is NaN. 0x3f7d70a4 is 0.99, 0x3f8147ae is 1.01.
    let norm = bitcast<u32>(dot(m, m));
    return select(2u * P.exit_cells + 1u, bin, norm > 0x3f7d70a4u && norm < 0x3f8147aeu);
}
