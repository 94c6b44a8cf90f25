// The concentric map between square and disc (Shirley and Chiu 1997), without trigonometry.
// uses: nothing

/// cos and sin of t·π/4 for |t| ≤ 1: Taylor polynomials, off by at most 3e-8.
fn cos_sin_quarter(t: f32) -> vec2f {
    let s = t * t;
    let cosine = 1.0 + s * (-3.0842513753e-1 + s * (1.5854344244e-2 + s * (-3.2599188693e-4 + s * 3.5908604486e-6)));
    let sine = 7.8539816340e-1 + s * (-8.0745512188e-2 + s * (2.4903945702e-3
        + s * (-3.6576204182e-5 + s * 3.1336168904e-7)));
    return vec2f(cosine, sine * t);
}

/// atan(q)·4/π for |q| ≤ 1: Chebyshev fit, off by at most 1.4e-7.
fn atan_quarter(q: f32) -> f32 {
    let s = q * q;
    let high = 0.135430526 + s * (-0.095433302 + s * (0.054222319 + s * (-0.020377088 + s * 0.003608158)));
    return q * (1.273239525 + s * (-0.424409785 + s * (0.254552172 + s * (-0.180832510 + s * high))));
}

/// For a point of the square: xy = unit vector along the axis of its disc point, z = signed disc radius along it.
fn concentric_azimuth(square: vec2f) -> vec3f {
    let swap = abs(square.y) > abs(square.x);
    let larger = select(square.x, square.y, swap);
    let smaller = select(square.y, square.x, swap);
    let t = cos_sin_quarter(smaller / select(larger, 1.0, larger == 0.0));
    return vec3f(select(t, t.yx, swap), larger);
}

/// Map a point of the unit disc to the square.
fn disc_to_square(disc: vec2f) -> vec2f {
    let swap = abs(disc.y) > abs(disc.x);
    let larger = select(disc.x, disc.y, swap);
    let smaller = select(disc.y, disc.x, swap);
    let radius = select(length(disc), -length(disc), larger < 0.0);
    let along = radius * atan_quarter(smaller / select(larger, 1.0, larger == 0.0));
    return select(vec2f(radius, along), vec2f(along, radius), swap);
}
