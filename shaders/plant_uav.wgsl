// Twin of src/model/plant/uav.rs: the UAV of (3) with the feedforward law (9). One invocation answers for one channel;
// what it needs of its agent's other channels they have published (`seen`).

// Constants of the plant; those that a plant does not use are zero.
struct Uav {
    mass: f32,
    inverse_mass: f32,
    drag: f32,
    gravity: f32,
    inertia: vec4<f32>,
    inverse_inertia: vec4<f32>,
    // (J_k - J_j) / J_i of the gyroscopic torque.
    gyro: vec4<f32>,
    angular_drag: f32,
    filter_rad_s: f32,
    max_thrust: f32,
    max_torque: f32,
    max_tilt: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

alias Plant = Uav;

// What a channel of attitude takes of them, as own.plant.
struct ChannelPlant {
    // Modelled inertia, its reciprocal, and (J_k - J_j) / J_i.
    inertia: f32,
    inverse_inertia: f32,
    gyro: f32,
}

fn channel_plant() -> ChannelPlant {
    if PLANT == AXIS || PLANT == TRANSLATION {
        return ChannelPlant(0.0, 0.0, 0.0);
    }
    let i = (uniforms.first_channel + own.channel) % 3u;
    return ChannelPlant(uniforms.plant.inertia[i], uniforms.plant.inverse_inertia[i], uniforms.plant.gyro[i]);
}

// The reference of the channel and its rate: (r, r'). Under thrust, roll and pitch follow the command filter.
fn reference(stage: u32, row: vec4<f32>) -> vec2<f32> {
    if PLANT == THRUST && (own.channel == 3u || own.channel == 4u) {
        return vec2(stepped_at(stage, EXTRA), stepped_at(stage, EXTRA + 1u));
    }
    return row.xy;
}

// Shows the other channels of the group what they need of this one. Under thrust, a channel of translation shows
// [x, demand, and what is between demanded and acting command].
fn publish_channel(stage: u32, inputs: Inputs) {
    publish(stage, POSITION, inputs.position);
    if PLANT == ATTITUDE {
        publish(stage, VELOCITY, inputs.velocity);
    }
    if PLANT == THRUST {
        if own.channel < 3u {
            publish(stage, COMMAND_BIAS, actuator.bias);
            publish(stage, DEMAND, fma(inputs.feedback, uniforms.plant.mass, inputs.reference.row.w));
            publish(stage, COMMAND_GAIN, actuator.gain);
            publish(stage, COMMAND_LOW, actuator.low);
            publish(stage, COMMAND_HIGH, actuator.high);
            if N_DEAD_ZONES > 0u {
                publish(stage, COMMAND_DEAD_ZONE, actuator.dead_zone);
            }
        } else {
            let r = reference(stage, inputs.reference.row);
            publish(stage, VELOCITY, inputs.velocity);
            publish(stage, REFERENCE, r.x);
            publish(stage, REFERENCE_RATE, r.y);
        }
    }
}

fn respond(stage: u32, inputs: Inputs) -> Response {
    if PLANT == AXIS {
        return axis_respond(inputs, uniforms.plant.gravity);
    }
    if PLANT == TRANSLATION {
        return axis_respond(inputs, select(0.0, uniforms.plant.gravity, own.channel == HEIGHT));
    }
    if PLANT == ATTITUDE {
        return attitude_respond(stage, inputs);
    }
    return thrust_respond(stage, inputs);
}

// An axis along which gravity pulls by as much.
fn axis_respond(inputs: Inputs, gravity: f32) -> Response {
    let sent = fma(inputs.feedback, uniforms.plant.mass, inputs.reference.row.w);
    let command = actuator_command(sent);
    let force = fma(inputs.velocity, -uniforms.plant.drag, command + inputs.force);
    let offset = inputs.reference.row.z + gravity;
    let error_acceleration = fma(force, inverse_inertia, -offset);
    return Response(error_acceleration, inputs.feedback, sent, command, 0.0, vec2(0.0));
}

// Theta'' under a torque per true inertia, (3); the attitude begins with channel `first` of the group.
fn attitude_acceleration(stage: u32, first: u32, torque: f32, rate: f32) -> f32 {
    let i = own.channel - first;
    let net = fma(rate, -uniforms.plant.angular_drag, torque);
    let gyroscopic = seen(stage, VELOCITY, first + (i + 1u) % 3u) * seen(stage, VELOCITY, first + (i + 2u) % 3u);
    return fma(gyroscopic, -own.plant.gyro, net * inverse_inertia);
}

fn attitude_respond(stage: u32, inputs: Inputs) -> Response {
    let sent = fma(inputs.feedback, own.plant.inertia, inputs.reference.row.w);
    let command = actuator_command(sent);
    let torque = command + inputs.force;
    let acceleration = attitude_acceleration(stage, 0u, torque, inputs.velocity);
    return Response(acceleration - inputs.reference.row.z, inputs.feedback, sent, command, 0.0, vec2(0.0));
}

// R(Theta) [0 0 1]', (3).
fn body_axis(roll: f32, pitch: f32, yaw_sin_cos: vec2<f32>) -> vec3<f32> {
    let sin_yaw = yaw_sin_cos.x;
    let cos_yaw = yaw_sin_cos.y;
    let roll_sin_cos = sin_cos(roll);
    let pitch_sin_cos = sin_cos(pitch);
    let forward = pitch_sin_cos.x * roll_sin_cos.y;
    return vec3(
        fma(cos_yaw, forward, sin_yaw * roll_sin_cos.x),
        fma(sin_yaw, forward, -(cos_yaw * roll_sin_cos.x)),
        pitch_sin_cos.y * roll_sin_cos.y,
    );
}

fn thrust_respond(stage: u32, inputs: Inputs) -> Response {
    let roll = seen(stage, REFERENCE, 3u);
    let pitch = seen(stage, REFERENCE, 4u);
    let yaw = seen(stage, REFERENCE, 5u);

    // The force that the position loop demands, (9).
    let fx = seen(stage, DEMAND, 0u);
    let fy = seen(stage, DEMAND, 1u);
    let fz = seen(stage, DEMAND, 2u);
    let yaw_sin_cos = sin_cos(yaw);
    // Its direction in the frame turned by the yaw reference is that of the commanded body axis (Remark 11).
    let ahead = fma(yaw_sin_cos.y, fx, yaw_sin_cos.x * fy);
    let aside = fma(yaw_sin_cos.y, fy, -(yaw_sin_cos.x * fx));
    let upright = sqrt(fma(ahead, ahead, fz * fz));
    let roll_demanded = -atan2(aside, upright);
    let pitch_demanded = atan2(ahead, fz);
    let tilt = uniforms.plant.max_tilt;
    let roll_command = clamp(roll_demanded, -tilt, tilt);
    let pitch_command = clamp(pitch_demanded, -tilt, tilt);

    if own.channel < 3u {
        // Thrust: demanded, then limited; the acceleration that it can give is the applied feedback.
        let thrust_demanded = sqrt(fma(fx, fx, fma(fy, fy, fz * fz)));
        let thrust = clamp(thrust_demanded, 0.0, uniforms.plant.max_thrust);
        let commanded_axis = body_axis(roll, pitch, yaw_sin_cos);
        let excess = vec3(pitch_demanded - pitch_command, roll_demanded - roll_command, thrust_demanded - thrust);
        let applied_feedback = fma(thrust, commanded_axis[own.channel], -inputs.reference.row.w) * uniforms.plant.inverse_mass;

        // What the faults leave of the thrust acts along the true body axis.
        var arrived = fma(thrust, seen(stage, COMMAND_GAIN, 2u), seen(stage, COMMAND_BIAS, 2u));
        if N_DEAD_ZONES > 0u {
            arrived = beyond_dead_zone(arrived, seen(stage, COMMAND_DEAD_ZONE, 2u));
        }
        let applied = clamp(arrived, seen(stage, COMMAND_LOW, 2u), seen(stage, COMMAND_HIGH, 2u));
        let demand = seen(stage, DEMAND, own.channel);
        let sent = select(demand, thrust, own.channel == 2u);
        let command = fma(demand, actuator.gain, actuator.bias);
        let true_yaw = seen(stage, POSITION, 5u);
        let true_axis = body_axis(seen(stage, POSITION, 3u), seen(stage, POSITION, 4u), sin_cos(true_yaw));
        var net = fma(applied, true_axis[own.channel], inputs.force);
        net = fma(inputs.velocity, -uniforms.plant.drag, net);
        let gravity = select(0.0, uniforms.plant.gravity, own.channel == 2u);
        let offset = inputs.reference.row.z + gravity;
        let error_acceleration = fma(net, inverse_inertia, -offset);
        return Response(error_acceleration, applied_feedback, sent, command, excess[own.channel], vec2(0.0));
    }

    let i = own.channel - 3u;
    // Critically damped command filter: q'' = w^2 (command - q) - 2 w q'.
    let w = uniforms.plant.filter_rad_s;
    let roll_rate = seen(stage, REFERENCE_RATE, 3u);
    let pitch_rate = seen(stage, REFERENCE_RATE, 4u);
    let roll_acceleration = (w * (roll_command - roll) - (roll_rate + roll_rate)) * w;
    let pitch_acceleration = (w * (pitch_command - pitch) - (pitch_rate + pitch_rate)) * w;

    // Torques: demanded along the filtered attitude, then limited.
    let rates = vec3(roll_rate, pitch_rate, seen(stage, REFERENCE_RATE, 5u));
    let accelerations = vec3(roll_acceleration, pitch_acceleration, inputs.reference.row.z);
    let limit = uniforms.plant.max_torque;
    let inertia = own.plant.inertia;
    let gyroscopic = rates[(i + 1u) % 3u] * rates[(i + 2u) % 3u] * own.plant.gyro;
    let non_inertial = fma(gyroscopic, inertia, rates[i] * uniforms.plant.angular_drag);
    let demanded = fma(accelerations[i] + inputs.feedback, inertia, non_inertial);
    let limited = clamp(demanded, -limit, limit);
    let applied_feedback = fma(limited - non_inertial, own.plant.inverse_inertia, -accelerations[i]);
    let command = actuator_command(limited);
    let torque = command + inputs.force;
    let angular = attitude_acceleration(stage, 3u, torque, inputs.velocity);
    let extra_rate = vec2(rates[i], accelerations[i]);
    return Response(angular - accelerations[i], applied_feedback, limited, command, demanded - limited, extra_rate);
}
