// Twin of src/model/lanes/math.rs: elementary functions, since those of WGSL may be off by 2^-11. The coefficients come
// from there; tanh, atan2 and clamp take the place of the built-in functions of these names.

fn polynomial_4(x: f32, c: array<f32, 4>) -> f32 {
    return fma(fma(fma(c[3], x, c[2]), x, c[1]), x, c[0]);
}

fn polynomial_5(x: f32, c: array<f32, 5>) -> f32 {
    return fma(fma(fma(fma(c[4], x, c[3]), x, c[2]), x, c[1]), x, c[0]);
}

fn polynomial_7(x: f32, c: array<f32, 7>) -> f32 {
    return fma(fma(fma(fma(fma(fma(c[6], x, c[5]), x, c[4]), x, c[3]), x, c[2]), x, c[1]), x, c[0]);
}

fn polynomial_9(x: f32, c: array<f32, 9>) -> f32 {
    let upper = fma(fma(fma(fma(c[8], x, c[7]), x, c[6]), x, c[5]), x, c[4]);
    return fma(fma(fma(fma(upper, x, c[3]), x, c[2]), x, c[1]), x, c[0]);
}

// sin(pi/2 f) for f in [-1, 1].
fn sin_folded(f: f32) -> f32 {
    return polynomial_5(f * f, SIN_FOLDED) * f;
}

// Sine and cosine of an angle, rad: reduction to [-pi/2, pi/2] by the nearest multiple n of pi, whose parity is the
// sign.
fn sin_cos(x: f32) -> vec2<f32> {
    let half = 0.5;
    let n = floor(fma(x, FRAC_1_PI, half));
    let r = fma(n, -PI_LOW, fma(n, -PI_HIGH, x));
    let r2 = r * r;
    let sine = fma(polynomial_4(r2, SIN), r2 * r, r);
    let cosine = fma(polynomial_5(r2, COS), r2, 1.0);
    let parity = fma(n, half, -floor(n * half));
    let sign = fma(parity, -4.0, 1.0);
    return vec2(sine * sign, cosine * sign);
}

// Hyperbolic tangent.
fn tanh(argument: f32) -> f32 {
    let x = lane_min(lane_max(argument, -TANH_LIMIT), TANH_LIMIT);
    let x2 = x * x;
    return polynomial_7(x2, TANH_NUMERATOR) * x / polynomial_4(x2, TANH_DENOMINATOR);
}

// The angle of the point (x, y), rad; 0 at the origin.
fn atan2(y: f32, x: f32) -> f32 {
    let run = abs(x);
    let rise = abs(y);
    // The smallest normal single keeps 0/0 out: at the origin the quotient is 0.
    let q = lane_min(run, rise) / lane_max(lane_max(run, rise), MIN_POSITIVE);
    var angle = polynomial_9(q * q, ATAN) * q;
    angle = lane_select_le(rise, run, angle, FRAC_PI_2 - angle);
    angle = lane_select_le(0.0, x, angle, PI - angle);
    return lane_select_le(0.0, y, angle, -angle);
}

// ln(mantissa 2^exponent) for a mantissa in [sqrt(1/2), sqrt(2)).
fn ln_split(mantissa: f32, exponent: f32) -> f32 {
    let f = mantissa - 1.0;
    let f2 = f * f;
    let tail = polynomial_7(f, LN) * (f2 * f);
    let small = fma(f2, -0.5, tail) + f;
    return fma(exponent, LN_2, small);
}

// `value` within `low` and `high`; `low` where it is NaN.
fn clamp(value: f32, low: f32, high: f32) -> f32 {
    return lane_min(lane_max(value, low), high);
}
