//! Stiffness and damping of the contacts of a state and of the applied force, as matrices.

use crate::contact::{Contact, Motion};
use crate::force::Force;
use crate::friction::{FrictionJacobian, Metric, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, ForceDerivatives, size};
use crate::state::State;

use super::matrix::Matrix;

/// Response of the contacts of a state to a small displacement and a small velocity, as
/// accelerations.
pub(super) struct Response<R> {
    /// `M⁻¹ K`, 1/s².
    pub(super) stiffness: Matrix<R>,
    /// `M⁻¹ C`, 1/s.
    pub(super) damping: Matrix<R>,
}

impl<R: Real> Response<R> {
    pub(super) fn at<D: Dynamics<R>>(scene: &D, state: &State<R>) -> Self {
        let motion = scene.motion(state);
        let frame = Frame {
            scene,
            motion: &motion,
            length: size(scene),
        };
        let mut response = Self {
            stiffness: Matrix::ZERO,
            damping: Matrix::ZERO,
        };
        scene.visit_contacts(&motion, |contact| response.add(&frame, contact));
        if scene.force().acts() {
            response.add_applied_force(&frame);
        }
        response
    }

    /// Adds a contact.
    fn add<D: Dynamics<R>>(&mut self, frame: &Frame<'_, R, D>, contact: &Contact<R>) {
        let normal = contact.normal;
        let (ground, friction_law) = contact.laws(frame.scene.ground(), frame.scene.friction());
        let load = ground.normal_force(contact.depth, contact.closing_speed);
        let jacobian = jacobian_at(&friction_law, load, contact);
        let pushed = normal + friction_by_load(&friction_law, contact, &jacobian);
        let answer = frame.acceleration(pushed, contact.arm.cross(pushed));
        let row = frame.row(normal, contact.arm.cross(normal));
        let [k, c] =
            slopes(&ground, contact, dot(&answer, &row)).map(|slope| slope * contact.weight);
        self.stiffness.add_outer(k, &answer, &row);
        self.damping.add_outer(c, &answer, &row);

        let speed = contact.slip_velocity.length();
        let [along, across] = tangents(normal, contact.slip_velocity, speed);
        let shares = friction_shares(&friction_law, contact, &jacobian, [along, across]);
        for (direction, share) in [along, across].into_iter().zip(shares) {
            let damping = jacobian.coefficient * contact.weight * share;
            self.add_damper(frame, direction, contact.arm.cross(direction), damping);
        }
        self.add_turning(frame, contact, (&friction_law, load), [along, across]);
    }

    /// Adds a damper of friction along a direction with the given moment about the centre of mass.
    fn add_damper<D: Dynamics<R>>(
        &mut self,
        frame: &Frame<'_, R, D>,
        direction: R::Vec3,
        moment: R::Vec3,
        damping: R,
    ) {
        let answer = frame.acceleration(direction, moment);
        (self.damping).add_outer(damping, &answer, &frame.row(direction, moment));
    }

    /// Adds rolling resistance and spinning friction, if the friction law has them.
    fn add_turning<D: Dynamics<R>>(
        &mut self,
        frame: &Frame<'_, R, D>,
        contact: &Contact<R>,
        (law, load): (&impl SlidingFriction<R>, R),
        tangents: [R::Vec3; 2],
    ) {
        let Some(resistance) = law.rolling_resistance_at(contact.position, load) else {
            return;
        };
        let seen = frame.scene.contact_model().seen(frame.motion);
        let spin = seen.angular_velocity;
        let about = spin.dot(contact.normal);
        let rolling = (spin - contact.normal * about).length();
        let [per_rolling, per_spinning] = resistance.per_turn(rolling, about.abs());
        self.add_damper(
            frame,
            R::Vec3::ZERO,
            contact.normal,
            per_spinning * contact.weight,
        );
        for axis in tangents {
            self.add_damper(frame, R::Vec3::ZERO, axis, per_rolling * contact.weight);
        }
    }

    /// Adds the stiffness and the damping of the applied force.
    fn add_applied_force<D: Dynamics<R>>(&mut self, frame: &Frame<'_, R, D>) {
        let force = ForceDerivatives::at(frame.scene, frame.motion);
        for (index, [shift, turn]) in frame.columns().into_iter().enumerate() {
            let per_speed = force.along_velocity(shift, turn);
            let per_path = force.along_path(shift, turn);
            for (matrix, change) in [
                (&mut self.damping, per_speed),
                (&mut self.stiffness, per_path),
            ] {
                let answer = frame.acceleration(-change.force, -change.torque);
                matrix.add_column(index, &answer);
            }
        }
    }
}

/// Coordinates of a small displacement: translation, and rotation multiplied by a length, both in
/// m.
struct Frame<'a, R: Real, D> {
    scene: &'a D,
    motion: &'a Motion<R>,
    length: R,
}

impl<R: Real, D: Dynamics<R>> Frame<'_, R, D> {
    /// Displacement along a direction with the given moment about the centre of mass.
    fn row(&self, direction: R::Vec3, moment: R::Vec3) -> [R; 6] {
        let per_length = if self.length > R::ZERO {
            R::ONE / self.length
        } else {
            R::ZERO
        };
        joined(direction, moment * per_length)
    }

    /// Acceleration due to a force and a torque.
    fn acceleration(&self, force: R::Vec3, torque: R::Vec3) -> [R; 6] {
        let mass = self.scene.inertia_properties();
        let spin = mass.angular_velocity(&self.motion.axes, torque);
        joined(force * mass.inverse_mass(), spin * self.length)
    }

    /// Translation (m) and rotation (rad) of each coordinate for 1 m.
    fn columns(&self) -> [[R::Vec3; 2]; 6] {
        let (o, one) = (R::ZERO, R::ONE);
        let turn = if self.length > o {
            one / self.length
        } else {
            o
        };
        let axes = |size: R| {
            [
                R::Vec3::new(size, o, o),
                R::Vec3::new(o, size, o),
                R::Vec3::new(o, o, size),
            ]
        };
        let ([x, y, z], [a, b, c]) = (axes(one), axes(turn));
        let none = R::Vec3::ZERO;
        [
            [x, none],
            [y, none],
            [z, none],
            [none, a],
            [none, b],
            [none, c],
        ]
    }
}

fn joined<R: Real>(a: R::Vec3, b: R::Vec3) -> [R; 6] {
    [a.x(), a.y(), a.z(), b.x(), b.y(), b.z()]
}

fn dot<R: Real>(a: &[R; 6], b: &[R; 6]) -> R {
    (a.iter().zip(b)).fold(R::ZERO, |sum, (&a, &b)| sum + a * b)
}

/// Derivatives of the normal force of a contact with respect to depth (N/m) and closing speed (N
/// s/m), by central differences.
///
/// The width of the differences is `ε^(3/8)` of the depth, 1.4e-6 in f64 and 2.5e-3 in f32. The
/// relative error of a derivative is `ε^(5/8)` from rounding and `ε^(3/4)` from curvature. The unit
/// of speed is the depth times the natural frequency of the contact, at which spring and damper
/// have equal weight.
fn slopes<R: Real, G: SpringDamperGround<R>>(
    ground: &G,
    contact: &Contact<R>,
    inverse_mass: R,
) -> [R; 2] {
    let root = R::EPSILON.sqrt();
    let nudge = (root * root.sqrt()).sqrt();
    let (depth, speed) = (contact.depth, contact.closing_speed);
    let slope = |low: R, high: R, width: R| {
        if width > R::ZERO {
            ((high - low) / (width + width)).at_least(R::ZERO)
        } else {
            R::ZERO
        }
    };
    let width = depth * nudge;
    let at_depth = |depth| ground.normal_force(depth, speed);
    let stiffness = slope(at_depth(depth - width), at_depth(depth + width), width);
    let natural = depth * (stiffness * inverse_mass).at_least(R::ZERO).sqrt();
    let width = (speed.abs() + natural) * nudge;
    let at_speed = |speed| ground.normal_force(depth, speed);
    let damping = if width > R::ZERO {
        slope(at_speed(speed - width), at_speed(speed + width), width)
    } else {
        // A damper without a spring, at rest. It only pushes, against any speed of approach.
        ((at_speed(nudge) - at_speed(R::ZERO)) / nudge).at_least(R::ZERO)
    };
    [stiffness, damping]
}

/// Jacobian of the friction law at a contact. If a law returns none at zero slip, the Jacobian at
/// 1e-12 m/s is used.
fn jacobian_at<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    load: R,
    contact: &Contact<R>,
) -> FrictionJacobian<R> {
    let jacobian = friction.jacobian_at(contact.position, load, contact.slip_velocity);
    if jacobian.coefficient > R::ZERO || contact.slip_velocity != R::Vec3::ZERO {
        return jacobian;
    }
    let [direction, _] = tangents(contact.normal, contact.slip_velocity, R::ZERO);
    friction.jacobian_at(contact.position, load, direction * R::from_f64(1e-12))
}

/// Derivative of the friction force with respect to its load, dimensionless.
fn friction_by_load<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    contact: &Contact<R>,
    jacobian: &FrictionJacobian<R>,
) -> R::Vec3 {
    let slip = contact.slip_velocity;
    let metric = Metric::of(friction, contact.position, slip);
    metric.map_or(slip, |metric| metric.along_friction(slip)) * -jacobian.per_load
}

/// Derivative of the friction along the slip and across it, relative to its coefficient.
///
/// In a law that is not isotropic, the coupling of the two directions counts for both: the sum of
/// the magnitudes in a row is an upper bound of an eigenvalue.
fn friction_shares<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    contact: &Contact<R>,
    jacobian: &FrictionJacobian<R>,
    [along, across]: [R::Vec3; 2],
) -> [R; 2] {
    let slip = contact.slip_velocity;
    let Some(metric) = Metric::of(friction, contact.position, slip) else {
        let weakening = jacobian.growth * slip.length() / jacobian.width;
        return [(R::ONE - weakening).at_least(R::ZERO), R::ONE];
    };
    let [x, y, z] = metric.derivative(jacobian, slip);
    let times = |v: R::Vec3| x * v.x() + y * v.y() + z * v.z();
    let coupling = along.dot(times(across)).abs();
    [along, across].map(|direction| (direction.dot(times(direction)) + coupling).at_least(R::ZERO))
}

/// Two unit vectors along the surface, the first along the slip if the slip is not zero.
fn tangents<R: Real>(normal: R::Vec3, slip: R::Vec3, speed: R) -> [R::Vec3; 2] {
    let along = if speed > R::ZERO {
        slip * (R::ONE / speed)
    } else {
        let (o, one) = (R::ZERO, R::ONE);
        let steep = normal.z().abs() > R::HALF;
        let other = if steep {
            R::Vec3::new(one, o, o)
        } else {
            R::Vec3::new(o, o, one)
        };
        let along = normal.cross(other);
        along * (R::ONE / along.length())
    };
    [along, normal.cross(along)]
}
