// Twin of src/model/exogenous/vortex.rs: the jets that rotors blow downwards, in which a UAV is pushed down that flies
// below another.

// What an agent feels of the others' jets.
struct Vortex {
    // The largest force of one jet.
    force: f32,
    // 1 / radius, and 2 / length.
    inverse_radius: f32,
    inverse_length: f32,
}

fn vortex_drawn(k: u32) -> Vortex {
    let word = VORTICES + 3u * k;
    return Vortex(drawn_number(word), drawn_number(word + 1u), drawn_number(word + 2u));
}

// p of the square of s.
fn jet_profile(s2: f32) -> f32 {
    let share = 1.0 / fma(s2, JET_SPREAD, 1.0);
    return share * share;
}

// v. The cube of a distance would leave the singles, so each of its factors is divided.
fn jet_growth(x: f32) -> f32 {
    let share = 1.0 / (1.0 + x);
    let near = x * share;
    return near * near * (share * JET_PEAK);
}

// What reaches the place `here` of the jet of an agent at the place `other`, as a share of the largest force.
fn jet_share(vortex: Vortex, here: vec3<f32>, other: vec3<f32>) -> f32 {
    let ahead = (other.x - here.x) * vortex.inverse_radius;
    let aside = (other.y - here.y) * vortex.inverse_radius;
    let above = lane_max(other.z - here.z, 0.0);
    return jet_profile(fma(ahead, ahead, aside * aside)) * jet_growth(above * vortex.inverse_length);
}

// Where an agent shows itself to be at a stage.
fn agent_place(stage: u32, agent: u32) -> vec3<f32> {
    return vec3(
        finite(slot_get(slot(stage, POSITION), 0u, agent)),
        finite(slot_get(slot(stage, POSITION), 1u, agent)),
        finite(slot_get(slot(stage, POSITION), 2u, agent)),
    );
}

// The force along z on this agent.
fn vortex_force(stage: u32) -> f32 {
    let here = agent_place(stage, own.agent);
    var force = 0.0;
    for (var k = 0u; k < N_VORTICES; k++) {
        let vortex = vortex_drawn(k);
        var sum = 0.0;
        // An agent does not act on itself: its vertical distance is 0.
        for (var agent = 0u; agent < TEAM; agent++) {
            sum = sum + jet_share(vortex, here, agent_place(stage, agent));
        }
        force = fma(sum, -vortex.force, force);
    }
    return force;
}
