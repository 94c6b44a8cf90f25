// What a walk remembers: its last flight met nothing on its way, and the fiber where that flight set out is still there.
// uses: layout, cells, medium

/// Walks remember their last flight and the fiber that it set out from.
override MEMORY: bool = false;

/// Places in mm, seen from where the present flight set out.
struct Memory {
    /// From where to where the last flight went; far away before the first hit. w: way flown since the last fiber was left;
    /// way to the known fiber, beyond all flights for none.
    flight_from: vec4f,
    flight_to: vec4f,
    /// A point of the axis of the fiber that was left last; w: offset α at which the present flight meets the known fiber.
    left_axis: vec4f,
    /// p of the fiber that was left last, and its kind, negative for none; the same of the known fiber, which was left before.
    left_fiber: vec4f,
    known_fiber: vec4f,
}

/// Of a walk that sets out.
fn no_memory() -> Memory {
    let far = vec4f(3e8, 3e8, 3e8, 0.0);
    let none = vec4f(1.0, 0.0, 0.0, -1.0);
    return Memory(far, vec4f(far.xyz, NEVER), vec4f(0.0), none, none);
}

/// A way that is longer than all flights.
const NEVER: f32 = 3e38;

fn remembered(lane: ptr<function, Lane>) -> Memory {
    return Memory((*lane).flight_from, (*lane).flight_to, (*lane).left_axis, (*lane).left_fiber, (*lane).known_fiber);
}

/// Half the length of a fiber that may be taken for straight, in radii.
fn straight() -> f32 {
    return min(STRAIGHT, P.half_length);
}

/// Whether a fiber that a ray touches, `flown` mm from where the flight set out, cannot be: the last flight would have met it.
/// `normal` leads from its axis to the hit, in mm.
fn rules_out(memory: Memory, m: vec3f, flown: f32, normal: vec3f, p: vec3f, radius: f32) -> bool {
    let axis = m * flown - normal;
    let begin = memory.flight_from.xyz - axis;
    let way = memory.flight_to.xyz - memory.flight_from.xyz;
    // Keep to where the fiber may be taken for straight.
    let along = vec2f(dot(p, begin), dot(p, way));
    let safe = select(along.y, 1e-12, abs(along.y) < 1e-12);
    let ends = (vec2f(-straight(), straight()) * radius - along.x) / safe;
    let low = max(min(ends.x, ends.y), 0.0);
    let high = min(max(ends.x, ends.y), 1.0);
    let start = begin - p * along.x;
    let across = way - p * along.y;
    let nearest = start + across * clamp(-dot(start, across) / max(dot(across, across), 1e-30), low, high);
    // Fibers that held the start of the flight were not met.
    let square = radius * radius;
    return low <= high && dot(start, start) >= square && dot(nearest, nearest) < square;
}

/// A fiber that light has gone through, in mm: from its axis to the hit, and from there to where it was left.
struct Passed {
    m: vec3f,
    normal: vec3f,
    p: vec3f,
    kind: u32,
    displacement: vec3f,
}

/// Heights of the faces in mm, as a lane's height is told; `slab` are those of a sheet.
fn faces(slab: vec2f) -> vec2f {
    return select(slab, vec2f(0.0, P.thickness), CELLS);
}

/// What is remembered after a hit, `flown` mm from where the flight set out. The light goes on along `out`, from the height `z`
/// in mm.
fn hit_remembered(memory: Memory, passed: Passed, flown: f32, out: vec3f, z: f32, slab: vec2f) -> Memory {
    let back = -passed.displacement;
    let shift = back - passed.m * flown;
    // Meet the fiber that was left before.
    let before = memory.left_fiber;
    let axis = memory.left_axis.xyz + shift;
    let p = before.xyz;
    let radius = kind_optics(u32(max(before.w, 0.0))).w;
    let across = cross(out, p);
    let visible = max(length(across), 1e-12);
    let offset = -dot(axis, across) / (visible * radius);
    let facing = (p * dot(out, p) - out) / visible;
    let rim = sqrt(max((1.0 - offset) * (1.0 + offset), 0.0)) * radius;
    let distance = -(dot(facing, axis) + rim) / visible;
    let height = z + out.z * distance - (rim * facing.z + offset * radius / visible * across.z);
    let low_high = faces(slab);
    let near = abs(dot(p, out * distance - axis)) <= straight() * radius;
    let meets = before.w >= 0.0 && abs(offset) < 1.0 && distance > 0.0 && near && height >= low_high.x && height <= low_high.y;
    return Memory(
        vec4f(shift, 0.0),
        vec4f(back, select(NEVER, distance, meets)),
        vec4f(back - passed.normal, offset),
        vec4f(passed.p, f32(passed.kind)),
        before,
    );
}
