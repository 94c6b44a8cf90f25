// Flights and fibers (paper section 4), by null collisions.
// uses: layout, rng, concentric, cells

/// The direction table is a texture, not a uniform buffer.
override TABLE_IN_TEXTURE: bool = false;
/// Directions are drawn inside the patch of a table entry; without it an entry is one direction.
override JITTER: bool = true;

/// An exponential deviate of mean 1.
fn exponential(word: u32) -> f32 {
    // The logarithm of a number just below 1 may come out above 0.
    return max(-log((f32(word) + 0.5) * 0x1p-32), 0.0);
}

/// Distance along the ray to the next tentative event, in mm.
fn free_path(word: u32) -> f32 {
    return exponential(word) * P.mean_free_path;
}

/// One entry of the direction table. Word w is its alias and threshold.
/// With jitter x, y are the patch's corner (f32), z its extents in units (12 bits each) and its kind (8 bits); without,
/// x, y, z are p (f32), and the two lowest bits of z are the kind.
fn table_entry(index: u32) -> vec4u {
    if TABLE_IN_TEXTURE {
        return textureLoad(table_texture, vec2u(index & TEXTURE_MASK, index >> TEXTURE_BITS), 0);
    }
    return table_uniform[index];
}

/// The entry that a word draws from the alias table of a list: its first entry (24 bits) and index bits. A medium without
/// cells has one list.
fn table_index(word: u32, list: u32) -> u32 {
    let first = select(0u, list & 0xffffffu, CELLS);
    let threshold_bits = select(P.threshold_bits, 32u - (list >> 24u), CELLS);
    let mask = (1u << threshold_bits) - 1u;
    let slot = word >> threshold_bits;
    let packed = table_entry(first + slot).w;
    return first + select(packed >> threshold_bits, slot, (word & mask) < (packed & mask));
}

/// The entry behind those of a list.
fn list_end(list: u32) -> u32 {
    return select(1u << (32u - P.threshold_bits), (list & 0xffffffu) + (1u << (list >> 24u)), CELLS);
}

/// A fiber: its direction and its kind.
struct Fiber {
    p: vec3f,
    kind: u32,
}

/// The direction p and the kind of the fiber at a tentative event in a cell with this list, drawn together with weight R f.
fn draw_fiber(words: vec4u, list: u32) -> Fiber {
    let entry = table_entry(table_index(words.y, list));
    if !JITTER {
        return Fiber(bitcast<vec3f>(entry.xyz), entry.z & 3u);
    }
    // Place the direction inside the patch.
    let extent = vec2f(f32(i32(entry.z & 0xfffu)), f32(i32((entry.z >> 12u) & 0xfffu))) * P.patch_unit;
    let square = bitcast<vec2f>(entry.xy) + extent * vec2f(uniform_fine(words.z), uniform_fine(words.w));
    // Lift it to the hemisphere: disc radius² = 1 − z.
    let azimuth = concentric_azimuth(square);
    let radius = azimuth.z;
    let p = vec3f(azimuth.xy * (radius * sqrt(2.0 - radius * radius)), (1.0 - radius) * (1.0 + radius));
    return Fiber(p, entry.z >> 24u);
}

/// Index, its reciprocal, its square less 1, and radius of a kind of fiber.
fn kind_optics(kind: u32) -> vec4f {
    if KINDS == 1u {
        return P.kinds[0];
    }
    let low = select(P.kinds[0], P.kinds[1], kind == 1u);
    let high = select(P.kinds[2], P.kinds[3], kind == 3u);
    return select(low, high, kind > 1u);
}
