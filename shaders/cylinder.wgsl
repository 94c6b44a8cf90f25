// A smooth dielectric cylinder in closed form, by complex products.
// uses: layout

/// Light that is still inside a fiber after this many chords is let out.
const MAX_CHORDS: u32 = 1024u;

/// Send ray m through the fiber p it has hit at `offset` α. `across` is m × p, `visible` its length; `number` is
/// uniform in (0, 1) and draws reflection (0 chords) or the number of chords inside.
fn scatter(m: vec3f, p: vec3f, across: vec3f, visible: f32, offset: f32, number: f32) -> vec3f {
    // Cosines of incidence and refraction, and α |m×p| / η; |η sin γt …|² = bent² + cos_t² is the transverse part.
    let cos_offset = sqrt((1.0 - offset) * (1.0 + offset));
    let cos_i = visible * cos_offset;
    let cos_t = sqrt(P.ior_square_less_1 + cos_i * cos_i) * P.ior_reciprocal;
    let bent = offset * visible * P.ior_reciprocal;
    // Share one division between Fresnel's law and the rotation by a chord.
    let s = cos_i + P.ior * cos_t;
    let p_polarised = P.ior * cos_i + cos_t;
    let transverse = bent * bent + cos_t * cos_t;
    let reciprocal = 1.0 / (s * p_polarised * transverse);
    let both = reciprocal * transverse;
    let transmitted = 2.0 * P.ior * cos_i * cos_t * (s * s + p_polarised * p_polarised) * both * both;
    let reflected = 1.0 - transmitted;
    let chord = vec2f(bent * bent - cos_t * cos_t, 2.0 * cos_t * bent) * (reciprocal * s * p_polarised);
    // Turn by 2γi, then by π − 2γt for each chord; P(at least k chords) = (1 − F) F^(k−1).
    var turn = vec2f(1.0 - 2.0 * offset * offset, 2.0 * cos_offset * offset);
    let rest = 1.0 - number;
    var threshold = transmitted;
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    turn = select(turn, complex_product(turn, chord), rest < threshold);
    threshold *= reflected;
    for (var chords = 4u; rest < threshold && chords < MAX_CHORDS; chords++) {
        turn = complex_product(turn, chord);
        threshold *= reflected;
    }
    // Keep the axial part; |m×p| cancels out of the transverse frame.
    let out = (dot(m, p) * (1.0 + turn.x)) * p - turn.x * m + turn.y * across;
    return out * (1.5 - 0.5 * dot(out, out));
}

fn complex_product(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
