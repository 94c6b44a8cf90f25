// Flights that start where light leaves a fiber: a hit belongs to the cell that holds the fiber's axis.
// uses: layout, cells, march, memory

/// The number of a cell, brought back into the repeat; beyond the faces that of the nearest.
fn fold_cell(cell: vec3f) -> vec3f {
    let repeat = P.counts.xy;
    return vec3f(cell.xy - repeat * floor((cell.xy + 0.5) / repeat), clamp(cell.z, 0.0, P.counts.z - 1.0));
}

/// From a place to where the axis of a fiber that is hit there would be, on the average over offsets, in edges.
fn ahead(speed: vec3f) -> vec3f {
    return speed * (0.7853981634 * P.carry.w);
}

/// A ray that comes back to the cloth flies straight to where fibers can be hit.
fn enter(place: vec3f, speed: vec3f, low: f32, high: f32) -> vec3f {
    let face = select(low, high, place.z > high);
    let back = (place.z > high || place.z < low) && (face - place.z) * speed.z > 0.0;
    let time = (face - place.z) / select(1.0, speed.z, back);
    return select(place, vec3f(place.xy + speed.xy * time, face), back);
}

/// Jump to where the ray comes within a radius of the end of the block of empty cells about a place, if the place is farther
/// inside than that. `reach` is what the cell ahead says.
fn skip_clear(place: vec3f, reach: u32, speed: vec3f) -> vec3f {
    let across = f32(i32(reach & 0xffffu));
    let block = vec3f(across, across, f32(i32(reach >> 16u)));
    let here = floor(place + ahead(speed));
    let cell = vec3f(here.xy, clamp(here.z, 0.0, P.counts.z - 1.0));
    let first = cell + 1.0 - block;
    let last = cell + block;
    // Beyond the faces all is empty.
    let low = vec3f(first.xy + P.carry.xy, select(first.z + P.carry.z, -P.carry.z, first.z <= 0.0));
    let high = vec3f(last.xy - P.carry.xy, select(last.z - P.carry.z, P.counts.z + P.carry.z, last.z >= P.counts.z));
    let clear = reach > 0u && all(place >= low) && all(place <= high);
    let safe = select(speed, vec3f(1e-12), abs(speed) < vec3f(1e-12));
    let face = select(low, high, safe > vec3f(0.0));
    let times = (face - place) / safe;
    let time = min(times.x, min(times.y, times.z));
    return select(place, select(place + safe * time, face, times <= vec3f(time)), clear);
}

/// How far it is empty around the cell ahead of a place.
fn reach_ahead(place: vec3f, m: vec3f) -> u32 {
    return cell_entry(fold_cell(floor(place + ahead(m * P.per_edge.xyz)))).w;
}

/// Fly through one event on the surfaces of fibers; a sheet lies between the heights of `slab`.
fn fly_carried(ray: vec4f, across: vec2f, reach: u32, slab: vec2f, path: f32) -> Site {
    let m = ray.xyz;
    if CELLS {
        let speed = m * P.per_edge.xyz;
        let high = P.counts.z + P.carry.z;
        let start = vec3f(across, ray.w);
        let begin = enter(skip_clear(start, reach, speed), speed, -P.carry.z, high);
        let place = come_back(begin + speed * path);
        var flown = path;
        if MEMORY {
            flown += dot((begin - start) / P.per_edge.xyz, m);
        }
        let inside = place.z >= -P.carry.z && place.z <= high;
        let entry = cell_entry(fold_cell(floor(place + ahead(speed))));
        var factor = 1.0;
        if PLACEMENT == 2u {
            factor = bitcast<f32>(cell_entry(fold_cell(floor(place))).y);
        }
        return Site(place.z, place.xy, inside, inside, factor, entry.z, entry.w, 0.0, flown);
    }
    let low = slab.x - P.carry.z;
    let high = slab.y + P.carry.z;
    let begin = enter(vec3f(0.0, 0.0, ray.w), m, low, high);
    let z = begin.z + m.z * path;
    let inside = z <= high && z >= low;
    let flown = path + select(0.0, (begin.z - ray.w) / m.z, begin.z != ray.w);
    return Site(z, vec2f(0.0), inside, inside, 1.0, 0u, 0u, 0.0, flown);
}

/// Whether a point of a cell, from 0 to 1 along each axis, lies where its fibers are: three components of a normal of 6 bits and
/// an offset of 14 bits in 64ths.
fn in_cut(cut: u32, point: vec3f) -> bool {
    let words = bitcast<vec4i>(vec4u(cut << 26u, cut << 20u, cut << 14u, cut)) >> vec4u(26u, 26u, 26u, 18u);
    return dot(vec3f(words.xyz), point) * 64.0 <= f32(words.w);
}

/// From the axis of a fiber to where a ray hits it at an offset, in radii times |m × p|; `across` is m × p.
fn surface_normal(m: vec3f, p: vec3f, across: vec3f, offset: f32) -> vec3f {
    return sqrt((1.0 - offset) * (1.0 + offset)) * (dot(m, p) * p - m) + offset * across;
}

/// The share of the majorant's events that the cell of a fiber's axis takes; `normal` leads from the axis to the hit, in mm.
fn share_of_axis(place: vec3f, normal: vec3f, slab: vec2f) -> f32 {
    if CELLS {
        let axis = place - normal * P.per_edge.xyz;
        let cell = floor(axis);
        let entry = cell_entry(fold_cell(cell));
        let within = axis - vec3f(cell.xy, clamp(cell.z, 0.0, P.counts.z - 1.0));
        let filled = PLACEMENT == 2u || in_cut(entry.y, within);
        // Beyond the faces there is no fiber.
        return select(0.0, bitcast<f32>(entry.x), filled && axis.z >= 0.0 && axis.z <= P.counts.z);
    }
    let z = place.z - normal.z;
    return select(0.0, 1.0, z <= slab.y && z >= slab.x);
}
