// Twin of src/model/plant/mod.rs: what every plant is asked and answers. A plant's own file says of what constants it
// is made (`Plant`), what a channel takes of them (`ChannelPlant`, `channel_plant`), what its reference is
// (`reference`), what it shows to the channels that it acts on (`publish_channel`), and how it answers (`respond`).

// The channel's reference at one instant.
struct Reference {
    // r, r', r'' and the feedforward M r'' + H(r, r') of (9).
    row: vec4<f32>,
    // Where in the table this row is; a plant that needs more finds it after it.
    place: u32,
}

// What acts on the channel at one instant.
struct Inputs {
    reference: Reference,
    // u_fb of (21).
    feedback: f32,
    // x and x'.
    position: f32,
    velocity: f32,
    // c + d1 of (12).
    force: f32,
}

// How the channel answers.
struct Response {
    // x'' - r''.
    error_acceleration: f32,
    // The feedback that was really commanded, after filter and limits, before any fault.
    applied_feedback: f32,
    // The command u of (9) after limits, as it sets out.
    sent: f32,
    // The command that acts, after faults.
    command: f32,
    // By how much the limits cut the command.
    excess: f32,
    // Derivative of the plant's own states of the channel.
    extra_rate: vec2<f32>,
}
