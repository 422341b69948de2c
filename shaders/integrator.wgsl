// Twin of src/model/integrator.rs: the classical fourth-order Runge-Kutta method (Hairer, Norsett, Wanner, Solving ODEs
// I, section II.1), with the weighted sum of the slopes kept instead of the slopes themselves.

// A state while a step is taken: at its start, at the point where the current stage's slope is taken, and
// start + h/6 (k1 + 2 k2 + ..), as far as the stages went.
var<private> stepped_start: array<f32, STATES>;
var<private> stepped_point: array<f32, STATES>;
var<private> stepped_sum: array<f32, STATES>;

// h/6, h/3, h/2 and h of a step h.
struct Step {
    sixth: f32,
    third: f32,
    half: f32,
    whole: f32,
}

// Number `k` of the state whose slope stage `stage` (0 to 3) takes.
fn stepped_at(stage: u32, k: u32) -> f32 {
    if stage == 0u {
        return stepped_start[k];
    }
    return stepped_point[k];
}

// Takes in the slope of state `k` at a stage; the last stage ends the step.
fn stepped_take(stage: u32, k: u32, slope: f32) {
    let h = uniforms.h;
    let ahead = select(h.whole, h.half, stage < 2u);
    switch stage {
        case 0u: {
            stepped_sum[k] = fma(slope, h.sixth, stepped_start[k]);
            stepped_point[k] = fma(slope, ahead, stepped_start[k]);
        }
        case 1u, 2u: {
            stepped_sum[k] = fma(slope, h.third, stepped_sum[k]);
            stepped_point[k] = fma(slope, ahead, stepped_start[k]);
        }
        default: {
            stepped_start[k] = fma(slope, h.sixth, stepped_sum[k]);
        }
    }
}
