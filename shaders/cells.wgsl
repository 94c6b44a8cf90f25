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

/// One cell: share and placement factor (f32), first entry (24 bits) and index bits of its list, reach across and along
/// (16 bits each).
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

/// A ray among the cells. On a face, the cell is the one that it goes into.
struct Station {
    place: vec3f,
    cell: vec3f,
}

/// Jump over empty cells, from block to block. `speed` is the direction in edges per mm.
fn skip_empty(place: vec3f, speed: vec3f) -> vec3f {
    // A ray that stands still along an axis never comes to a face there.
    let safe = select(speed, vec3f(1e-12), abs(speed) < vec3f(1e-12));
    var station = jump(Station(place, cell_of(place)), safe);
    if JUMPS > 1u {
        station = jump(station, safe);
    }
    if JUMPS > 2u {
        station = jump(station, safe);
    }
    return station.place;
}

/// Jump over the block of empty cells around a ray, if there is one.
fn jump(old: Station, speed: vec3f) -> Station {
    let reach = cell_entry(old.cell).w;
    let across = f32(i32(reach & 0xffffu));
    let block = vec3f(across, across, f32(i32(reach >> 16u)));
    // Find the face of the block through which the ray leaves.
    let ahead = speed > vec3f(0.0);
    let face = select(old.cell + 1.0 - block, old.cell + block, ahead);
    let times = (face - old.place) / speed;
    let time = min(times.x, min(times.y, times.z));
    let leaving = times <= vec3f(time);
    let place = select(old.place + speed * time, face, leaving);
    // Beyond that face lies the next cell; count whole repeats in it, where they are exact.
    let cell = select(floor(place), select(face - 1.0, face, ahead), leaving);
    let repeats = vec3f(P.counts.xy * floor((cell.xy + 0.5) / P.counts.xy), 0.0);
    let next = vec3f(cell.xy - repeats.xy, clamp(cell.z, 0.0, P.counts.z - 1.0));
    let jumps = reach > 0u && old.place.z >= 0.0 && old.place.z <= P.counts.z;
    return Station(select(old.place, place - repeats, jumps), select(old.cell, next, jumps));
}
