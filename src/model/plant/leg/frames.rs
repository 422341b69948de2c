//! The constants of a leg: its description in the frames that the dynamics use, and its mass moved towards the pelvis.

use super::parameters::{Build, Joint, LEG_JOINTS, LegJoint, LegModel, Twist};
use crate::model::lanes::Real;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Axes this close to parallel or to a right angle are taken as such, rad: robot descriptions round to 1e-12.
const ALIGNED: f64 = 1e-9;

/// A link: where its frame lies in that of the link before, and its mass about its own origin.
struct Link {
    rotation: Rotation3<f64>,
    origin: Vector3<f64>,
    mass: f64,
    /// int r dm.
    first: Vector3<f64>,
    /// int r r' dm.
    second: Matrix3<f64>,
}

impl<R: Real> LegModel<R> {
    /// The leg with these joints, pelvis first, under `gravity_m_s2` in the pelvis frame.
    #[must_use]
    pub fn new(leg: &[LegJoint; LEG_JOINTS], gravity_m_s2: Vector3<f64>) -> Self {
        let mut links = along_axes(leg);
        // Whatever turns the pelvis about the first axis goes into the first angle: gravity lies in the plane of x and
        // z.
        let gravity = links[0].rotation.inverse() * gravity_m_s2;
        let mut offset = [0.0; LEG_JOINTS];
        offset[0] = -gravity.y.atan2(gravity.x);
        let (mut angle, mut twists) = ([0.0; LEG_JOINTS], [Twist::Any; LEG_JOINTS]);
        for j in 1..LEG_JOINTS {
            let (before, twist, after) = links[j].angles();
            links[j - 1].turn(before);
            links[j].origin = z_turn(-before) * links[j].origin;
            (angle[j], twists[j]) = (twist, classify(twist));
            offset[j - 1] += before;
            offset[j] += after;
            let slide = links[j].slide(twist);
            if let Some(next) = links.get_mut(j + 1) {
                next.origin.z -= slide;
            }
        }
        for j in (1..LEG_JOINTS).rev() {
            let moved = links[j].give_up_axis(angle[j]);
            links[j - 1].mass += moved.mass;
            links[j - 1].first += moved.first;
            links[j - 1].second += moved.second;
        }
        let joints = std::array::from_fn(|j| {
            let (link, second) = (&links[j], links[j].second);
            let (sine, cosine) = match twists[j] {
                Twist::Parallel => (0.0, 1.0),
                Twist::Right => (1.0, 0.0),
                Twist::Any => angle[j].sin_cos(),
            };
            let entries = [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2)];
            Joint {
                offset: R::from_f64(offset[j]),
                armature: R::from_f64(leg[j].armature_kg_m2),
                damping: R::from_f64(leg[j].damping_n_m_s),
                twist: [sine, cosine].map(R::from_f64),
                lever: link.origin.map(R::from_f64).into(),
                lever_twice: (2.0 * link.origin).map(R::from_f64).into(),
                first: [link.first.x, link.first.y].map(R::from_f64),
                second: entries.map(|entry| R::from_f64(second[entry])),
            }
        });
        let [.., tip] = &links;
        let polar = tip.second[(0, 0)] + tip.second[(1, 1)];
        Self {
            joints,
            lift: [-gravity.x.hypot(gravity.y), -gravity.z].map(R::from_f64),
            tip_inverse: R::from_f64(1.0 / (polar + leg[LEG_JOINTS - 1].armature_kg_m2)),
            build: Build::of(&twists),
        }
    }
}

impl Build {
    fn of(twists: &[Twist; LEG_JOINTS]) -> Self {
        [Self::PitchFirst, Self::PitchLast]
            .into_iter()
            .find(|build| build.twists()[1..] == twists[1..])
            .unwrap_or(Self::Any)
    }
}

/// The links with frames whose z axes are the joints' axes, and inertia about the frames' origins.
fn along_axes(leg: &[LegJoint; LEG_JOINTS]) -> [Link; LEG_JOINTS] {
    let frames = leg.clone().map(|joint| frame_along(joint.axis));
    std::array::from_fn(|j| {
        let (joint, own) = (&leg[j], frames[j]);
        let before = match j {
            0 => Rotation3::identity(),
            _ => frames[j - 1],
        };
        let com = own.inverse() * joint.com_m;
        let inertia = own.inverse() * joint.inertia_kg_m2 * own;
        let about_com = Matrix3::from_diagonal_element(inertia.trace() / 2.0) - inertia;
        Link {
            rotation: before.inverse() * joint.rotation * own,
            origin: before.inverse() * joint.translation_m,
            mass: joint.mass_kg,
            first: com * joint.mass_kg,
            second: about_com + com * com.transpose() * joint.mass_kg,
        }
    })
}

/// A frame whose z axis is this one.
fn frame_along(axis: Vector3<f64>) -> Rotation3<f64> {
    let z = axis.normalize();
    let across = Vector3::ith(z.iamin(), 1.0);
    let x = (across - z * z.dot(&across)).normalize();
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

fn z_turn(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

fn classify(twist: f64) -> Twist {
    if twist.sin().abs() < ALIGNED && twist.cos() > 0.0 {
        Twist::Parallel
    } else if twist.cos().abs() < ALIGNED {
        Twist::Right
    } else {
        Twist::Any
    }
}

impl Link {
    /// The rotation as turns about z before and after a twist about x. Between parallel axes only the sum of the turns
    /// matters, and the first takes the origin to the x axis; near them, what is lost in one turn the other makes up
    /// for.
    fn angles(&self) -> (f64, f64, f64) {
        let r = self.rotation.matrix();
        let before = match classify(r.m13.hypot(r.m23).atan2(r.m33)) {
            Twist::Parallel => self.origin.y.atan2(self.origin.x),
            Twist::Right | Twist::Any => r.m13.atan2(-r.m23),
        };
        let left = z_turn(-before) * self.rotation;
        let left = left.matrix();
        (
            before,
            (-left.m23).atan2(left.m33),
            (-left.m12).atan2(left.m11),
        )
    }

    /// Turns the frame about its z axis.
    fn turn(&mut self, angle: f64) {
        let inverse = z_turn(-angle);
        self.first = inverse * self.first;
        self.second = inverse * self.second * inverse.inverse();
    }

    /// Slides the origin along z, so that the lever has two components, and tells how far.
    fn slide(&mut self, twist: f64) -> f64 {
        let (sine, cosine) = twist.sin_cos();
        let slide = if sine > 0.5 {
            self.origin.y / sine
        } else {
            -self.origin.z / cosine
        };
        self.origin += slide * Vector3::new(0.0, -sine, cosine);
        if sine > 0.5 {
            self.origin.y = 0.0;
        } else {
            self.origin.z = 0.0;
        }
        let shift = Vector3::new(0.0, 0.0, -slide);
        let crossed = self.first * shift.transpose();
        self.second += crossed + crossed.transpose() + self.mass * shift * shift.transpose();
        self.first += self.mass * shift;
        slide
    }

    /// Takes what lies on the z axis out of the link, and puts it into the frame of the link before.
    fn give_up_axis(&mut self, twist: f64) -> Moments {
        let axis = Vector3::new(0.0, -twist.sin(), twist.cos());
        let (mass, along, along_second) = (self.mass, self.first.z, self.second.m33);
        let crossed = self.origin * axis.transpose() * along;
        self.mass = 0.0;
        self.first.z = 0.0;
        self.second.m33 = 0.0;
        Moments {
            mass,
            first: mass * self.origin + along * axis,
            second: along_second * axis * axis.transpose()
                + crossed
                + crossed.transpose()
                + mass * self.origin * self.origin.transpose(),
        }
    }
}

/// Mass and its moments.
struct Moments {
    mass: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}
