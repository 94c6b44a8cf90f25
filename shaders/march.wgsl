// Flights by the table of H(m) (paper sections 3 and 4): exponential optical depth, marched from cell to cell.
// uses: layout, rng, medium, cells

/// Cells along an edge of the square of rays; 0 for flights by null collisions.
override VISIBLE_N: u32 = 0;

/// H(m) of a list relative to its greatest possible value: linear between the corners of a cell of the octahedral map of the
/// half-sphere. The four corners of a cell are one entry behind the directions of the list.
fn visible_area(list: u32, m: vec3f) -> f32 {
    let up = select(m, -m, m.z < 0.0);
    let scale = 0.5 / (abs(up.x) + abs(up.y) + up.z);
    let square = clamp(vec2f(up.x + up.y, up.x - up.y) * scale + 0.5, vec2f(0.0), vec2f(1.0));
    let place = square * f32(VISIBLE_N);
    let cell = min(floor(place), vec2f(f32(VISIBLE_N) - 1.0));
    let within = place - cell;
    let entry = list_end(list) + u32(i32(cell.y)) * VISIBLE_N + u32(i32(cell.x));
    let corners = bitcast<vec4f>(table_entry(entry));
    let rows = corners.xz + (corners.yw - corners.xz) * within.x;
    return rows.x + (rows.y - rows.x) * within.y;
}

/// Where an event has come to, and what is there.
struct Site {
    z: f32,
    place: vec2f,
    inside: bool,
    /// A fiber is to be drawn here.
    arrived: bool,
    /// The share of the majorant's events, and the list of fibers.
    share: f32,
    list: u32,
    reach: u32,
    /// Optical depth that is left; negative when the next flight sets out.
    depth: f32,
    /// Way flown in this event, in mm, where flights set out from where light leaves fibers.
    path: f32,
}

/// A block of cells around a ray, in edges of a cell.
struct Block {
    /// The place, brought into the repeat.
    place: vec3f,
    /// The face through which the ray leaves, and the time to it in mm.
    face: vec3f,
    time: f32,
    times: vec3f,
    share: f32,
    list: u32,
}

/// The cell that a ray goes through, on a face the one ahead; where it is empty, the block of empty cells around it.
fn block_ahead(place: vec3f, speed: vec3f) -> Block {
    let forwards = speed > vec3f(0.0);
    let here = select(ceil(place) - 1.0, floor(place), forwards | (speed == vec3f(0.0)));
    let repeat = P.counts.xy;
    // A quotient may be rounded across a whole number: then it is one repeat too far.
    let about = here.xy - repeat * floor(here.xy / repeat);
    let wrapped = about + select(vec2f(0.0), repeat, about < vec2f(0.0)) - select(vec2f(0.0), repeat, about >= repeat);
    let cell = vec3f(wrapped, clamp(here.z, 0.0, P.counts.z - 1.0));
    let inside = vec3f(place.xy + (wrapped - here.xy), place.z);
    let entry = cell_entry(cell);
    let across = max(f32(i32(entry.w & 0xffffu)), 1.0);
    let reach = vec3f(across, across, max(f32(i32(entry.w >> 16u)), 1.0));
    let block = select(cell + 1.0 - reach, cell + reach, forwards);
    // Beyond its faces there is no cloth.
    let face = vec3f(block.xy, clamp(block.z, 0.0, P.counts.z));
    // A ray that stands still along an axis never comes to a face of it.
    let still = abs(speed) < vec3f(1e-12);
    let times = select(max((face - inside) / select(speed, vec3f(1.0), still), vec3f(0.0)), vec3f(3e38), still);
    let time = min(times.x, min(times.y, times.z));
    return Block(inside, face, time, times, bitcast<f32>(entry.x), entry.z);
}

/// Go on with a flight: to its collision, or to the face of a block. `arrived` is set where fibers are being drawn; a sheet
/// lies between the heights of `slab`.
fn march(ray: vec4f, across: vec2f, arrived: bool, left: f32, slab: vec2f, word: u32) -> Site {
    let m = ray.xyz;
    let depth = select(left, exponential(word), left < 0.0);
    if CELLS {
        let speed = m * P.per_edge.xyz;
        let block = block_ahead(vec3f(across, ray.w), speed);
        // mean_free_path is that of the majorant.
        let rate = block.share * visible_area(block.list, m) / P.mean_free_path;
        // There is no collision in an empty cell, even where no depth is left.
        let free = select(3e38, depth / max(rate, 1e-30), block.share > 0.0);
        let hit = arrived || free < block.time;
        let on_face = select(block.place + speed * block.time, block.face, block.times <= vec3f(block.time));
        let flown = select(on_face, block.place + speed * free, free < block.time);
        let place = select(flown, block.place, arrived);
        // A place that is no number is outside.
        let inside = hit || select(place.z > 0.0, P.counts.z > place.z, m.z > 0.0);
        let rest = max(depth - rate * block.time, 0.0);
        return Site(place.z, place.xy, inside, hit, 1.0, block.list, 0u, select(rest, depth, hit), 0.0);
    }
    let rate = visible_area(0u, m) / P.mean_free_path;
    let still = abs(m.z) < 1e-12;
    let time = select((select(slab.x, slab.y, m.z > 0.0) - ray.w) / select(m.z, 1.0, still), 3e38, still);
    let free = depth / max(rate, 1e-30);
    let hit = arrived || free < time;
    let z = select(clamp(ray.w + m.z * free, slab.x, slab.y), ray.w, arrived);
    return Site(z, vec2f(0.0), hit, hit, 1.0, 0u, 0u, depth, 0.0);
}
