// The periodic grid of cells, and jumps over empty ones. Places are in edges of a cell from x = 0, y = 0 and the back.
// uses: layout

/// The medium is not the same everywhere.
override CELLS: bool = false;
/// The table of cells is a texture, not a uniform buffer.
override CELLS_IN_TEXTURE: bool = false;

/// The index of a cell in the table.
fn cell_index(cell: vec3f) -> u32 {
    return u32(i32((cell.z * P.counts.y + cell.y) * P.counts.x + cell.x));
}

/// One cell: share (f32), placement factor (f32) or cut as `in_cut` says, first entry (24 bits) and index bits of its list, reach
/// across and along (16 bits each).
fn cell_entry(cell: vec3f) -> vec4u {
    let index = cell_index(cell);
    if CELLS_IN_TEXTURE {
        return textureLoad(cells_texture, vec2u(index & TEXTURE_MASK, index >> TEXTURE_BITS), 0);
    }
    return cells_uniform[index];
}

/// The cell of a place; never outside of the grid.
fn cell_of(place: vec3f) -> vec3f {
    return clamp(floor(place), vec3f(0.0), P.counts.xyz - 1.0);
}

/// Bring a place back into the repeat.
fn come_back(place: vec3f) -> vec3f {
    let repeat = P.counts.xy;
    let inside = max(place.xy - repeat * floor(place.xy / repeat), vec2f(0.0));
    return vec3f(select(inside, vec2f(0.0), inside >= repeat), place.z);
}

/// Jump over the block of empty cells around a place, if there is one, on to its face. `reach` is what the cell here says,
/// `speed` the direction in edges per mm.
fn skip_empty(place: vec3f, reach: u32, speed: vec3f) -> vec3f {
    let across = f32(i32(reach & 0xffffu));
    let block = vec3f(across, across, f32(i32(reach >> 16u)));
    // Find the face of the block through which the ray leaves; a ray that stands still along an axis never comes to one.
    let safe = select(speed, vec3f(1e-12), abs(speed) < vec3f(1e-12));
    let cell = cell_of(place);
    let face = select(cell + 1.0 - block, cell + block, safe > vec3f(0.0));
    let times = (face - place) / safe;
    let time = min(times.x, min(times.y, times.z));
    return select(place, select(place + safe * time, face, times <= vec3f(time)), reach > 0u);
}
