// Twin of src/model/exogenous/friction.rs: what slows a channel down, which the controller's model does not have.

// What slows a channel down.
struct Friction {
    // The force at large rates.
    coulomb: f32,
    // 1 / the rate within which it changes its sign.
    inverse_smoothing: f32,
    viscous: f32,
}

fn friction_drawn(k: u32) -> Friction {
    let word = FRICTIONS + 3u * k;
    return Friction(drawn_number(word), drawn_number(word + 1u), drawn_number(word + 2u));
}

// The force of all frictions on this channel at its rate.
fn friction_force(rate: f32) -> f32 {
    var force = 0.0;
    for (var k = 0u; k < N_FRICTIONS; k++) {
        let friction = friction_drawn(k);
        let slip = tanh(rate * friction.inverse_smoothing);
        force = fma(slip, -friction.coulomb, force);
        force = fma(rate, -friction.viscous, force);
    }
    return force;
}
