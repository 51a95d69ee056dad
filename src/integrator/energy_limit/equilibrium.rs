//! Whether a slow body in contact stays where it is, or is at a turning point of its motion.
//!
//! A body that rocks, or that rolls up a slope, is slow at its turning points. In single precision
//! its kinetic energy is there below the rounding of the total, as it is at rest. The difference is
//! what the body would do next. Let the contacts be constraints that allow no motion along their
//! normals, and let `a` be the acceleration that gravity gives the body under them. A motion with
//! that acceleration, and with the rate `κ` of a slow oscillation, releases the energy
//!
//! ```text
//! V = a · M a/(2 κ²)
//! ```
//! A body in equilibrium has `a = 0` to rounding. The acceleration follows from springs that are
//! much stiffer than `κ² M`, of a stiffness that single precision still resolves:
//! `(κ² M + k Σ g gᵀ) y = W`, `M a = κ² M y`, with the wrench `W` of gravity and the contacts, and
//! `g = (n, r × n)`. Depths of a hard ground are rounded, and so are the forces of its springs. But
//! these act along the constraints.
//!
//! A displacement along `y` releases `W · y` to first order. That is `2 V`, unless the springs push
//! the body along a constraint. Then it is far more, and the displacement for the same energy is
//! far shorter.
//!
//! Friction and resistance to rolling may hold the body. They do if they take the power of that
//! wrench.

use crate::energy::{Dissipation, Energy};
use crate::force::Wrench;
use crate::integrator::linear::{Factored, SixBySix};
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, is_driven, size};
use crate::state::State;

/// Rate of the slowest motion that is followed, in units of `√(g/size)`, squared.
const SLOW: f64 = 0.01;
/// Stiffness of a constraint in units of `κ² m`.
const STIFF: f64 = 1e4;
/// Share of the power that friction takes from a body that it holds.
const HELD: f64 = 0.75;
/// Displacements that are tried, in units of the one that releases the excess of energy.
const DISPLACEMENTS: u32 = 16;
/// Largest displacement, in sizes of the body.
const FARTHEST: f64 = 1e-3;

/// Displacement by which gravity lowers the energy of a slow body in contact.
pub(super) struct Descent<R: Real> {
    /// Shift per energy released, m/J.
    shift: R::Vec3,
    /// Rotation per energy released, rad/J.
    turn: R::Vec3,
}

impl<R: Real> Descent<R> {
    /// Returns the descent of a body that leaves its pose, or `None` if it stays: gravity can
    /// release no more than `rounding` (J), or friction holds the body.
    #[cold]
    #[inline(never)]
    pub(super) fn of<D: Dynamics<R>>(scene: &D, state: &State<R>, rounding: R) -> Option<Self> {
        let (size, pull) = (size(scene), scene.gravity().length());
        if is_driven(scene) || size == R::ZERO || pull == R::ZERO {
            return None;
        }
        let slow = SlowMotion::of(scene, state, pull / size * R::from_f64(SLOW));
        let SlowMotion {
            shift, turn, drive, ..
        } = slow;
        let twice_released = drive.force.dot(shift) + drive.torque.dot(turn);
        if twice_released <= rounding * R::TWO {
            return None;
        }
        let spin = scene.motion(state).angular_velocity;
        let power = (drive.force.dot(state.linear_velocity) + drive.torque.dot(spin)).abs();
        let taken = Dissipation::of(scene, state).total().abs();
        (taken < power * R::from_f64(HELD)).then(|| {
            let per_energy = R::ONE / slow.work;
            Self {
                shift: shift * per_energy,
                turn: turn * per_energy,
            }
        })
    }

    /// Returns the end of a step, displaced so far that its energy is at most `ceiling`, J. The
    /// body keeps its velocities.
    pub(super) fn lowered<D: Dynamics<R>>(
        &self,
        scene: &D,
        ceiling: R,
        (end, after): (&State<R>, &Energy<R>),
    ) -> Option<(State<R>, Energy<R>)> {
        let (excess, size) = (after.total() - ceiling, size(scene));
        (1..=DISPLACEMENTS)
            .map(|times| {
                let released = excess * R::from_f64(f64::from(times));
                (self.shift * released, self.turn * released)
            })
            .take_while(|(shift, turn)| {
                shift.length() + turn.length() * size <= size * R::from_f64(FARTHEST)
            })
            .find_map(|(shift, turn)| {
                let state = displaced(end, shift, turn);
                let energy = Energy::of(scene, &state);
                (energy.total() <= ceiling).then_some((state, energy))
            })
    }
}

/// Shift and rotation `y` of a slow motion under the contacts as constraints.
struct SlowMotion<R: Real> {
    /// m
    shift: R::Vec3,
    /// rad
    turn: R::Vec3,
    /// `κ² M y`
    drive: Wrench<R>,
    /// `W · y`, J
    work: R,
}

impl<R: Real> SlowMotion<R> {
    /// Returns the motion with this square of its rate, 1/s².
    fn of<D: Dynamics<R>>(scene: &D, state: &State<R>, squared_rate: R) -> Self {
        let still = scene.motion(&State {
            linear_velocity: R::Vec3::ZERO,
            angular_momentum: R::Vec3::ZERO,
            ..*state
        });
        let properties = scene.inertia_properties();
        let ([x, y, z], _) = properties.inertia_for_solving(&still.axes, R::Vec3::ZERO);
        let inertia = Matrix3 { x, y, z }.scaled(squared_rate);
        let mass = properties.mass() * squared_rate;
        let stiffness = mass * R::from_f64(STIFF);
        let mut equations = SixBySix::of_body(mass, &inertia);
        let mut wrench = Wrench::<R>::of_force(scene.gravity() * properties.mass());
        scene.visit_contacts(&still, |contact| {
            let block = Matrix3::outer(contact.normal * stiffness, contact.normal);
            equations.add_at(&block, contact.arm, contact.arm);
            let push = contact.force(scene.ground(), scene.friction());
            wrench.force += push;
            wrench.torque += contact.arm.cross(push);
        });
        let size = size(scene);
        let (shift, turn) = Factored::of(equations, size).solve(wrench.force, wrench.torque, size);
        Self {
            shift,
            turn,
            drive: Wrench {
                force: shift * mass,
                torque: inertia.times(turn),
            },
            work: wrench.force.dot(shift) + wrench.torque.dot(turn),
        }
    }
}

/// Returns the state in a pose that is shifted (m) and rotated (rad).
fn displaced<R: Real>(state: &State<R>, shift: R::Vec3, turn: R::Vec3) -> State<R> {
    let rotation = Rotation::from_rotation_vector(turn).after(state.rotation());
    State {
        position: state.position + shift,
        orientation: rotation.normalised().to_quat(),
        ..*state
    }
}
