// A smooth dielectric cylinder in closed form, by complex products.
// uses: layout

/// Fibers end: light may leave through a base of the approximating cylinder.
override BASES: bool = false;

/// Light that is still inside a fiber after this many chords is let out.
const MAX_CHORDS: u32 = 1024u;

/// How light leaves a fiber.
struct Passage {
    m: vec3f,
    /// Length of the way inside, in radii.
    path: f32,
    /// 1 when it left through a base.
    through_base: u32,
    /// From the hit to where it left, in radii; 0 for flights that start at hits.
    displacement: vec3f,
}

/// Send ray m through the fiber p it has hit at `offset` α. `across` is m × p, `visible` its length, `optics` comes from
/// the fiber's kind; `number` is uniform in (0, 1) and draws reflection (0 chords) or the number of chords inside.
fn scatter(m: vec3f, p: vec3f, across: vec3f, visible: f32, optics: vec4f, offset: f32, number: f32) -> Passage {
    // Cosines of incidence and refraction, and α |m×p| / η; bent² + cos_t² is the transverse part inside.
    let ior = optics.x;
    let axial = dot(m, p);
    let cos_offset = sqrt((1.0 - offset) * (1.0 + offset));
    let cos_i = visible * cos_offset;
    let cos_t = sqrt(optics.z + cos_i * cos_i) * optics.y;
    let bent = offset * visible * optics.y;
    // Share one division between Fresnel's law and the rotation by a chord.
    let s = cos_i + ior * cos_t;
    let p_polarised = ior * cos_i + cos_t;
    let transverse = bent * bent + cos_t * cos_t;
    let reciprocal = 1.0 / (s * p_polarised * transverse);
    let both = reciprocal * transverse;
    let transmitted = 2.0 * ior * cos_i * cos_t * (s * s + p_polarised * p_polarised) * both * both;
    let reflected = 1.0 - transmitted;
    let transverse_reciprocal = reciprocal * s * p_polarised;
    let chord = vec2f(bent * bent - cos_t * cos_t, 2.0 * cos_t * bent) * transverse_reciprocal;
    // Turn by 2γi, then by π − 2γt for each chord; P(at least k chords) = (1 − F) F^(k−1).
    var turn = vec2f(1.0 - 2.0 * offset * offset, 2.0 * cos_offset * offset);
    let start = vec2f(cos_offset, offset);
    let rest = 1.0 - number;
    var threshold = transmitted;
    var chords = select(0.0, 1.0, rest < threshold);
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    chords += select(0.0, 1.0, rest < threshold);
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    chords += select(0.0, 1.0, rest < threshold);
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    chords += select(0.0, 1.0, rest < threshold);
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    for (var more = 4u; rest < threshold && more < MAX_CHORDS; more++) {
        turn = complex_product(turn, chord);
        threshold *= reflected;
        chords += 1.0;
    }
    // Each chord is 2 cos γt / √(1 − (m·p)²/η²) long.
    let chord_length = 2.0 * cos_t * transverse_reciprocal;
    let radial = axial * p - m;
    if BASES {
        let entry = complex_product(vec2f(cos_offset, offset), vec2f(cos_t, -bent)) * -inverseSqrt(transverse);
        // What is left of the number: uniform inside the interval that drew the chords.
        let interval = select(transmitted, transmitted * pow(max(reflected, 1e-30), chords - 1.0), chords > 1.5);
        let left = (rest / max(interval, 1e-30) - reflected) / transmitted;
        let bases = meet_bases(axial, optics, chords, chord_length, left);
        if bases.x < 0.5 {
            let out = normalize(axial * bases.y * p + turn.x * radial + turn.y * across);
            let shift = rim_shift(turn, start) / visible;
            return Passage(out, chords * chord_length, 0u, shift.x * radial + shift.y * across + bases.w * p);
        }
        // Leave through a base: Snell at a plane keeps the transverse azimuth of that chord.
        var azimuth = entry;
        var whole = 0.0;
        for (var before = 1u; before < min(u32(ceil(bases.z / chord_length)), MAX_CHORDS); before++) {
            azimuth = complex_product(azimuth, chord);
            whole += chord_length;
        }
        let sine_square = ior * ior - axial * axial;
        let outside = (azimuth.x * radial + azimuth.y * across) * (sqrt(sine_square) / visible);
        // The base is met part of the way along that chord.
        let rim = complex_product(start, complex_product(azimuth, vec2f(entry.x, -entry.y)));
        let shift = select(vec2f(0.0), rim - start + azimuth * ((bases.z - whole) * sqrt(transverse)), PLACEMENT > 0u) / visible;
        let displacement = shift.x * radial + shift.y * across + bases.w * p;
        return Passage(normalize(sqrt(1.0 - sine_square) * sign(axial) * bases.y * p + outside), bases.z, 1u, displacement);
    }
    // Keep the axial part; |m×p| cancels out of the transverse frame.
    let out = axial * p + turn.x * radial + turn.y * across;
    let path = chords * chord_length;
    let shift = rim_shift(turn, start) / visible;
    let along = select(0.0, path * axial * optics.y, PLACEMENT > 0u);
    return Passage(out * (1.5 - 0.5 * dot(out, out)), path, 0u, shift.x * radial + shift.y * across + along * p);
}

/// From the hit at γi to where light leaves the side, across the axis in radii: directions turn to 2γi + k(π − 2γt), places
/// to γi + k(π − 2γt).
fn rim_shift(turn: vec2f, start: vec2f) -> vec2f {
    return select(vec2f(0.0), complex_product(turn, vec2f(start.x, -start.y)) - start, PLACEMENT > 0u);
}

/// Follow the light along the axis: x = 1 when it leaves through a base, y = sign of the axial component after the
/// reflections at bases, z = path to that base in radii, w = how far along p it leaves from the hit, in radii. `left` is
/// uniform in (0, 1).
fn meet_bases(axial: f32, optics: vec4f, chords: f32, chord_length: f32, left: f32) -> vec4f {
    let along = chords * chord_length * abs(axial) * optics.y;
    let bases = floor((along + P.half_length) / (2.0 * P.half_length));
    let sine_square = optics.x * optics.x - axial * axial;
    var through = bases;
    if sine_square < 1.0 {
        // Reflectance of the base, from the cosine outside.
        let outside = sqrt(1.0 - sine_square);
        let inside = abs(axial) * optics.y;
        let s = (outside - optics.x * inside) / (outside + optics.x * inside);
        let p = (optics.x * outside - inside) / (optics.x * outside + inside);
        let base = 0.5 * (s * s + p * p);
        through = select(0.0, floor(log(clamp(left, 1e-12, 1.0)) / log(base)), base > 0.0);
    }
    let leaves = through < bases;
    let reflections = min(through, bases);
    let direction = 1.0 - 2.0 * (reflections - 2.0 * floor(0.5 * reflections));
    let path = (2.0 * reflections + 1.0) * P.half_length * optics.x / max(abs(axial), 1e-12);
    let way = select(along - 2.0 * P.half_length * reflections, P.half_length, leaves);
    let shift = select(0.0, way * direction * sign(axial), PLACEMENT > 0u);
    return vec4f(select(0.0, 1.0, leaves), direction, path, shift);
}

fn complex_product(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
