// Walks that set out from the first fiber that a straight ray meets.
// uses: layout, rng, medium, cylinder, memory

/// Walks first meet fibers of realizations, which the host has found.
override FIRST_HITS: bool = false;

/// A walk behind event 0.
struct Begun {
    /// m, and height as in a lane.
    ray: vec4f,
    /// x and y as in a lane.
    place: vec2f,
    /// 0 when the ray met nothing, else 1.
    hits: u32,
    base_exits: u32,
    /// Path length inside each kind of fiber, in mm.
    lengths: vec4f,
    memory: Memory,
}

/// Send a walk of a start along its ray and through the fiber there. Walks of a start take its rays by turns; `walk` is counted
/// from the first one of this segment.
fn first_hit(start: u32, walk: u32, id: vec2u) -> Begun {
    let ray = first_hits[start * P.first_hits.x + (P.first_hits.y + walk) % P.first_hits.x];
    let m = ray.ray.xyz;
    let p = ray.fiber.xyz;
    let hit = ray.fiber.w >= 0.0;
    let kind = select(0u, u32(ray.fiber.w), hit);
    let optics = kind_optics(kind);
    let across = cross(m, p);
    // A ray that meets nothing gets the number of plain reflection.
    let number = select(0.0, uniform_open(threefry(P.seed, vec4u(id, 0u, PURPOSE_EVENT)).z), hit);
    let passage = scatter(m, p, across, max(length(across), 1e-12), optics, ray.ray.w, number);
    var place = ray.place.xyz;
    var memory = no_memory();
    if PLACEMENT > 0u {
        let displacement = passage.displacement * optics.w;
        place += select(vec3f(0.0), displacement * P.per_edge.xyz, hit);
        if MEMORY {
            let slab = slab_of(start);
            let face = select(faces(slab).x - P.carry.w, faces(slab).y + P.carry.w, m.z < 0.0);
            let flown = max((ray.place.z / P.per_edge.z - face) / m.z, 0.0);
            let normal = surface_normal(m, p, across, ray.ray.w) * (optics.w / max(length(across), 1e-12));
            let passed = Passed(m, normal, p, kind, displacement);
            memory = hit_remembered(memory, passed, flown, passage.m, place.z / P.per_edge.z, slab);
        }
    }
    let inside = select(0.0, passage.path * optics.w, hit);
    let lengths = select(vec4f(0.0), vec4f(inside), vec4u(0u, 1u, 2u, 3u) == vec4u(kind));
    let hits = select(0u, 1u, hit);
    return Begun(vec4f(select(m, passage.m, hit), place.z), place.xy, hits, hits * passage.through_base, lengths, memory);
}
