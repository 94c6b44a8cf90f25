// Where walks start and where they are counted.
// uses: layout, rng, concentric, cells

/// What light comes from: 0 cells of the concentric map, 1 a list of directions, 2 cells of rings.
override INCIDENCE: u32 = 0;
/// Exits are counted in rings, not in cells of the concentric map.
override EXIT_RINGS: u32 = 0;

/// Exit rings: sin² θ of the outer edge, first cell, cells, share of a cell before φ = 0. Rings that are none lie beyond the horizon.
@group(0) @binding(12) var<uniform> rings: array<vec4f, MOST_RINGS>;

/// The direction m = −wi in which a walk of a start sets out.
fn start_direction(start: u32, words: vec4u) -> vec3f {
    let entry = bitcast<vec4f>(incident[start]);
    if INCIDENCE == 1u {
        return -entry.xyz;
    }
    if INCIDENCE == 2u {
        // From an eighth of a turn and sin² θ on, so far along both.
        let square = entry.y + entry.w * uniform_open(words.y);
        let side = select(-1.0, 1.0, start < P.front_starts);
        let azimuth = eighths_of_turn(entry.x + entry.z * uniform_open(words.x));
        return -vec3f(azimuth * sqrt(square), side * sqrt(max(0.0, 1.0 - square)));
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

/// The unit vector so many eighths of a turn from +x, −8 to 16.
fn eighths_of_turn(eighths: f32) -> vec2f {
    // Turn by the rest of at most one eighth, then by quarters.
    let quarters = round(0.5 * eighths);
    let rest = cos_sin_quarter(eighths - 2.0 * quarters);
    let turn = (i32(quarters) + 4) & 3;
    let turned = select(rest, vec2f(-rest.y, rest.x), (turn & 1) == 1);
    return select(turned, -turned, turn > 1);
}

/// The ring that holds a sin² θ, if it is one of the `2·step` from `low` on.
fn ring_from(low: u32, step: u32, square: f32) -> u32 {
    return select(low, low + step, square >= rings[low + step - 1u].x);
}

/// The cell among rings of a projection (x, y).
fn ring_cell(projection: vec2f) -> u32 {
    let square = dot(projection, projection);
    // Halve 128 rings seven times: a loop would count against the budget of loops.
    let half = ring_from(ring_from(ring_from(0u, 64u, square), 32u, square), 16u, square);
    let low = ring_from(ring_from(ring_from(ring_from(half, 8u, square), 4u, square), 2u, square), 1u, square);
    let ring = rings[min(low, P.exit_n - 1u)];
    let swap = abs(projection.y) > abs(projection.x);
    let larger = select(projection.x, projection.y, swap);
    let smaller = select(projection.y, projection.x, swap);
    let angle = atan_quarter(smaller / select(larger, 1.0, larger == 0.0));
    let eighths = select(angle, 2.0 - angle, swap) + select(0.0, 4.0, larger < 0.0);
    // Add a turn: φ begins below 0.
    let sector = u32(ring.z * (0.125 * eighths + 1.0) + ring.w);
    return u32(ring.y) + sector % max(u32(ring.z), 1u);
}

/// The cell of the concentric map of a projection (x, y).
fn disc_cell(projection: vec2f) -> u32 {
    let square = disc_to_square(projection);
    let place = (square + 1.0) * (0.5 * f32(P.exit_n));
    let last = P.exit_n - 1u;
    return min(u32(place.y), last) * P.exit_n + min(u32(place.x), last);
}

/// The bin of a walk that left along m: reflection cells, transmission cells, direct, lost, ended by roulette.
fn exit_bin(start: u32, m: vec3f, hits: u32) -> u32 {
    var cell = 0u;
    if EXIT_RINGS == 1u {
        cell = ring_cell(m.xy);
    } else {
        cell = disc_cell(m.xy);
    }
    let scattered = select(P.exit_cells + cell, cell, (m.z > 0.0) == (start < P.front_starts));
    let bin = select(scattered, 2u * P.exit_cells, hits == 0u);
    // Test the bits: a compiler may take it that no number is NaN. 0x3f7d70a4 is 0.99, 0x3f8147ae is 1.01; roulette leaves
    // a vector of length 2, whose square is 0x40800000.
    let norm = bitcast<u32>(dot(m, m));
    let other = select(2u * P.exit_cells + 1u, 2u * P.exit_cells + 2u, norm == 0x40800000u);
    return select(other, bin, norm > 0x3f7d70a4u && norm < 0x3f8147aeu);
}
