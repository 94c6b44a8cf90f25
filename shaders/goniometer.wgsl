// Where walks start and where they are counted.
// uses: layout, rng, concentric, cells

/// Incident directions are a list, not cells.
override LISTED: bool = false;

/// The direction m = −wi in which a walk of a start sets out.
fn start_direction(start: u32, words: vec4u) -> vec3f {
    let entry = bitcast<vec4f>(incident[start]);
    if LISTED {
        return -entry.xyz;
    }
    // Draw a place inside the cell; disc radius = sin θ, and z of the entry is the lit side.
    let place = vec2f(uniform_open(words.x), uniform_open(words.y));
    let azimuth = concentric_azimuth(entry.xy + P.incident_edge * place);
    let radius = azimuth.z;
    return -vec3f(azimuth.xy * radius, entry.z * sqrt((1.0 - radius) * (1.0 + radius)));
}

/// Heights of the back and the front of a sheet above the face that is lit, in mm: near that face f32 is finest.
fn slab_of(start: u32) -> vec2f {
    return select(vec2f(0.0, P.thickness), vec2f(-P.thickness, 0.0), start < P.front_starts);
}

/// The height at which a walk of a start sets out, in mm above the lit face; among cells, above the back in edges.
fn start_depth(start: u32) -> f32 {
    let front = start < P.front_starts;
    let face = select(0.0, P.counts.z, front && CELLS);
    // A hit lies up to a radius beyond the faces when it belongs to its fiber's axis.
    return select(face, select(face - P.carry.z, face + P.carry.z, front), PLACEMENT > 0u);
}

/// Where in the repeat a walk sets out, in edges of a cell.
fn start_place(words: vec4u) -> vec2f {
    return P.counts.xy * vec2f(uniform_open(words.z), uniform_open(words.w));
}

/// The bin of a walk that left along m: reflection cells, transmission cells, direct, lost, ended by roulette.
fn exit_bin(start: u32, m: vec3f, hits: u32) -> u32 {
    let square = disc_to_square(m.xy);
    let place = (square + 1.0) * (0.5 * f32(P.exit_n));
    let last = P.exit_n - 1u;
    let cell = min(u32(place.y), last) * P.exit_n + min(u32(place.x), last);
    let scattered = select(P.exit_cells + cell, cell, (m.z > 0.0) == (start < P.front_starts));
    let bin = select(scattered, 2u * P.exit_cells, hits == 0u);
    // Test the bits: a compiler may take it that no number is NaN. 0x3f7d70a4 is 0.99, 0x3f8147ae is 1.01; roulette leaves
    // a vector of length 2, whose square is 0x40800000.
    let norm = bitcast<u32>(dot(m, m));
    let other = select(2u * P.exit_cells + 1u, 2u * P.exit_cells + 2u, norm == 0x40800000u);
    return select(other, bin, norm > 0x3f7d70a4u && norm < 0x3f8147aeu);
}
