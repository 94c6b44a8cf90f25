// Structures and bindings that the host shares.
// uses: nothing

/// Parameters of a run of dispatches. A start is an incident cell of a lit side.
struct Params {
    /// Seed of the random numbers, low word first.
    seed: vec2u,
    /// Walk id of walk 0 of start 0 of this batch, low word first.
    base: vec2u,
    /// Distance of the ids of consecutive walks of one start.
    id_stride: u32,
    /// Starts of this batch, and how many of them are lit from the front; these come first.
    starts: u32,
    front_starts: u32,
    /// Walks of each start.
    walks: u32,
    /// Blocks of walks in all.
    blocks: u32,
    /// Low bits of a draw that are the alias threshold.
    threshold_bits: u32,
    /// A walk is lost after this many tentative events.
    max_events: u32,
    /// Cells along an edge of the exit basis, or its rings, and cells in all.
    exit_n: u32,
    exit_cells: u32,
    /// Words of `bins` that belong to one start.
    start_words: u32,
    /// 1 / majorant, in mm.
    mean_free_path: f32,
    /// In mm.
    thickness: f32,
    /// Length of which the extents of direction patches are whole multiples.
    patch_unit: f32,
    /// Edge of an incident cell on the square.
    incident_edge: f32,
    /// 1 / starts.
    starts_reciprocal: f32,
    /// Half the length of the approximating cylinder in radii.
    half_length: f32,
    /// By kind of fiber: refractive index, its reciprocal, its square less 1; radius in mm.
    kinds: array<vec4f, MAX_KINDS>,
    /// By kind of fiber: the least absorption of any channel, in 1/mm.
    clearest: vec4f,
    /// Cells along x, y and z, and how many of them come on a mm.
    counts: vec4f,
    per_edge: vec4f,
    /// Largest radius of a fiber: in edges of a cell along x, y and z, or in mm without cells; then in mm.
    carry: vec4f,
    /// Rays of a start on which walks first meet fibers, and the one of the first walk of this segment; two spare words.
    first_hits: vec4u,
}

/// A lane: one walk under way, one that waits to be counted, one that waits to start.
struct Lane {
    /// m, and depth z in mm; among cells, the height above the back in edges of a cell.
    ray: vec4f,
    id: vec2u,
    start: u32,
    event: u32,
    hits: u32,
    state: u32,
    /// 1 when there are no more blocks.
    drained: u32,
    next_ready: u32,
    /// m and depth of the next walk.
    next: vec4f,
    next_id: vec2u,
    next_start: u32,
    pending_full: u32,
    /// m of a walk that has left.
    pending: vec4f,
    pending_id: vec2u,
    pending_start: u32,
    pending_hits: u32,
    pending_events: u32,
    /// The lane's block of walks: start, next walk, end.
    block_start: u32,
    block_walk: u32,
    block_end: u32,
    /// Path length inside each kind of fiber, in mm.
    lengths: vec4f,
    pending_lengths: vec4f,
    next_lengths: vec4f,
    /// Logarithm of the factor by which roulette has raised the weight.
    log_gain: f32,
    pending_log_gain: f32,
    /// The number of the next roulette, and whether it has been drawn.
    roulette: f32,
    roulette_ready: u32,
    base_exits: u32,
    pending_base_exits: u32,
    /// x and y in edges of a cell.
    place: vec2f,
    next_place: vec2f,
    /// How far it is empty around that place, as `cell_entry` says.
    reach: u32,
    next_reach: u32,
    /// Optical depth that is left of a flight by the table of H; negative when the next flight sets out.
    depth_left: f32,
    /// Fibers refused at the collision so far; none on the way to it.
    refused: u32,
    /// Fibers that the next walk has hit, and bases that it has left through.
    next_hits: u32,
    next_base_exits: u32,
    /// What the walk remembers, as `Memory` says.
    flight_from: vec4f,
    flight_to: vec4f,
    left_axis: vec4f,
    left_fiber: vec4f,
    known_fiber: vec4f,
    /// What the next walk remembers of its first flight.
    next_flight_from: vec4f,
    next_flight_to: vec4f,
    next_left_axis: vec4f,
    next_left_fiber: vec4f,
}

/// Sums over all lanes; pairs are low and high words.
struct Counters {
    next_block: atomic<u32>,
    launched: atomic<u32>,
    finished: atomic<u32>,
    resumed: atomic<u32>,
    tentative_low: atomic<u32>,
    tentative_high: atomic<u32>,
    collisions_low: atomic<u32>,
    collisions_high: atomic<u32>,
    base_exits_low: atomic<u32>,
    base_exits_high: atomic<u32>,
}

/// How one walk went.
struct Trace {
    bin: u32,
    events: u32,
    hits: u32,
    /// Times that this walk was counted.
    counted: u32,
}

/// A straight ray, and the fiber that it meets first.
struct FirstHit {
    /// m, and the offset α from the fiber's axis in radii.
    ray: vec4f,
    /// Where, as places of a lane are; one spare word.
    place: vec4f,
    /// p, and the kind of fiber; negative for none.
    fiber: vec4f,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<uniform> table_uniform: array<vec4u, UNIFORM_ENTRIES>;
@group(0) @binding(2) var table_texture: texture_2d<u32>;
@group(0) @binding(3) var<uniform> incident: array<vec4u, UNIFORM_ENTRIES>;
@group(0) @binding(4) var<storage, read_write> lanes: array<Lane>;
@group(0) @binding(5) var<storage, read_write> bins: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> counters: Counters;
@group(0) @binding(7) var<storage, read_write> traces: array<Trace>;
/// Absorption in 1/mm by channel and kind of fiber.
@group(0) @binding(8) var<uniform> absorption: array<vec4f, MAX_CHANNELS>;
/// Cells of the cloth, as `cell_entry` says.
@group(0) @binding(9) var<uniform> cells_uniform: array<vec4u, UNIFORM_ENTRIES>;
@group(0) @binding(10) var cells_texture: texture_2d<u32>;
/// Rays of all starts of this batch.
@group(0) @binding(11) var<storage, read> first_hits: array<FirstHit>;

/// Kinds of fiber.
override KINDS: u32 = 1;
/// Where flights start: 0 at hits, 1 where light leaves fibers, 2 the same with a factor of the hit's cell in the rate.
override PLACEMENT: u32 = 0;

/// The parameters once more: reading a uniform inside a loop is a gather on some devices.
var<private> P: Params;
