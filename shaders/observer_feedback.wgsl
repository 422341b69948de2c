// Twin of src/model/controller/observer_feedback.rs: observer (20) and feedback (21) of one channel, whose state is
// [int e, e, e', observer].

struct ChannelGains {
    // K of (21): four and three.
    feedback: array<vec4<f32>, 2>,
    // Rows of -L of (20).
    injection: array<vec4<f32>, 7>,
    // Smoothing model (18): F_0' = a F_0 + b F_1, F_1' = c (F_0 - F_1).
    smoothing: vec4<f32>,
    // Second and third entry of B20, (34).
    sensor_fault_input: vec4<f32>,
}

// The gains of the channel. A group under thrust has those of position and of attitude, every other one kind: what is
// read at a constant place of a uniform costs neither registers nor loads on most GPUs, so there are two reads and a
// choice.
fn injection(row: u32) -> vec4<f32> {
    if PLANT == THRUST {
        return select(uniforms.gains[0].injection[row], uniforms.gains[KINDS - 1u].injection[row], is_attitude());
    }
    return uniforms.gains[0].injection[row];
}

fn feedback_gains(k: u32) -> vec4<f32> {
    if PLANT == THRUST {
        return select(uniforms.gains[0].feedback[k], uniforms.gains[KINDS - 1u].feedback[k], is_attitude());
    }
    return uniforms.gains[0].feedback[k];
}

fn smoothing() -> vec4<f32> {
    if PLANT == THRUST {
        return select(uniforms.gains[0].smoothing, uniforms.gains[KINDS - 1u].smoothing, is_attitude());
    }
    return uniforms.gains[0].smoothing;
}

fn sensor_fault_input() -> vec4<f32> {
    if PLANT == THRUST {
        return select(
            uniforms.gains[0].sensor_fault_input,
            uniforms.gains[KINDS - 1u].sensor_fault_input,
            is_attitude(),
        );
    }
    return uniforms.gains[0].sensor_fault_input;
}

fn is_attitude() -> bool {
    return own.channel >= FIRST_ATTITUDE;
}

// What the observer starts from: ehat = y(0) - C0 r(0) and no faults.
fn channel_gains_measured(integral: f32, error: f32, rate: f32, fault: f32) -> vec3<f32> {
    let b = sensor_fault_input();
    return vec3(integral, fma(fault, b.x, error), fma(fault, b.y, rate));
}

// u_fb = K ehat, (21).
fn feedback(stage: u32) -> f32 {
    let k = feedback_gains(0u);
    var sum = stepped_at(stage, OBSERVER) * k.x;
    sum = fma(stepped_at(stage, OBSERVER + 1u), k.y, sum);
    sum = fma(stepped_at(stage, OBSERVER + 2u), k.z, sum);
    if FTC {
        sum = fma(stepped_at(stage, OBSERVER + 3u), k.w, sum);
        sum = fma(stepped_at(stage, OBSERVER + 4u), feedback_gains(1u).x, sum);
    }
    return sum;
}

// Takes one stage of the channel's step: its derivative [e, e', e'', ehat' of (20)].
//
// `applied_feedback` is the feedback of which the observer learns that it was commanded.
// `off` is by how much x and x' are measured too large, beside f2.
fn step_channel(stage: u32, error_acceleration: f32, sensor_fault: f32, off: vec2<f32>, applied_feedback: f32) {
    let b = sensor_fault_input();
    let s = smoothing();
    let integral = stepped_at(stage, 0u);
    let error = stepped_at(stage, 1u);
    let rate = stepped_at(stage, 2u);
    let error_hat = stepped_at(stage, OBSERVER + 1u);
    let rate_hat = stepped_at(stage, OBSERVER + 2u);
    var unexplained = sensor_fault;
    if FTC {
        unexplained = sensor_fault - stepped_at(stage, OBSERVER + 5u);
    }
    let seen_error = error + off.x;
    let seen_rate = rate + off.y;
    // y - yhat of (20); C0 r cancels.
    let innovation = vec3(
        integral - stepped_at(stage, OBSERVER),
        fma(unexplained, b.x, seen_error - error_hat),
        fma(unexplained, b.y, seen_rate - rate_hat),
    );
    var integrand = error;
    if MEASURED_INTEGRAL {
        integrand = fma(sensor_fault, b.x, seen_error);
    }
    stepped_take(stage, 0u, integrand);
    stepped_take(stage, 1u, rate);
    stepped_take(stage, 2u, error_acceleration);
    var row = injected(0u, innovation, error_hat);
    stepped_take(stage, OBSERVER, row);
    row = injected(1u, innovation, rate_hat);
    stepped_take(stage, OBSERVER + 1u, row);
    if FTC {
        let f1 = stepped_at(stage, OBSERVER + 3u);
        let f1_before = stepped_at(stage, OBSERVER + 4u);
        row = injected(2u, innovation, f1) + applied_feedback;
        stepped_take(stage, OBSERVER + 2u, row);
        row = injected(3u, innovation, fma(f1, s.x, f1_before * s.y));
        stepped_take(stage, OBSERVER + 3u, row);
        row = injected(4u, innovation, (f1 - f1_before) * s.z);
        stepped_take(stage, OBSERVER + 4u, row);
        let f2 = stepped_at(stage, OBSERVER + 5u);
        let f2_before = stepped_at(stage, OBSERVER + 6u);
        row = injected(5u, innovation, fma(f2, s.x, f2_before * s.y));
        stepped_take(stage, OBSERVER + 5u, row);
        row = injected(6u, innovation, (f2 - f2_before) * s.z);
        stepped_take(stage, OBSERVER + 6u, row);
    } else {
        row = injected(2u, innovation, applied_feedback);
        stepped_take(stage, OBSERVER + 2u, row);
    }
}

// base - L (y - yhat), one row.
fn injected(row: u32, innovation: vec3<f32>, base: f32) -> f32 {
    let gains = injection(row);
    var sum = fma(innovation.x, gains.x, base);
    sum = fma(innovation.y, gains.y, sum);
    return fma(innovation.z, gains.z, sum);
}

// The estimates of f1 and f2; a PID has none and is taken to estimate zero.
fn fault_estimates() -> vec2<f32> {
    if FTC {
        return vec2(stepped_start[OBSERVER + 3u], stepped_start[OBSERVER + 5u]);
    }
    return vec2(0.0);
}
