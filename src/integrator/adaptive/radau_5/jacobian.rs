//! The Jacobian of the equations of motion, from the derivatives of the contact and friction laws.
//!
//! Coordinates near a state are a shift ξ (m), a rotation ϑ (rad, world axes), and changes of the
//! velocity v, of the angular momentum L, and of the length s of the quaternion. With the inverse
//! inertia W in world axes and `ω = W L`:
//!
//! ```text
//! ξ' = δv        ϑ' = ω × ϑ/2 + ω s + δω        s' = -ω·ϑ/4        m δv' = δF        δL' = δT
//! δω = W δL + ϑ × ω - W (ϑ × L)
//! ```
//! ϑ/2 and s are the vector and the scalar of the change of the quaternion times its inverse, and a
//! quaternion changes at the rate `ω q/2`. With s a uniform rotation has linear equations, so that
//! a step may rotate the body by a radian at no further iteration.
//!
//! The force F of a contact at the arm r depends on its path and on its velocity:
//!
//! ```text
//! δF = P (ξ + M ϑ) + Q (δv + δω × r + ω × M ϑ)        δT = r × δF + M ϑ × F
//! P = -k (n + f) nᵀ        Q = -c (n + f) nᵀ + D (1 - n nᵀ)
//! ```
//! `M ϑ` is the displacement of r by a rotation. `k` and `c` are the derivatives of the normal
//! force with respect to depth and closing speed, `f` is the derivative of friction with respect to
//! the normal force, and `D` that with respect to the slip. On ground that turns at Ω, the velocity
//! of the ground below the contact changes by `Ω × (ξ + M ϑ)`, which the slip does not contain.
//!
//! [`Curved`] ground adds what follows from the rotation of the normal.
//!
//! An applied force with the wrench W adds `∂W/∂ξ`, `∂W/∂ϑ`, `∂W/∂v` and `∂W/∂ω`, by differences.
//!
//! The Jacobian only steers the iteration: an error in it costs iterations, not accuracy.

use super::curvature::Curved;
use super::linear::Rows;
use crate::contact::{Contact, Motion};
use crate::force::{Force, Wrench};
use crate::friction::{FrictionJacobian, Metric, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, ForceDerivatives, size};

/// The Jacobian, by its blocks that are not 0 or 1. The rates of the velocities are six rows, those
/// of v and of L.
pub(super) struct Jacobian<R: Real> {
    /// Angular velocity ω, rad/s.
    pub(super) spin: [R; 3],
    /// Derivatives of `ϑ'` with respect to the rotation, and to L.
    pub(super) turning: [Rows<R, 3, 3>; 2],
    /// Derivatives of `v'` and `L'` with respect to the shift.
    pub(super) by_shift: Rows<R, 6, 3>,
    /// Derivatives of `v'` and `L'` with respect to the rotation.
    pub(super) by_turn: Rows<R, 6, 3>,
    /// Derivatives of `v'` and `L'` with respect to v and L.
    pub(super) by_rates: Rows<R, 6, 6>,
    /// Smallest width of the friction of all contacts, m/s.
    pub(super) width: R,
}

impl<R: Real> Jacobian<R> {
    /// Computes the Jacobian at a motion with an angular momentum.
    pub(super) fn at<D: Dynamics<R>>(
        scene: &D,
        motion: &Motion<R>,
        angular_momentum: R::Vec3,
    ) -> Self {
        let mut load = Derivatives::of_contacts(scene, motion);
        if scene.force().acts() {
            scene.probe(|| load.add_applied_force(&ForceDerivatives::at(scene, motion)));
        }
        let properties = scene.inertia_properties();
        let inverse = of_columns(|axis| properties.angular_velocity(&motion.axes, axis));
        // Derivative of the angular velocity with respect to a rotation.
        let by_turn = of_columns::<R>(|axis| {
            let turned = properties.angular_velocity(&motion.axes, axis.cross(angular_momentum));
            axis.cross(motion.angular_velocity) - turned
        });
        let turning = Matrix3::hat(motion.angular_velocity * R::HALF).plus(&by_turn);
        let [force, torque] = [
            (load.force, properties.inverse_mass()),
            (load.torque, R::ONE),
        ]
        .map(|(part, scale)| Part {
            shift: part.shift.scaled(scale),
            turn: (part.turn.plus(&part.spin.times_matrix(&by_turn))).scaled(scale),
            velocity: part.velocity.scaled(scale),
            spin: part.spin.times_matrix(&inverse).scaled(scale),
        });
        let spin = motion.angular_velocity;
        Self {
            spin: [spin.x(), spin.y(), spin.z()],
            turning: [rows(&turning), rows(&inverse)],
            by_shift: below(rows(&force.shift), rows(&torque.shift)),
            by_turn: below(rows(&force.turn), rows(&torque.turn)),
            by_rates: below(
                beside(rows(&force.velocity), rows(&force.spin)),
                beside(rows(&torque.velocity), rows(&torque.spin)),
            ),
            width: load.width,
        }
    }
}

/// Derivatives of a force or a torque with respect to shift, rotation, velocity and angular
/// velocity.
struct Part<R: Real> {
    shift: Matrix3<R>,
    turn: Matrix3<R>,
    velocity: Matrix3<R>,
    spin: Matrix3<R>,
}

impl<R: Real> Part<R> {
    const ZERO: Self = Self {
        shift: Matrix3::ZERO,
        turn: Matrix3::ZERO,
        velocity: Matrix3::ZERO,
        spin: Matrix3::ZERO,
    };

    fn add(&mut self, other: &Self) {
        self.shift = self.shift.plus(&other.shift);
        self.turn = self.turn.plus(&other.turn);
        self.velocity = self.velocity.plus(&other.velocity);
        self.spin = self.spin.plus(&other.spin);
    }
}

/// Derivatives of the load of all contacts and of the applied force.
struct Derivatives<R: Real> {
    force: Part<R>,
    torque: Part<R>,
    width: R,
}

impl<R: Real> Derivatives<R> {
    fn of_contacts<D: Dynamics<R>>(scene: &D, motion: &Motion<R>) -> Self {
        let mut sum = Self {
            force: Part::ZERO,
            torque: Part::ZERO,
            width: R::MAX,
        };
        let seen = scene.contact_model().seen(motion);
        let table = motion.angular_velocity - seen.angular_velocity;
        scene.visit_contacts(motion, |contact| {
            sum.add(scene, (&seen, table), contact);
        });
        sum
    }

    /// Adds a contact, with the motion as the ground sees it and the ground's angular velocity.
    fn add<D: Dynamics<R>>(
        &mut self,
        scene: &D,
        (motion, table): (&Motion<R>, R::Vec3),
        contact: &Contact<R>,
    ) {
        let (arm, spin) = (contact.arm, motion.angular_velocity);
        let noise = rounding_of_slip(scene, motion);
        let ([by_path, by_velocity], width) = scene.probe(|| by_motion(scene, contact, noise));
        self.width = self.width.at_most(width);
        let [x, y, z] = contact.arm_by_turn(scene.body(), &motion.axes);
        let moved = Matrix3 { x, y, z };
        let swung = by_velocity.times_matrix(&Matrix3::hat(spin));
        let mut force = Part {
            shift: by_path,
            turn: by_path.plus(&swung).times_matrix(&moved),
            velocity: by_velocity,
            spin: by_velocity.times_matrix(&Matrix3::hat(-arm)),
        };
        if table != R::Vec3::ZERO {
            // A shift brings the contact to where the ground has another velocity.
            let carried = by_velocity.times_matrix(&Matrix3::hat(-table));
            force.shift = force.shift.plus(&carried);
        }
        let loaded = contact.force(scene.ground(), scene.friction());
        let curved = Curved::at(scene, contact, &moved);
        if let Some(curved) = &curved {
            let velocity = contact.slip_velocity - contact.normal * contact.closing_speed;
            let slid = by_velocity.times_matrix(&curved.rotated(-velocity));
            let by_shift = curved.rotated(loaded).plus(&slid);
            let by_shift = by_shift.plus(&swung.times_matrix(&curved.over));
            force.shift = force.shift.plus(&by_shift);
            force.turn = force.turn.plus(&by_shift.times_matrix(&moved));
        }
        let moved_arm = moved.crossed_by(-loaded);
        let torque = &mut self.torque;
        torque.shift = torque.shift.plus(&force.shift.crossed_by(arm));
        torque.turn = (torque.turn.plus(&force.turn.crossed_by(arm))).plus(&moved_arm);
        if let Some(curved) = curved {
            let over = curved.over.crossed_by(-loaded);
            torque.shift = torque.shift.plus(&over);
            torque.turn = torque.turn.plus(&over.times_matrix(&moved));
        }
        torque.velocity = torque.velocity.plus(&force.velocity.crossed_by(arm));
        let resistance = by_turning(scene, contact, spin);
        torque.spin = (torque.spin.plus(&force.spin.crossed_by(arm))).plus(&resistance);
        self.force.add(&force);
    }

    fn add_applied_force<D: Dynamics<R>>(&mut self, applied: &ForceDerivatives<'_, R, D>) {
        let none = R::Vec3::ZERO;
        let columns = [
            images::<R, _>(|axis| applied.along_path(axis, none)),
            images::<R, _>(|axis| applied.along_path(none, axis)),
            images::<R, _>(|axis| applied.along_velocity(axis, none)),
            images::<R, _>(|axis| applied.along_velocity(none, axis)),
        ];
        let part = |of: fn(&Wrench<R>) -> R::Vec3| {
            let [shift, turn, velocity, spin] = (columns.each_ref()).map(|[x, y, z]| Matrix3 {
                x: of(x),
                y: of(y),
                z: of(z),
            });
            Part {
                shift,
                turn,
                velocity,
                spin,
            }
        };
        self.force.add(&part(|wrench| wrench.force));
        self.torque.add(&part(|wrench| wrench.torque));
    }
}

/// Rounding of the slip of a contact, m/s.
#[inline]
fn rounding_of_slip<R: Real, D: Dynamics<R>>(scene: &D, motion: &Motion<R>) -> R {
    let speed = motion.linear_velocity.length() + motion.angular_velocity.length() * size(scene);
    speed * (R::EPSILON * R::from_f64(16.0))
}

/// Derivatives P and Q of the force of a contact with respect to its path and to its velocity, and
/// the slip over which its friction changes (m/s). `noise` is the rounding of the slip.
fn by_motion<R: Real, D: Dynamics<R>>(
    scene: &D,
    contact: &Contact<R>,
    noise: R,
) -> ([Matrix3<R>; 2], R) {
    let (_, friction) = contact.laws(scene.ground(), scene.friction());
    let (n, slip) = (contact.normal, contact.slip_velocity);
    let (load, [stiffness, damping]) = normal_force(scene, contact);
    let length = slip.length();
    // The direction of a slip below its rounding is not known. Friction is then a damper that
    // reaches its limit at the rounding, so that the iteration ends there.
    let is_known = length >= noise || length == R::ZERO;
    let known_slip = if is_known {
        slip
    } else {
        slip * (noise / length)
    };
    let mut jacobian = friction.jacobian_at(contact.position, load, known_slip);
    if !is_known {
        jacobian.growth = R::ZERO;
    }
    let metric = Metric::of(&friction, contact.position, known_slip);
    let along = metric.map_or(slip, |metric| metric.along_friction(slip));
    let loaded = n - along * jacobian.per_load;
    let pushed = Matrix3::outer(loaded, n).scaled(-contact.weight);
    let in_surface = match metric {
        Some(metric) => {
            let [x, y, z] = metric.derivative(&jacobian, known_slip);
            Matrix3 { x, y, z }
        }
        None => along_surface(n, slip, &jacobian),
    };
    let in_surface = in_surface.scaled(-(jacobian.coefficient * contact.weight));
    let by_path = pushed.scaled(stiffness);
    let by_velocity = pushed.scaled(damping).plus(&in_surface);
    let width = if jacobian.coefficient > R::ZERO {
        jacobian.width.at_least(noise)
    } else {
        R::MAX
    };
    ([by_path, by_velocity], width)
}

/// Normal force of a contact (N), and its derivatives with respect to depth (N/m) and closing speed
/// (N s/m).
fn normal_force<R: Real, D: Dynamics<R>>(scene: &D, contact: &Contact<R>) -> (R, [R; 2]) {
    let (ground, _) = contact.laws(scene.ground(), scene.friction());
    let (depth, speed) = (contact.depth, contact.closing_speed);
    let nudge = R::EPSILON.sqrt();
    let push = |depth, speed| ground.normal_force(depth, speed);
    let load = push(depth, speed);
    let deeper = depth * nudge;
    let stiffness = (push(depth + deeper, speed) - load) / deeper;
    // The unit of speed: the size of the body in a second. A point has none.
    let faster = (speed.abs() + size(scene) + depth) * nudge;
    let damping = (push(depth, speed + faster) - load) / faster;
    (load, [stiffness, damping])
}

/// Derivative of the direction of isotropic friction with respect to the slip, in units of its
/// coefficient.
fn along_surface<R: Real>(
    normal: R::Vec3,
    slip: R::Vec3,
    jacobian: &FrictionJacobian<R>,
) -> Matrix3<R> {
    let length = slip.length();
    let weakening = if length > R::ZERO && jacobian.growth > R::ZERO {
        jacobian.growth / (length * jacobian.width)
    } else {
        R::ZERO
    };
    Matrix3::diagonal(R::ONE)
        .plus(&Matrix3::outer(-normal, normal))
        .plus(&Matrix3::outer(slip * -weakening, slip))
}

/// Derivative of the torque of rolling resistance with respect to the angular velocity.
fn by_turning<R: Real, D: Dynamics<R>>(
    scene: &D,
    contact: &Contact<R>,
    angular_velocity: R::Vec3,
) -> Matrix3<R> {
    let (ground, friction) = contact.laws(scene.ground(), scene.friction());
    let load = ground.normal_force(contact.depth, contact.closing_speed);
    let Some(resistance) = friction.rolling_resistance_at(contact.position, load) else {
        return Matrix3::ZERO;
    };
    let n = contact.normal;
    let spinning = n * n.dot(angular_velocity);
    let rolling = angular_velocity - spinning;
    let rates = [rolling.length(), spinning.length()];
    let [per_rolling, per_spinning] = resistance.per_turn(rates[0], rates[1]);
    // The ratio of torque to rate falls as the rate grows.
    let falling = |ratio: R, rate: R| ratio / (rate + resistance.turn_speed);
    let along = if rates[0] > R::ZERO {
        rolling * (R::ONE / rates[0])
    } else {
        R::Vec3::ZERO
    };
    let across = Matrix3::outer(n, n);
    Matrix3::diagonal(-per_rolling)
        .plus(&across.scaled(per_rolling - per_spinning))
        .plus(&Matrix3::outer(
            along * (falling(per_rolling, rates[0]) * rates[0]),
            along,
        ))
        .plus(&across.scaled(falling(per_spinning, rates[1]) * rates[1]))
        .scaled(contact.weight)
}

/// Images of the three axes.
fn images<R: Real, T>(image: impl Fn(R::Vec3) -> T) -> [T; 3] {
    let (o, i) = (R::ZERO, R::ONE);
    [
        image(R::Vec3::new(i, o, o)),
        image(R::Vec3::new(o, i, o)),
        image(R::Vec3::new(o, o, i)),
    ]
}

/// Matrix whose columns are the images of the three axes.
fn of_columns<R: Real>(image: impl Fn(R::Vec3) -> R::Vec3) -> Matrix3<R> {
    let [x, y, z] = images::<R, _>(image);
    Matrix3 { x, y, z }
}

fn rows<R: Real>(block: &Matrix3<R>) -> Rows<R, 3, 3> {
    block.rows().map(|row| [row.x(), row.y(), row.z()])
}

/// Six rows from three and three.
fn below<R: Real, const N: usize>(upper: Rows<R, 3, N>, lower: Rows<R, 3, N>) -> Rows<R, 6, N> {
    let ([a, b, c], [d, e, f]) = (upper, lower);
    [a, b, c, d, e, f]
}

/// Rows of six entries from two blocks.
fn beside<R: Real>(left: Rows<R, 3, 3>, right: Rows<R, 3, 3>) -> Rows<R, 3, 6> {
    let mut right = right.into_iter();
    left.map(|[a, b, c]| {
        let [d, e, f] = right.next().unwrap_or([R::ZERO; 3]);
        [a, b, c, d, e, f]
    })
}
