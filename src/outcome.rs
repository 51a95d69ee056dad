//! Outcomes that are proven: the face on which a body will stay.
//!
//! # Derivation
//!
//! Let `u` be the direction, in body axes, that points down. Let `h(u)` be the height of the centre
//! of mass over the plane when the body just touches it, which is the body's
//! [support](RigidPointBody::support) in the direction `u`. A body whose centre of mass is at the
//! height z has a lowest point at the depth `d = h(u) - z`. With the weight `m g` and the springs'
//! energy `U(d)` of the lowest point alone, its potential energy is
//!
//! ```text
//! V >= m g z + U(d) = m g h(u) + U(d) - m g d >= m g h(u) - s
//! s = max over d of (m g d - U(d))
//! ```
//! For a spring of stiffness k the softness s is `(m g)²/(2 k)`. For any other law it is bounded
//! from above by the fact that U never decreases: between two depths a and b, `m g d - U(d)` is at
//! most `m g b - U(a)`. Intervals that can contain the maximum are divided until they are short.
//!
//! The *basin* of a face is a set of directions. Let H be a lower bound of `h` on its boundary. To
//! leave the basin, `u` must cross the boundary, and there `V >= m g H - s`. This is the face's
//! *barrier*. The kinetic energy is never negative, and the energy of the model never increases.
//! Therefore a body whose energy is below the barrier of the basin that it is in never leaves it.
//!
//! # Limits
//!
//! - The statement is about the model, from the given state on. An explicit integrator may add
//!   energy. With [`EnergyMomentum`](crate::EnergyMomentum) the computed energy stays below the
//!   barrier at every later step. A step so long that it rotates the body past the directions whose
//!   `V` exceeds its energy, from one side of the barrier to the other, is not excluded.
//! - The ground is a level plane, and gravity points along -z. On a slope or on hills the potential
//!   energy has no lower bound, and [`Barriers::of`] returns `None`.
//! - The bound counts one contact. On soft ground it is lower than the true barrier, so that a body
//!   is decided later. A face whose barrier is below the energy of the body at rest on it is never
//!   decided, and it may be no equilibrium any more.
//! - The statement says nothing about the accuracy of the motion that led to the state.

mod built_in;
mod hull;
mod noisy_hull;
mod springs;

pub use hull::HullFace;

use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, is_driven};
use crate::state::State;
use springs::Springs;

/// A body with faces on which it can come to rest.
///
/// Implement it for a body of your own to use [`Barriers`]. For a body that lies on facets of the
/// convex hull of its contacts, [`HullFace::basin`] does all of the work. (For a smooth body, a
/// ball or a capsule it returns `None`: there is no such facet.)
///
/// ```
/// use tumble::glam::{DMat3, DVec3};
/// use tumble::{Basin, ContactPoint, Faces, HullFace, RigidPointBody};
///
/// struct Wedge {
///     contacts: [ContactPoint; 6],
/// }
/// # impl RigidPointBody for Wedge {
/// #     fn mass(&self) -> f64 { 0.1 }
/// #     fn inertia(&self) -> DMat3 { DMat3::from_diagonal(DVec3::splat(1e-5)) }
/// #     fn contacts(&self) -> &[ContactPoint] { &self.contacts }
/// # }
///
/// impl Faces for Wedge {
///     type Face = HullFace;
///     fn basin(&self, down: DVec3) -> Option<Basin<HullFace>> {
///         HullFace::basin(self, down)
///     }
/// }
/// ```
pub trait Faces<R: Real = f64>: RigidPointBody<R> {
    /// Name of a face. It stands for one basin. An implementer may name the side that points up,
    /// as the coins and the cuboid do, or the facet on which the body lies, as [`HullFace`] does.
    /// In an ensemble it is also `Ord` and `Send`, and has serde's traits if the counts are saved.
    type Face: Copy + PartialEq + core::fmt::Debug;

    /// Returns the basin of the face that contains the direction `down`, a unit vector in body axes
    /// that points down. Returns `None` if the direction belongs to no face.
    ///
    /// *To the implementer:* each direction belongs to at most one face. On the boundary of the
    /// directions of a face, the [support](RigidPointBody::support) of the body is at least the
    /// `height` of its basin. [`Barriers`] allows for the rounding of the direction.
    fn basin(&self, down: R::Vec3) -> Option<Basin<Self::Face, R>>;
}

/// Implements the trait for a pointer to a body.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, B: Faces<R> + ?Sized> Faces<R> for $pointer {
            type Face = B::Face;

            fn basin(&self, down: R::Vec3) -> Option<Basin<B::Face, R>> {
                (**self).basin(down)
            }
        }
    };
}
forward!(&B);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<B>);

/// Directions of a body that belong to one face, with the height of their boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basin<F, R = f64> {
    /// Face to which the directions belong, as [`Faces::Face`] names it.
    pub face: F,
    /// Lower bound of the height of the centre of mass over the ground at the boundary, m.
    pub height: R,
}

/// Outcome of a toss: the face of which it is proven that the body never leaves its basin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outcome<F> {
    /// The body never leaves the basin of this face.
    Decided(F),
    /// The energy suffices to leave the basin, or the bound is too weak to exclude it.
    Undecided,
}

/// The face, or `undecided`.
impl<F: core::fmt::Display> core::fmt::Display for Outcome<F> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Decided(face) => face.fmt(f),
            Self::Undecided => f.pad("undecided"),
        }
    }
}

/// Energy barriers between the faces of a body on level ground.
///
/// Created by [`Stepper::barriers`](crate::Stepper::barriers), once for a scene. A body whose
/// energy is below the barrier of its face never leaves the face. The [module](self) has the proof
/// and its limits.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{CoinFace, Coin, Coulomb, FlatGround, Outcome, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // -, m/s
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .build()?;
/// let barriers = stepper.barriers().ok_or("no level ground")?;
/// // Upright the energy suffices for both faces. Leaning by half a radian it does not.
/// let upright = State::at(DVec3::Z * 0.5);
/// assert_eq!(barriers.outcome(&upright), Outcome::Undecided);
/// let leaning = State::at(DVec3::Z * 0.44).with_rotation_vector(DVec3::Y * -0.5);
/// assert_eq!(barriers.outcome(&leaning), Outcome::Decided(CoinFace::Heads));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Barriers<'a, D, R: Real = f64> {
    scene: &'a D,
    /// Height of the plane, m.
    ground: R,
    /// Weight of the body, N.
    weight: R,
    /// Most energy that the body gains by penetrating into the springs, J.
    softness: R,
}

// A derived copy would need a scene that is `Copy`, though only its reference is copied.
impl<R: Real, D> Copy for Barriers<'_, D, R> {}

impl<R: Real, D> Clone for Barriers<'_, D, R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<'a, R, D> Barriers<'a, D, R>
where
    R: Real,
    D: Dynamics<R>,
    D::Body: Faces<R>,
{
    /// Computes the barriers of a scene.
    ///
    /// Returns `None` if there is no bound:
    ///
    /// - no ground, several surfaces, or ground that is not a level plane or is a
    ///   [`MovingGround`](crate::MovingGround), also one that stands still;
    /// - gravity plus any [constant force](crate::Force::constant_force) that does not point along
    ///   -z;
    /// - springs of which a single contact is too soft to carry the body: a law that saturates must
    ///   do so above its weight;
    /// - an applied force that is not passive.
    ///
    /// It costs some thousand evaluations of the springs' energy, and for a body with a round rim
    /// some hundred thousand.
    #[must_use]
    pub fn of(scene: &'a D) -> Option<Self> {
        let plane = scene.contact_model().plane()?;
        // A drive can lift the body over any barrier.
        if is_driven(scene) {
            return None;
        }
        let gravity = scene.gravity();
        let is_level = plane.is_level() && gravity.x() == R::ZERO && gravity.y() == R::ZERO;
        let weight = scene.inertia_properties().mass() * -gravity.z();
        if !is_level || weight <= R::ZERO {
            return None;
        }
        let softness = Springs { scene, weight }.softness()?;
        (softness < weight * scene.bounding_radius()).then_some(Self {
            scene,
            ground: plane.height,
            weight,
            softness,
        })
    }

    /// Returns the face whose basin the body never leaves, if the energy of the state proves it.
    ///
    /// The coins and [`Cuboid`](crate::Cuboid) name the face that points up at rest:
    /// [`CoinFace::Heads`](crate::CoinFace) is heads up. [`HullFace`] names the facet on which the
    /// body lies.
    ///
    /// The proof holds for all later states. The outcome of a later state may still be
    /// [`Undecided`](Outcome::Undecided), if the error bound of its energy is larger: more contacts
    /// touch, or their depths have a larger rounding error, as in single precision. It is also
    /// undecided if [`Faces::basin`] returns `None` for its direction. Keep the first decision.
    ///
    /// A state whose kinetic and potential energy alone is above the barrier costs no evaluation of
    /// a contact.
    #[must_use]
    pub fn outcome(&self, state: &State<R>) -> Outcome<<D::Body as Faces<R>>::Face> {
        let Some((basin, least_energy)) = self.basin(state) else {
            return Outcome::Undecided;
        };
        let barrier = self.barrier(&basin);
        if least_energy < barrier && self.most_energy(state) < barrier {
            Outcome::Decided(basin.face)
        } else {
            Outcome::Undecided
        }
    }

    /// Returns the basin that the body is in, if it is low and slow enough that a face may be
    /// decided, and its energy without that of the springs, J. The springs add to it.
    fn basin(&self, state: &State<R>) -> Option<(Basin<<D::Body as Faces<R>>::Face, R>, R)> {
        let radius = self.scene.bounding_radius();
        let gap = state.position.z() - self.ground;
        let masses = self.scene.inertia_properties();
        let translation = masses.mass() * state.linear_velocity.length_squared() * R::HALF;
        // No barrier exceeds that of the bounding radius. Below the deepest point that the springs
        // were searched to, nothing is known.
        let left = self.weight * (radius - gap) - translation;
        let is_low = gap > -radius && left > R::ZERO;
        if !is_low {
            return None;
        }
        let axes = state.rotation().axes();
        let rotation = masses.rotational_energy(&axes, state.angular_momentum);
        if rotation >= left {
            return None;
        }
        let basin = self.scene.body().basin(-axes.rise())?;
        Some((basin, translation + rotation + self.weight * gap))
    }

    /// Returns the barrier of a basin, J: energy above that of a body at rest with its centre of
    /// mass in the plane of the ground.
    #[must_use]
    pub fn barrier<F>(&self, basin: &Basin<F, R>) -> R {
        self.weight * basin.height - self.softness
    }

    /// Returns the energy by which the ground's softness lowers each barrier, J.
    #[must_use]
    pub fn softness(&self) -> R {
        self.softness
    }

    /// Returns an upper bound of the energy, J, from the same zero as the barriers.
    ///
    /// The depth of a contact has an absolute rounding error. So the springs' energy is that of the
    /// body lowered by a bound of this error. The other terms are bounded by their relative errors.
    /// Twice those errors are added, because the energies of later steps have them too.
    fn most_energy(&self, state: &State<R>) -> R {
        let rounding = R::EPSILON * R::from_f64(64.0);
        let gap = state.position.z() - self.ground;
        let lengths = gap.abs() + self.ground.abs() + self.scene.bounding_radius();
        let mut lowered = *state;
        lowered.position -= R::Vec3::new(R::ZERO, R::ZERO, lengths * rounding);
        let energy = Energy::of(self.scene, &lowered);
        let kinetic = energy.kinetic();
        let masses = self.scene.inertia_properties();
        // The components of the angular momentum along the axes have an error relative to its
        // length.
        let rotation = state.angular_momentum.length_squared() * masses.largest_inverse_moment();
        let contacts = R::from_usize(self.scene.body().contacts().len());
        let errors = rounding * (kinetic + rotation + energy.springs + self.weight * lengths)
            + R::EPSILON * R::TWO * contacts * energy.springs;
        kinetic + self.weight * gap + energy.springs + errors
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::cast_possible_truncation,
        reason = "rounding to f32 gives both precisions the same numbers"
    )]

    use crate::real::{Quaternion, Real, Vector};
    use crate::*;
    use glam::{DQuat, DVec3};

    /// kg, m. Both precisions represent them.
    const MASS: f64 = 0.25;
    const RADIUS: f64 = 0.5;
    const WEIGHT: f64 = MASS * 9.75;

    type Ring<R, const N: usize> = Stepper<
        Coin<R, [ContactPoint<R>; N]>,
        FlatGround<R>,
        Frictionless,
        UniformGravity<R>,
        EnergyMomentum<R>,
        R,
    >;

    fn ring<R: Real, const N: usize>(stiffness: f64, height: f64) -> Ring<R, N> {
        let [mass, radius] = [MASS, RADIUS].map(R::from_f64);
        let body = Coin::ring_with_storage([ContactPoint::default(); N], mass, radius);
        let ground = FlatGround::level(R::from_f64(stiffness), R::ZERO);
        Stepper::builder(body)
            .ground(ground.on(Plane::level(R::from_f64(height))))
            .gravity(UniformGravity::down(R::from_f64(9.75)))
            .integrator(EnergyMomentum {
                time_step: R::from_f64(1e-3),
            })
            .build()
            .unwrap()
    }

    /// Number `index` of a sequence that fills (0, 1) evenly, another one for each `dimension`.
    fn part(index: u32, dimension: u32) -> f64 {
        let roots = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0_f64];
        (f64::from(index) * roots[dimension as usize].sqrt()).fract()
    }

    /// A state of which both precisions have the same numbers, at a height above the ground.
    fn state<R: Real>(index: u32, speed: f64, spin: f64, height: f64) -> State<R> {
        let vector = |first: u32| {
            let [x, y, z] = [0, 1, 2].map(|axis| 2.0 * part(index, first + axis) - 1.0);
            DVec3::new(x, y, z)
        };
        let single = |v: DVec3| {
            let [x, y, z] = v.to_array().map(|number| f64::from(number as f32));
            R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z))
        };
        let turn = DQuat::from_scaled_axis(vector(0) * 3.0);
        let [x, y, z, w] = turn
            .to_array()
            .map(|number| R::from_f64(f64::from(number as f32)));
        State::at(single(
            DVec3::Z * (height + RADIUS * (1.2 * part(index, 3) - 0.2)),
        ))
        .with_orientation(R::Quat::new(x, y, z, w))
        .with_linear_velocity(single(vector(4) * speed))
        .with_angular_momentum(single(vector(7) * spin))
    }

    /// Checks that the bound is above the true energy by what the documentation of `most_energy`
    /// states: 64 units of each term, two for each contact, and the springs of a body that is
    /// lowered by 64 units of the lengths. The truth is that of double precision. The roundings of
    /// the terms are below a tenth of it.
    fn check_bound<const N: usize>(index: u32) {
        let unit = f64::from(f32::EPSILON);
        let log =
            |dimension, low: f64, high: f64| low * (high / low).powf(part(index + 7, dimension));
        let stiffness = log(0, 1e2, 1e6).round();
        let height = (log(1, 1e-2, 1e3) - 1.0).round();
        let (speed, spin) = (log(2, 1e-2, 1e3), log(4, 1e-3, 1e2));
        let (single, wide) = (
            ring::<f32, N>(stiffness, height),
            ring::<f64, N>(stiffness, height),
        );
        let bound = single.barriers().unwrap();
        let most = bound.most_energy(&state(index, speed, spin, height));
        let state = state::<f64>(index, speed, spin, height);
        let gap = state.position.z - height;
        let lengths = gap.abs() + height.abs() + RADIUS;
        let mut lowered = state;
        lowered.position.z -= 64.0 * unit * lengths;
        let (true_energy, low) = (wide.energy(&state), wide.energy(&lowered));
        let kinetic = true_energy.kinetic();
        let truth = kinetic + WEIGHT * gap + true_energy.springs;
        let rotation = state.angular_momentum.length_squared() * 2.0 / (MASS * RADIUS * RADIUS);
        let terms = kinetic + rotation + low.springs + WEIGHT * lengths;
        let stated = 64.0 * unit * terms
            + 2.0 * N as f64 * unit * low.springs
            + (low.springs - true_energy.springs);
        let margin = (f64::from(most) - truth) / stated;
        assert!((0.8..1.2).contains(&margin), "{N}, {index}: {margin}");
    }

    #[test]
    fn the_bound_of_the_energy_is_above_it_by_the_stated_rounding() {
        (1..600).for_each(check_bound::<12>);
    }

    /// So many contacts that the rounding of their sum is the largest term.
    #[test]
    fn the_bound_of_the_energy_counts_the_rounding_of_each_contact() {
        (1..100).for_each(check_bound::<4096>);
    }

    /// `m g R` is the barrier of the bounding radius, and no face has a higher one.
    #[test]
    fn a_state_is_left_out_above_the_highest_barrier_and_below_the_depth_of_the_body() {
        let stepper = ring::<f64, 12>(1e4, 3.0);
        let barriers = stepper.barriers().unwrap();
        let [mut left_out, mut kept, mut deep] = [0; 3];
        for index in 1..2000 {
            let mut state = state::<f64>(index, 2.0, 0.05, 3.0);
            let gap = RADIUS * (4.0 * part(index, 3) - 2.0);
            state.position.z = 3.0 + gap;
            let energy = stepper.energy(&state);
            let total = energy.kinetic() + WEIGHT * gap;
            let is_deep = gap <= -RADIUS;
            let found = barriers.basin(&state).map(|(_, least)| least);
            deep += u32::from(is_deep);
            kept += u32::from(found.is_some());
            left_out += u32::from(!is_deep && found.is_none());
            assert_eq!(
                found.is_some(),
                !is_deep && total < WEIGHT * RADIUS,
                "{index}"
            );
            assert!(
                found.is_none_or(|least| (least - total).abs() < 1e-14),
                "{index}"
            );
        }
        let counts = [left_out, kept, deep];
        assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
    }

    /// The softness of a spring of stiffness k is `(m g)²/(2 k)`. If it is `m g R`, the highest
    /// barrier is 0.
    #[test]
    fn springs_whose_softness_exceeds_the_highest_barrier_leave_no_barriers() {
        let limit = WEIGHT / (2.0 * RADIUS);
        assert!(ring::<f64, 12>(1.02 * limit, 0.0).barriers().is_some());
        assert!(ring::<f64, 12>(0.98 * limit, 0.0).barriers().is_none());
        assert!(ring::<f64, 12>(0.5 * limit, 0.0).barriers().is_none());
    }

    /// The softness is a bound from above. Its depth is resolved to 1 in 1024 of an interval that
    /// is at most as long as the depth `m g/k` of the maximum, so that it is too large by at most
    /// `(m g)²/(1024 k)`.
    #[test]
    fn a_barrier_is_the_weight_at_the_height_of_the_boundary_less_the_softness() {
        for stiffness in [30.0, 1e3, 7e5] {
            let stepper = ring::<f64, 12>(stiffness, 3.0);
            let barriers = stepper.barriers().unwrap();
            let ratio = barriers.softness() / (WEIGHT * WEIGHT / (2.0 * stiffness));
            assert!((1.0..1.0 + 2.0 / 1024.0).contains(&ratio), "{ratio}");
            let barrier = barriers.barrier(&Basin {
                face: (),
                height: 0.3,
            });
            let expected = WEIGHT * 0.3 - barriers.softness();
            assert!((barrier - expected).abs() < 1e-15, "{barrier}");
        }
    }

    /// A flat coin at the depth d has the energy `n k d²/2 - m g d`. Its barrier is below `m g r`.
    #[test]
    fn the_energy_of_the_springs_counts() {
        let stiffness = 1e4;
        let stepper = ring::<f64, 12>(stiffness, 0.0);
        let barriers = stepper.barriers().unwrap();
        let at = |depth: f64| {
            let turn = DVec3::Y * -core::f64::consts::FRAC_PI_2;
            barriers.outcome(&State::at(DVec3::Z * -depth).with_rotation_vector(turn))
        };
        let limit = (2.0 * WEIGHT * RADIUS / (12.0 * stiffness)).sqrt();
        assert_eq!(at(0.5 * limit), Outcome::Decided(CoinFace::Heads));
        assert_eq!(at(1.2 * limit), Outcome::Undecided);
        assert_eq!(at(50.0 * limit), Outcome::Undecided);
    }

    #[test]
    fn ground_that_is_not_level_and_gravity_that_does_not_point_down_have_no_barriers() {
        let stepper = ring::<f64, 12>(1e4, 0.0);
        let slope = |normal| FlatGround::level(1e4, 0.0).on(Plane::through(DVec3::ZERO, normal));
        for normal in [DVec3::new(0.1, 0.0, 1.0), DVec3::new(0.0, -0.1, 1.0)] {
            assert!(
                stepper
                    .with_ground(slope(normal))
                    .unwrap()
                    .barriers()
                    .is_none()
            );
        }
        for (acceleration, has_barriers) in [
            (DVec3::new(0.0, 0.0, -1.0), true),
            (DVec3::new(0.1, 0.0, -1.0), false),
            (DVec3::new(0.0, 0.1, -1.0), false),
            (DVec3::ZERO, false),
            (DVec3::Z, false),
        ] {
            let gravity = UniformGravity { acceleration };
            let stepper = stepper.with_gravity(gravity).unwrap();
            assert_eq!(stepper.barriers().is_some(), has_barriers, "{acceleration}");
        }
    }

    #[test]
    fn an_outcome_does_not_depend_on_the_height_of_the_ground() {
        let mut decided = 0;
        for index in 1..400 {
            let outcomes = [-3.0, 0.0, 5.0].map(|height| {
                let stepper = ring::<f64, 12>(1e4, height);
                let state = state::<f64>(index, 1.0, 0.05, height);
                stepper.barriers().unwrap().outcome(&state)
            });
            assert_eq!(outcomes[0], outcomes[1], "{index}");
            assert_eq!(outcomes[2], outcomes[1], "{index}");
            decided += u32::from(outcomes[1] != Outcome::Undecided);
        }
        assert!((40..360).contains(&decided), "{decided}");
    }

    #[test]
    fn the_face_that_is_up_is_decided() {
        let stepper = ring::<f64, 12>(1e4, 2.0);
        let barriers = stepper.barriers().unwrap();
        for (turn, face) in [(-1.0, CoinFace::Heads), (1.0, CoinFace::Tails)] {
            let turn = DVec3::Y * (turn * core::f64::consts::FRAC_PI_2);
            let state = State::at(DVec3::Z * 2.0).with_rotation_vector(turn);
            assert_eq!(barriers.outcome(&state), Outcome::Decided(face));
        }
    }

    #[test]
    fn what_drives_a_body_has_no_barriers_and_what_slows_it_has() {
        let stepper = ring::<f64, 12>(1e4, 0.0);
        let drag = AirDrag {
            linear: 0.1,
            quadratic: 0.2,
        };
        assert!(stepper.with_force(drag).unwrap().barriers().is_some());
        let velocity = DVec3::X;
        let wind = Wind {
            velocity,
            force: drag,
        };
        assert!(stepper.with_force(wind).unwrap().barriers().is_none());
        let belt = MovingGround::conveyor(FlatGround::level(1e4, 0.0), DVec3::X);
        assert!(stepper.with_ground(belt).unwrap().barriers().is_none());
    }
}
