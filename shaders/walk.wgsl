// The kernel: one flat loop, one tentative event of one walk per lane and pass.
// uses: layout, rng, cells, medium, march, memory, carried, cylinder, goniometer, score, first_hit

override WORKGROUP: u32 = 64;
/// Passes of a dispatch.
override BUDGET: u32 = 4096;
/// Passes between two flushes.
override FLUSH_EVERY: u32 = 6;
/// Record how every walk went.
override TRACE: bool = false;
/// Let Russian roulette end walks that carry little light.
override ROULETTE: bool = false;

const IDLE: u32 = 0u;
const WALKING: u32 = 1u;
const LEFT: u32 = 2u;

/// Sums of one lane over one dispatch.
struct Sums {
    launched: u32,
    finished: u32,
    tentative: u32,
    collisions: u32,
    base_exits: u32,
}

@compute @workgroup_size(WORKGROUP)
fn walk(@builtin(global_invocation_id) invocation: vec3u) {
    P = params;
    var lane = lanes[invocation.x];
    var sums = Sums();
    let resumed = select(0u, 1u, lane.state == WALKING && lane.event > 0u);
    for (var pass_count = 0u; pass_count < BUDGET; pass_count += FLUSH_EVERY) {
        flush(&lane, &sums);
        if lane.drained == 1u && lane.state == IDLE && lane.next_ready == 0u {
            break;
        }
        for (var k = 0u; k < FLUSH_EVERY; k++) {
            step(&lane);
        }
    }
    lanes[invocation.x] = lane;
    add_sums(sums, resumed);
}

/// Make one tentative event, and let a walk that has left make room for the next.
fn step(lane: ptr<function, Lane>) {
    let walking = (*lane).state == WALKING;
    let words = threefry(P.seed, vec4u((*lane).id, (*lane).event, PURPOSE_EVENT));
    let m = (*lane).ray.xyz;
    let slab = slab_of((*lane).start);
    var site = fly(lane, m, slab, words.x);
    // Draw the fiber there and see whether the ray hits it.
    var fiber = draw_fiber(words, site.list);
    var offset = 2.0 * uniform_open(words.w) - 1.0;
    let memory = remembered(lane);
    let flown = min(memory.flight_from.w + site.path, memory.flight_to.w);
    let known = MEMORY && flown == memory.flight_to.w;
    if MEMORY {
        // Come to the fiber that is known, if it is on the way.
        let there = come_to(lane, m, flown - memory.flight_from.w);
        site = Site(
            select(site.z, there.z, known), select(site.place, there.xy, known), site.inside || known,
            site.arrived || known, site.share, site.list, select(site.reach, 0u, known), site.depth, site.path,
        );
        fiber.p = select(fiber.p, memory.known_fiber.xyz, known);
        fiber.kind = select(fiber.kind, u32(max(memory.known_fiber.w, 0.0)), known);
        offset = select(offset, memory.left_axis.w, known);
    }
    let across = cross(m, fiber.p);
    let visible = max(length(across), 1e-12);
    let optics = kind_optics(fiber.kind);
    let normal = surface_normal(m, fiber.p, across, offset) * (optics.w / visible);
    var share = site.share;
    if PLACEMENT > 0u {
        share *= share_of_axis(vec3f(site.place, site.z), normal, slab);
    }
    var seen = select(visible, max(share * visible, 1e-12), (CELLS && VISIBLE_N == 0u) || PLACEMENT > 0u);
    seen = select(seen, 1.0, known);
    let accept = uniform_open(words.z);
    let inside = site.inside;
    var hit = site.arrived && accept < seen;
    if MEMORY {
        hit = hit && (known || !rules_out(memory, m, flown, normal, fiber.p, optics.w));
    }
    // A ray that hits nothing gets the number of plain reflection, which ends the chords at once.
    let number = select(0.0, accept / seen, hit);
    let passage = scatter(m, fiber.p, across, visible, optics, offset, number);
    if ABSORBING {
        let length = select(0.0, passage.path * optics.w, walking && hit);
        (*lane).lengths += select(vec4f(0.0), vec4f(length), vec4u(0u, 1u, 2u, 3u) == vec4u(select(0u, fiber.kind, KINDS > 1u)));
    }
    if BASES {
        (*lane).base_exits += select(0u, passage.through_base, walking && hit);
    }
    // Give up a walk of too many events: no direction at all is counted as lost.
    let event = (*lane).event + select(0u, 1u, walking);
    let ended = walking && inside && roulette_ends(lane, event);
    let lost = inside && event >= P.max_events;
    var turned = select(select(m, passage.m, hit), vec3f(0.0), lost);
    turned = select(turned, vec3f(2.0, 0.0, 0.0), ended);
    var there = vec3f(site.place, site.z);
    var reach = site.reach;
    if PLACEMENT > 0u {
        // On the surface of a fiber nothing is known of the cells about.
        there += select(vec3f(0.0), passage.displacement * (optics.w * P.per_edge.xyz), hit);
        reach = select(reach, 0u, hit);
    }
    if MEMORY {
        let passed = Passed(m, normal, fiber.p, fiber.kind, passage.displacement * optics.w);
        let after = hit_remembered(memory, passed, flown, passage.m, there.z / P.per_edge.z, slab);
        remember(lane, after, flown, walking, hit);
    }
    (*lane).ray = select((*lane).ray, vec4f(turned, there.z), walking);
    if CELLS {
        (*lane).place = select((*lane).place, there.xy, walking);
        (*lane).reach = select((*lane).reach, reach, walking);
    }
    if VISIBLE_N > 0u {
        // Where all fibers are nearly parallel to the ray, the table's H is its error: give the collision up.
        let refused = select(0u, (*lane).refused + 1u, site.arrived);
        let done = hit || refused >= MOST_REFUSALS;
        (*lane).refused = select((*lane).refused, select(refused, 0u, done), walking);
        (*lane).depth_left = select((*lane).depth_left, select(site.depth, -1.0, done), walking);
    }
    (*lane).event = event;
    (*lane).hits += select(0u, 1u, walking && hit);
    (*lane).state = select((*lane).state, LEFT, walking && (!inside || lost || ended));
    change_walk(lane);
}

/// The place of a lane after so many mm.
fn come_to(lane: ptr<function, Lane>, m: vec3f, path: f32) -> vec3f {
    let place = vec3f((*lane).place, (*lane).ray.w) + m * P.per_edge.xyz * path;
    return select(place, come_back(place), CELLS);
}

/// Keep what is remembered after an event of a walk.
fn remember(lane: ptr<function, Lane>, after: Memory, flown: f32, walking: bool, hit: bool) {
    let passed = walking && hit;
    (*lane).flight_from.w = select((*lane).flight_from.w, flown, walking);
    (*lane).flight_from = select((*lane).flight_from, after.flight_from, passed);
    (*lane).flight_to = select((*lane).flight_to, after.flight_to, passed);
    (*lane).left_axis = select((*lane).left_axis, after.left_axis, passed);
    (*lane).left_fiber = select((*lane).left_fiber, after.left_fiber, passed);
    (*lane).known_fiber = select((*lane).known_fiber, after.known_fiber, passed);
}

/// Fly through one event; a sheet lies between the heights of `slab`.
fn fly(lane: ptr<function, Lane>, m: vec3f, slab: vec2f, word: u32) -> Site {
    if VISIBLE_N > 0u {
        return march((*lane).ray, (*lane).place, (*lane).refused > 0u, (*lane).depth_left, slab, word);
    }
    let path = free_path(word);
    if PLACEMENT > 0u {
        return fly_carried((*lane).ray, (*lane).place, (*lane).reach, slab, path);
    }
    if CELLS {
        let speed = m * P.per_edge.xyz;
        let begin = skip_empty(vec3f((*lane).place, (*lane).ray.w), (*lane).reach, speed);
        let place = come_back(begin + speed * path);
        let inside = place.z >= 0.0 && place.z <= P.counts.z;
        let entry = cell_entry(cell_of(place));
        return Site(place.z, place.xy, inside, inside, bitcast<f32>(entry.x), entry.z, entry.w, 0.0, 0.0);
    }
    let z = (*lane).ray.w + m.z * path;
    let inside = z <= slab.y && z >= slab.x;
    return Site(z, vec2f(0.0), inside, inside, 1.0, 0u, 0u, 0.0, 0.0);
}

/// Play Russian roulette, every 16 events, with a walk whose brightest channel may have kept little: it goes on with the
/// probability of what it kept, and then carries all of it.
fn roulette_ends(lane: ptr<function, Lane>, event: u32) -> bool {
    if !ROULETTE {
        return false;
    }
    let due = (*lane).state == WALKING && event % ROULETTE_EVERY == 0u;
    let depth = dot(P.clearest, (*lane).lengths);
    let kept = exp((*lane).log_gain - depth);
    let played = due && kept < ROULETTE_BELOW;
    (*lane).log_gain = select((*lane).log_gain, depth, played);
    (*lane).roulette_ready = select((*lane).roulette_ready, 0u, due);
    return played && (*lane).roulette >= kept;
}

/// Park a walk that has left, if the place is free, and start the one that waits.
fn change_walk(lane: ptr<function, Lane>) {
    let leaving = (*lane).state == LEFT && (*lane).pending_full == 0u;
    (*lane).pending = select((*lane).pending, (*lane).ray, leaving);
    (*lane).pending_start = select((*lane).pending_start, (*lane).start, leaving);
    (*lane).pending_hits = select((*lane).pending_hits, (*lane).hits, leaving);
    (*lane).pending_events = select((*lane).pending_events, (*lane).event, leaving);
    (*lane).pending_full = select((*lane).pending_full, 1u, leaving);
    if TRACE || ABSORBING {
        (*lane).pending_id = select((*lane).pending_id, (*lane).id, leaving);
    }
    if ABSORBING {
        (*lane).pending_lengths = select((*lane).pending_lengths, (*lane).lengths, leaving);
        (*lane).pending_log_gain = select((*lane).pending_log_gain, (*lane).log_gain, leaving);
    }
    if BASES {
        (*lane).pending_base_exits = select((*lane).pending_base_exits, (*lane).base_exits, leaving);
    }
    let free = leaving || (*lane).state == IDLE;
    let starting = free && (*lane).next_ready == 1u;
    (*lane).state = select(select((*lane).state, IDLE, free), WALKING, starting);
    (*lane).ray = select((*lane).ray, (*lane).next, starting);
    (*lane).id = select((*lane).id, (*lane).next_id, starting);
    (*lane).start = select((*lane).start, (*lane).next_start, starting);
    (*lane).event = select((*lane).event, 0u, starting);
    (*lane).hits = select((*lane).hits, 0u, starting);
    (*lane).next_ready = select((*lane).next_ready, 0u, starting);
    if FIRST_HITS {
        // Event 0 is behind it.
        (*lane).event = select((*lane).event, 1u, starting);
        (*lane).hits = select((*lane).hits, (*lane).next_hits, starting);
        (*lane).state = select((*lane).state, LEFT, starting && (*lane).next_hits == 0u);
    }
    if CELLS {
        (*lane).place = select((*lane).place, (*lane).next_place, starting);
        (*lane).reach = select((*lane).reach, (*lane).next_reach, starting);
    }
    if MEMORY {
        var begun = no_memory();
        if FIRST_HITS {
            let none = begun.known_fiber;
            begun = Memory((*lane).next_flight_from, (*lane).next_flight_to, (*lane).next_left_axis, (*lane).next_left_fiber, none);
        }
        (*lane).flight_from = select((*lane).flight_from, begun.flight_from, starting);
        (*lane).flight_to = select((*lane).flight_to, begun.flight_to, starting);
        (*lane).left_axis = select((*lane).left_axis, begun.left_axis, starting);
        (*lane).left_fiber = select((*lane).left_fiber, begun.left_fiber, starting);
        (*lane).known_fiber = select((*lane).known_fiber, begun.known_fiber, starting);
    }
    if VISIBLE_N > 0u {
        (*lane).refused = select((*lane).refused, 0u, starting);
        (*lane).depth_left = select((*lane).depth_left, -1.0, starting);
    }
    if ABSORBING {
        let begun = select(vec4f(0.0), (*lane).next_lengths, FIRST_HITS);
        (*lane).lengths = select((*lane).lengths, begun, starting);
        (*lane).log_gain = select((*lane).log_gain, 0.0, starting);
        (*lane).roulette_ready = select((*lane).roulette_ready, 0u, starting);
    }
    if BASES {
        (*lane).base_exits = select((*lane).base_exits, select(0u, (*lane).next_base_exits, FIRST_HITS), starting);
    }
}

/// Count the walk that waits to be counted, and ready the next one.
fn flush(lane: ptr<function, Lane>, sums: ptr<function, Sums>) {
    if (*lane).pending_full == 1u {
        let start = (*lane).pending_start;
        let bin = exit_bin(start, (*lane).pending.xyz, (*lane).pending_hits);
        atomicAdd(&bins[start * P.start_words + bin], 1u);
        if ABSORBING {
            score(start, bin, (*lane).pending_id, (*lane).pending_log_gain, (*lane).pending_lengths);
        }
        if TRACE {
            let slot = (*lane).pending_id.x - P.base.x;
            traces[slot] = Trace(bin, (*lane).pending_events, (*lane).pending_hits, traces[slot].counted + 1u);
        }
        (*sums).finished += 1u;
        (*sums).tentative += (*lane).pending_events;
        (*sums).collisions += (*lane).pending_hits;
        (*sums).base_exits += (*lane).pending_base_exits;
        (*lane).pending_full = 0u;
    }
    if ROULETTE && (*lane).roulette_ready == 0u {
        let counter = vec4u((*lane).id, (*lane).event / ROULETTE_EVERY, PURPOSE_ROULETTE);
        (*lane).roulette = uniform_open(threefry(P.seed, counter).x);
        (*lane).roulette_ready = 1u;
    }
    if (*lane).next_ready == 0u && (*lane).drained == 0u {
        if (*lane).block_walk == (*lane).block_end {
            fetch_block(lane);
        }
        if (*lane).drained == 0u {
            ready_next(lane);
            (*sums).launched += 1u;
        }
    }
}

/// Take the next block of walks; a block belongs to one start.
fn fetch_block(lane: ptr<function, Lane>) {
    let block = atomicAdd(&counters.next_block, 1u);
    if block >= P.blocks {
        (*lane).drained = 1u;
        return;
    }
    // Divide by the number of starts in f32: exact after one correction, as blocks stay below 2²⁴.
    var row = u32(f32(block) * P.starts_reciprocal);
    row = select(row, row - 1u, row * P.starts > block);
    row = select(row, row + 1u, (row + 1u) * P.starts <= block);
    (*lane).block_start = block - row * P.starts;
    (*lane).block_walk = row * BLOCK;
    (*lane).block_end = min(row * BLOCK + BLOCK, P.walks);
}

/// Draw the start of the block's next walk, id = base + i·stride + start.
fn ready_next(lane: ptr<function, Lane>) {
    let start = (*lane).block_start;
    let low = P.base.x + (*lane).block_walk * P.id_stride + start;
    let id = vec2u(low, P.base.y + select(0u, 1u, low < P.base.x));
    if FIRST_HITS {
        let begun = first_hit(start, (*lane).block_walk, id);
        (*lane).next = begun.ray;
        (*lane).next_place = begun.place;
        (*lane).next_reach = 0u;
        if CELLS && PLACEMENT == 0u {
            (*lane).next_reach = cell_entry(cell_of(vec3f(begun.place, begun.ray.w))).w;
        }
        (*lane).next_hits = begun.hits;
        (*lane).next_base_exits = begun.base_exits;
        (*lane).next_lengths = begun.lengths;
        if MEMORY {
            (*lane).next_flight_from = begun.memory.flight_from;
            (*lane).next_flight_to = begun.memory.flight_to;
            (*lane).next_left_axis = begun.memory.left_axis;
            (*lane).next_left_fiber = begun.memory.left_fiber;
        }
    } else {
        set_out(lane, start, threefry(P.seed, vec4u(id, 0u, PURPOSE_START)));
    }
    (*lane).next_id = id;
    (*lane).next_start = start;
    (*lane).next_ready = 1u;
    (*lane).block_walk += 1u;
}

/// Let the next walk set out from the lit face.
fn set_out(lane: ptr<function, Lane>, start: u32, words: vec4u) {
    (*lane).next = vec4f(start_direction(start, words), start_depth(start));
    if CELLS {
        (*lane).next_place = start_place(words);
        if PLACEMENT > 0u {
            (*lane).next_reach = reach_ahead(vec3f((*lane).next_place, (*lane).next.w), (*lane).next.xyz);
        } else {
            (*lane).next_reach = cell_entry(cell_of(vec3f((*lane).next_place, (*lane).next.w))).w;
        }
    }
}

fn add_sums(sums: Sums, resumed: u32) {
    atomicAdd(&counters.launched, sums.launched);
    atomicAdd(&counters.finished, sums.finished);
    atomicAdd(&counters.resumed, resumed);
    // Carry into the high words.
    let tentative = atomicAdd(&counters.tentative_low, sums.tentative);
    if tentative + sums.tentative < tentative {
        atomicAdd(&counters.tentative_high, 1u);
    }
    let collisions = atomicAdd(&counters.collisions_low, sums.collisions);
    if collisions + sums.collisions < collisions {
        atomicAdd(&counters.collisions_high, 1u);
    }
    let base_exits = atomicAdd(&counters.base_exits_low, sums.base_exits);
    if base_exits + sums.base_exits < base_exits {
        atomicAdd(&counters.base_exits_high, 1u);
    }
}
