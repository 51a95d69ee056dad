//! Impulses that only dissipate energy: friction and dampers acting on a body at a fixed pose.
//!
//! ```text
//! (M + Σ Jᵢᵀ kᵢ Jᵢ) y' = M y        y = (v, ω),   kᵢ >= 0
//! ```
//!
//! Each contact responds to its new velocity `uᵢ' = Jᵢ y'` with the impulse `-kᵢ uᵢ'`. This is
//! backward Euler, for all contacts at once. ([`corrected`](super::end_velocity::corrected) uses a
//! target velocity other than 0.)
//!
//! The kinetic energy decreases for any resistances `kᵢ >= 0`. With `K = Σ Jᵢᵀ kᵢ Jᵢ`, the decrease
//! is `yᵀ M y - y'ᵀ M y' = 2 y'ᵀ K y' + (K y')ᵀ M⁻¹ (K y') >= 0`. The resistances may therefore be
//! fitted to limits of the impulses in a few passes, and the order of the contacts does not matter.
//!
//! On a ground that moves, `y` is the motion relative to the ground. The relative kinetic energy
//! decreases, so the kinetic energy increases by at most the work of the ground
//! ([`work`](super::work)).

use super::shared::{motion_of, seen};
use crate::contact::Motion;
use crate::integrator::linear::SixBySix;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Number of passes that fit the resistances to their limits. No pass increases the energy. More
/// passes only distribute an impulse better.
const PASSES: u32 = 4;

/// Largest resistance of a point over the mass, as a part of `1/EPSILON`: it leaves the inertia
/// six bits in equations that contain both. What a larger one leaves of the motions that it does
/// not resist would be rounding, which may be of any size.
pub(super) const MOST_OF_PRECISION: f64 = 1.0 / 64.0;

/// Number of points that may have that resistance each, which leaves the inertia three bits. More
/// of them share that of one. Few points hold a body in stick, and the more they resist, the less
/// it creeps.
const FEW: usize = 8;

/// A contact that resists, with its largest allowed impulses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resisting<R: Real> {
    /// Vector from the centre of mass to the point at which the impulse acts, m, world axes.
    pub(super) place: R::Vec3,
    /// Normal of the ground, unit vector.
    pub(super) normal: R::Vec3,
    /// Largest impulse along the ground, N s.
    pub(super) along: R,
    /// Largest impulse along the normal, N s.
    pub(super) across: R,
}

/// Returns the state after the contacts passed by `visit`, so many, have resisted its velocities.
/// `visit` is called once in each pass with the motion before the impulses.
pub(super) fn resisted<R: Real, D: Dynamics<R>>(
    scene: &D,
    bounding_radius: R,
    (state, contacts): (&State<R>, usize),
    mut visit: impl FnMut(&Motion<R>, &mut dyn FnMut(&Resisting<R>)),
) -> State<R> {
    let motion = motion_of(scene, state);
    let relative = seen(scene, state);
    let mut known = relative;
    let mut slowed = *state;
    for _ in 0..PASSES {
        let mut sum = Resistance::of_body(scene, &motion, state.angular_momentum);
        sum.limit(contacts);
        visit(&motion, &mut |contact| {
            contact.add_to(&mut sum, &relative, &known);
        });
        let Some(next) = sum.resisted(scene, state, bounding_radius) else {
            break;
        };
        slowed = next;
        known = seen(scene, &slowed);
    }
    slowed
}

impl<R: Real> Resisting<R> {
    /// Adds the contact, with the resistances that would give the impulses of the limits in the
    /// motion `known`. Both motions are relative to the ground.
    fn add_to(&self, sum: &mut Resistance<R>, motion: &Motion<R>, known: &Motion<R>) {
        let n = self.normal;
        let (before, after) = (
            motion.velocity_at(self.place),
            known.velocity_at(self.place),
        );
        let (closing, closing_after) = (before.dot(n), after.dot(n));
        let along = resistance(
            self.along,
            (before - n * closing).length(),
            (after - n * closing_after).length(),
        );
        let across = resistance(self.across, closing.abs(), closing_after.abs());
        sum.add(self.place, [n, n], [along, across], before);
    }
}

/// Equations of a pass.
pub(super) struct Resistance<R: Real> {
    equations: SixBySix<R>,
    inertia: Matrix3<R>,
    impulse: R::Vec3,
    turning: R::Vec3,
    /// Largest resistance of a point, kg.
    most: R,
    active: bool,
}

impl<R: Real> Resistance<R> {
    pub(super) fn of_body<D: Dynamics<R>>(
        scene: &D,
        motion: &Motion<R>,
        angular_momentum: R::Vec3,
    ) -> Self {
        let properties = scene.inertia_properties();
        let ([x, y, z], _) = properties.inertia_for_solving(&motion.axes, angular_momentum);
        let inertia = Matrix3 { x, y, z };
        Self {
            equations: SixBySix::of_body(properties.mass(), &inertia),
            inertia,
            impulse: R::Vec3::ZERO,
            turning: R::Vec3::ZERO,
            most: properties.mass() * (R::from_f64(MOST_OF_PRECISION) / R::EPSILON),
            active: false,
        }
    }

    /// Limits the resistance of so many points.
    fn limit(&mut self, points: usize) {
        if points > FEW {
            self.most = self.most / R::from_usize(points);
        }
    }

    /// Adds a point (m from the centre of mass, world axes) that resists the difference between its
    /// velocity and the target velocity (`departure`, m/s, before the impulses). The resistances
    /// `along` and `across` the ground are in kg and at least 0; they act up to a
    /// [largest one](MOST_OF_PRECISION). The impulse of the latter is along
    /// `pushed`, which is the normal, or the normal with the friction of a unit load.
    pub(super) fn add(
        &mut self,
        place: R::Vec3,
        [normal, pushed]: [R::Vec3; 2],
        [along, across]: [R; 2],
        departure: R::Vec3,
    ) {
        if along <= R::ZERO && across <= R::ZERO {
            return;
        }
        self.active = true;
        let [along, across] = [along.at_most(self.most), across.at_most(self.most)];
        let rising = departure.dot(normal);
        let up = R::Vec3::new(R::ZERO, R::ZERO, R::ONE);
        let is_level = normal == up && pushed == up;
        let rubbed = pushed - normal;
        let resisted =
            departure * along + normal * (rising * (across - along)) + rubbed * (rising * across);
        self.impulse += resisted;
        self.turning += place.cross(resisted);
        if is_level {
            self.equations.add_on_level([along, across], place);
        } else {
            let normal_part = Matrix3::outer(normal * (across - along) + rubbed * across, normal);
            let block = Matrix3::diagonal(along).plus(&normal_part);
            self.equations.add_at(&block, place, place);
        }
    }

    /// Adds the torque that comes with the impulse of a point across the ground: `torque` (kg m)
    /// for each m/s by which the point rises too fast (`rising` before the impulses).
    pub(super) fn add_torque(
        &mut self,
        place: R::Vec3,
        normal: R::Vec3,
        torque: R::Vec3,
        rising: R,
    ) {
        self.turning += torque * rising;
        self.equations.add_torque(torque, normal, place);
    }

    /// Adds a matrix (kg m²) that resists the difference between the angular velocity and its
    /// target (`departure`, rad/s, before the impulses).
    pub(super) fn add_turning(&mut self, matrix: &Matrix3<R>, departure: R::Vec3) {
        self.active = true;
        self.turning += matrix.times(departure);
        self.equations.add_turning(matrix);
    }

    /// Returns the state after the impulses, or `None` if there are none or the equations have no
    /// finite solution. The equations are solved for the change of the velocities. Velocities that
    /// no contact resists therefore stay unchanged to the last place.
    pub(super) fn resisted<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &State<R>,
        bounding_radius: R,
    ) -> Option<State<R>> {
        if !self.active {
            return None;
        }
        let (change, turn) = self
            .equations
            .solve(-self.impulse, -self.turning, bounding_radius);
        let angular_momentum = state.angular_momentum + self.inertia.times(turn);
        let resisted = State {
            linear_velocity: state.linear_velocity + change,
            angular_momentum: scene
                .inertia_properties()
                .without_dead_spin(state.rotation(), angular_momentum),
            ..*state
        };
        resisted.not_finite().is_none().then_some(resisted)
    }
}

/// Resistance (kg) whose impulse at the speed `after` is `limit`. It is 0 if the contact does not
/// move or the limit is 0.
fn resistance<R: Real>(limit: R, before: R, after: R) -> R {
    if limit > R::ZERO && before > R::ZERO {
        // A resistance that has stopped the contact stays large enough to hold it to a millionth of
        // its speed.
        limit / after.at_least(before * R::from_f64(1e-6))
    } else {
        R::ZERO
    }
}
