// One entry point for each function, for tests: numbered input words, one output record.
// uses: layout, rng, concentric, cells, medium, march, carried, cylinder, goniometer

/// Inputs of one call.
struct ProbeInput {
    a: vec4u,
    b: vec4u,
    c: vec4u,
}

@group(1) @binding(0) var<storage, read> probe_inputs: array<ProbeInput>;
@group(1) @binding(1) var<storage, read_write> probe_outputs: array<vec4u>;

/// a = counter, b.xy = seed.
@compute @workgroup_size(64)
fn probe_threefry(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let input = probe_inputs[call.x];
    probe_outputs[call.x] = threefry(input.b.xy, input.a);
}

/// a.x = word.
@compute @workgroup_size(64)
fn probe_free_path(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    probe_outputs[call.x] = vec4u(bitcast<u32>(free_path(probe_inputs[call.x].a.x)), 0u, 0u, 0u);
}

/// a = words of an event, b.x = list: first entry and index bits.
@compute @workgroup_size(64)
fn probe_draw_fiber(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let words = probe_inputs[call.x].a;
    let list = probe_inputs[call.x].b.x;
    probe_outputs[call.x] = vec4u(bitcast<vec3u>(draw_fiber(words, list).p), table_index(words.y, list));
}

/// The passage of an input: a.xyz = m, b.xyz = p, a.w = α, b.w = number (all f32), c.x = kind.
fn scattered(index: u32) -> Passage {
    let a = bitcast<vec4f>(probe_inputs[index].a);
    let b = bitcast<vec4f>(probe_inputs[index].b);
    let across = cross(a.xyz, b.xyz);
    let optics = kind_optics(probe_inputs[index].c.x);
    return scatter(a.xyz, b.xyz, across, length(across), optics, a.w, b.w);
}

/// As `scattered` says; gives m and the path in radii, negative when the light
/// left through a base.
@compute @workgroup_size(64)
fn probe_scatter(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let out = scattered(call.x);
    probe_outputs[call.x] = bitcast<vec4u>(vec4f(out.m, select(out.path, -out.path, out.through_base == 1u)));
}

/// As `scattered` says; gives the way from the hit to where light leaves, in radii, and whether that is a base.
@compute @workgroup_size(64)
fn probe_displacement(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let out = scattered(call.x);
    probe_outputs[call.x] = bitcast<vec4u>(vec4f(out.displacement, f32(i32(out.through_base))));
}

/// a.xyz = place in edges of a cell, b.xyz = m (all f32).
@compute @workgroup_size(64)
fn probe_skip_clear(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let place = bitcast<vec3f>(probe_inputs[call.x].a.xyz);
    let m = bitcast<vec3f>(probe_inputs[call.x].b.xyz);
    let there = skip_clear(place, reach_ahead(place, m), m * P.per_edge.xyz);
    probe_outputs[call.x] = vec4u(bitcast<vec3u>(there), 0u);
}

/// a = words, b.x = start.
@compute @workgroup_size(64)
fn probe_start_direction(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let input = probe_inputs[call.x];
    probe_outputs[call.x] = vec4u(bitcast<vec3u>(start_direction(input.b.x, input.a)), 0u);
}

/// a.xyz = m (f32), b.x = hits, b.y = start.
@compute @workgroup_size(64)
fn probe_exit_bin(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let input = probe_inputs[call.x];
    probe_outputs[call.x] = vec4u(exit_bin(input.b.y, bitcast<vec3f>(input.a.xyz), input.b.x), 0u, 0u, 0u);
}

/// a.xyz = place in edges of a cell (f32); gives the place in the repeat, and the cell's index.
@compute @workgroup_size(64)
fn probe_come_back(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let place = come_back(bitcast<vec3f>(probe_inputs[call.x].a.xyz));
    probe_outputs[call.x] = vec4u(bitcast<vec3u>(place), cell_index(cell_of(place)));
}

/// a.xyz = place in edges of a cell, b.xyz = m (all f32).
@compute @workgroup_size(64)
fn probe_skip_empty(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let place = bitcast<vec3f>(probe_inputs[call.x].a.xyz);
    let speed = bitcast<vec3f>(probe_inputs[call.x].b.xyz) * P.per_edge.xyz;
    let there = skip_empty(place, cell_entry(cell_of(place)).w, speed);
    probe_outputs[call.x] = vec4u(bitcast<vec3u>(there), 0u);
}

/// a.xyz = m (f32), b.x = list: first entry and index bits.
@compute @workgroup_size(64)
fn probe_visible_area(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let input = probe_inputs[call.x];
    let area = visible_area(input.b.x, bitcast<vec3f>(input.a.xyz));
    probe_outputs[call.x] = vec4u(bitcast<u32>(area), 0u, 0u, 0u);
}

/// a.xyz = place in edges of a cell, b.xyz = m (all f32); gives the place in the repeat and the time to the face, or with
/// c.x = 1 the face and the list.
@compute @workgroup_size(64)
fn probe_block_ahead(@builtin(global_invocation_id) call: vec3u) {
    P = params;
    let input = probe_inputs[call.x];
    let block = block_ahead(bitcast<vec3f>(input.a.xyz), bitcast<vec3f>(input.b.xyz) * P.per_edge.xyz);
    let face = vec4u(bitcast<vec3u>(block.face), block.list);
    probe_outputs[call.x] = select(bitcast<vec4u>(vec4f(block.place, block.time)), face, input.c.x == 1u);
}
