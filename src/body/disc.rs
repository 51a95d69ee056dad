//! Coin with a round rim.

use super::coin::{CoinFace, tilt};
use super::{ContactPoint, RigidPointBody, Rim};
use crate::error::{self, SceneError};
use crate::real::{Matrix, Real, Vector};
use crate::state::State;

/// Thin coin whose contact is the whole circle of its rim.
///
/// It is a [`Coin`](super::Coin) in the limit of many points. A coin with a thickness is a
/// [`ThickDisc`](super::ThickDisc), with two rims.
///
/// Body axes: the normal is x and the rim lies in the yz plane. The mass properties are those of
/// the constructor. They do not depend on the number of points that the rim [represents](Rim).
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Disc, FlatGround, State, Stepper, StrangSplitting, UniformGravity};
///
/// // The disc on the ground of the 120 points of the coin report: it rolls upright at 4 rad/s.
/// // Its height stays constant to 1 µm. The corners of such a ring of points are 170 µm high.
/// let stepper = Stepper::builder(Disc::ring(1.0, 0.5, 120)) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each of 120 points
///     .integrator(StrangSplitting { time_step: 1e-3 }) // s
///     .build()?;
/// let mut state = State::at(DVec3::Z * 0.49);
/// stepper.advance(&mut state, 20.0)?; // until it has settled
/// let height = state.position.z;
/// let slow = state.with_linear_velocity(DVec3::NEG_Y * 2.0); // m/s
/// state = stepper.with_angular_velocity(slow, DVec3::X * 4.0); // rad/s
/// stepper.advance(&mut state, 1.0)?;
/// assert!((state.position.z - height).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Points or a round rim
///
/// - Points model the coin of the coin report and are cheaper. Use [`Coin`](super::Coin) to repeat
///   the coin report, for pictures, and if 0.1 mm or a few hundredths of g do not matter.
/// - The round rim has no corners. It rolls without rattling. Methods of high order keep their
///   order. A method with adaptive steps has no touch-downs of points to locate.
///
/// The tables compare a `Disc` with rings of n points that have the same stiffness and damping on
/// the whole rim. The disc has a mass of 1 kg and a radius of 0.5 m. It represents 120 points of
/// 1000 N/m and 0.5 N s/m each. The first table lists where the rings arrive in the trials of the
/// coin report (slip speed 1 mm/s). The second table lists how they roll upright at 4 rad/s. The
/// third table lists how far leaning hoops without dampers roll away from the circle of a hoop that
/// touches a rigid floor at one point (20 m long; slip speed 0.1 mm/s). The fourth table is the
/// position error of the round coin.
///
/// <!-- round rim: begin; written by `round_rim -- --write` -->
///
/// | distance from the round rim, m | trial 1, 1 s | 5 s | trial 5, 1 s | 5 s | trial 8, 1 s | 5 s |
/// |---|---|---|---|---|---|---|
/// | 12 points | 0.16 | 0.78 | 0.15 | 0.87 | 0.29 | 0.79 |
/// | 120 points | 6.5e-5 | 1.8e-3 | 2.3e-3 | 2.9e-2 | 2.4e-3 | 5.5e-2 |
/// | 1200 points | 5.8e-7 | 6.8e-6 | 1.1e-5 | 4.7e-5 | 4.2e-6 | 4.7e-4 |
///
/// | upright, 4 rad/s | vertical acceleration, rms, over g | energy lost in 1 s with dampers and friction, J |
/// |---|---|---|
/// | 12 points | 2.4 | 0.2936 |
/// | 120 points | 7.0e-3 | 0.0430 |
/// | 1200 points | 2.1e-4 | 0.0431 |
/// | round | 4.8e-14 | 0.0431 |
///
/// | circle, distance after 10 s, m | round rim | 1200 points | thin `Ellipsoid` |
/// |---|---|---|---|
/// | whole rim 1e6 N/m | 16.0 | 16.0 | 8.1e-3 |
/// | whole rim 1e7 N/m | 7.8 | 7.8 | 1.4e-3 |
/// | whole rim 1e8 N/m | 3.1 | 3.1 | 2.0e-3 |
/// | whole rim 1e9 N/m | 1.4 | 1.3 | 2.0e-3 |
///
/// | round, trial 1, position after 1 s | `Rk4` | `Nystrom` | `StrangSplitting` | `EnergyMomentum` |
/// |---|---|---|---|---|
/// | steps of 10 ms | 1e-4 m | 1e-5 m | 1e-3 m | 8e-4 m |
/// | steps of 5 ms | 4e-6 m | 4e-7 m | 2e-4 m | 2e-4 m |
/// | steps of 2 ms | 4e-8 m | 1e-8 m | 3e-5 m | 4e-5 m |
/// | steps of 1 ms | 3e-9 m | 7e-10 m | 8e-6 m | 2e-5 m |
/// | steps of 0.2 ms | 6e-12 m | 1e-12 m | 3e-7 m | 5e-6 m |
/// <!-- round rim: end -->
///
/// A step on the round rim takes more time than a step with 120 points, except in flight. The ratio
/// is largest if the coin tumbles, because friction reverses on the arc and more quadrature points
/// are needed there. `cargo bench --bench ratios` prints the ratios for each integrator.
///
/// # Limits
///
/// - On ground that is not a plane, the arcs are found from 24 points of the rim. Up to twelve
///   pieces between ends of arcs and edges of the ground are integrated one by one, as many as a
///   box makes of a rim. A rim with more pieces may be integrated across edges, and one with more
///   than twelve arcs as a whole. An edge is missed between two neighbouring points that lie
///   nearest the same face of a box. In fewer than one random pose in ten the force then has an
///   error, of up to 5 %. It is up to 50 % if the whole arc is shorter than 15°, as under an
///   upright coin that is nearer to the edge of the box than it is deep.
/// - On smooth hills of four radii of the rim from crest to crest, the springs' energy is that of
///   the arcs to a relative 1e-4, on hills of two radii to 1e-3, and of one radius to 2e-2. On
///   shorter hills the error may be as large as the energy.
/// - On planes, with explicit methods and a [`SpringDamper`](crate::SpringDamper), the forces equal
///   the integral of the law over the arc to a relative 1e-9 in most random poses, and to 2e-7 in
///   98 of 100. On smooth hills of four radii and more with dampers, the error is larger in one
///   pose of eight, and below 1e-3. The error is up to 1e-4 if the slip is 0 somewhere on the arc
///   and below the slip speed on all of it. It is larger if dampers leave less than 2 % of the
///   springs' force, because only a short part of the arc pushes.
/// - Other laws are not smooth where the quadrature assumes it, at the ends of the arc or where a
///   damper reaches its limit. In random poses the error is up to 1e-2 with
///   [`LoadDependentCoulomb`](crate::LoadDependentCoulomb),
///   [`AnisotropicCoulomb`](crate::AnisotropicCoulomb) and [`HuntCrossley`](crate::HuntCrossley),
///   and up to 0.1 with [`LimitedDamper`](crate::LimitedDamper). A
///   `HuntCrossley` damper that cancels the force on a part of the arc has up to 30 % of the small
///   force that is left. An elastic bounce then has an error of its energy that shorter steps do
///   not reduce.
/// - `EnergyMomentum` uses up to eight points between discontinuities. If friction reverses on the
///   arc, the error is up to 1e-3 of the load, and 6e-3 for a slip speed of 1e-10 m/s. So the
///   method does not converge to the same limit as its steps get shorter.
/// - The difference from the limit of many points decreases with the square of their number, also
///   with dampers, if the points' touch-downs are resolved in time. [`Nystrom`](crate::Nystrom)
///   and the adaptive methods do that. A ring that spins upright on the spot is an exception.
///   Its contacts are always the same few points, near the lowest point, where friction reverses.
///   The difference for such a ring decreases as one over the number of points, until their
///   distance times the spin is below the slip speed.
/// - As a leaning disc rolls round a circle, the two ends of the arc that touches slip in opposite
///   directions. Friction resists this rotation, and the disc rolls round a wider circle than a
///   hoop that touches at one point. The arc is shorter on stiffer ground, with the cube root of
///   the compliance, and so is the difference. An [`Ellipsoid`](super::Ellipsoid) with one very
///   short semi-axis and the mass properties of a ring touches at one point.
/// - Each touch-down of a point is a discontinuity of its damper's force. A fixed step size adds a
///   position error in proportion to the step size for a ring of points, but not for the round rim.
///   The error does not decrease with the number of points, because more points have smaller
///   dampers. Then a rolling coin shows no clean order in their number.
/// - `EnergyMomentum` is of order 2 on the round rim without dampers. With the dampers of the coin
///   report it is of order 1 for step sizes below 2 ms. It is also of order 1 with friction at an
///   edge of the ground, where points of the rim change the direction of friction within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc<R: Real = f64> {
    mass: R,
    /// Moment about the normal over `m r²`. The moment about a diameter is half of it.
    shape: R,
    rim: [Rim<R>; 1],
}

impl<R: Real> Disc<R> {
    /// Creates a thin ring: moments `m r²` about the normal and `m r²/2` about a diameter.
    ///
    /// Mass in kg, radius in m. The rim represents `points` points on the ground.
    ///
    /// It is [`Coin::ring`](super::Coin::ring) with a round rim, on the same ground.
    #[must_use]
    pub fn ring(mass: R, radius: R, points: usize) -> Self {
        Self::with_shape(mass, radius, points, R::ONE)
    }

    /// Creates a homogeneous disc, much thinner than wide: moments `m r²/2` about the normal and
    /// `m r²/4` about a diameter.
    ///
    /// Mass in kg, radius in m. The rim represents `points` points on the ground.
    #[must_use]
    pub fn solid(mass: R, radius: R, points: usize) -> Self {
        Self::with_shape(mass, radius, points, R::HALF)
    }

    fn with_shape(mass: R, radius: R, points: usize, shape: R) -> Self {
        let normal = R::Vec3::new(R::ONE, R::ZERO, R::ZERO);
        Self {
            mass,
            shape,
            rim: [Rim::new(R::Vec3::ZERO, normal, radius, points)],
        }
    }

    /// Number of points that the rim represents.
    #[cfg(feature = "serde")]
    pub(super) fn points(&self) -> usize {
        let [rim] = &self.rim;
        rim.points().floor_index()
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_solid(&self) -> bool {
        self.shape < R::ONE
    }

    /// Radius of the rim, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        let [rim] = &self.rim;
        rim.radius()
    }

    /// Angle between the coin's plane and the horizontal, rad: π/2 upright, 0 flat on either face.
    #[must_use]
    pub fn tilt(&self, state: &State<R>) -> R {
        tilt(state)
    }

    /// Face that points up, or [`CoinFace::Edge`] for a disc that is upright to rounding.
    #[must_use]
    pub fn face_up(&self, state: &State<R>) -> CoinFace {
        CoinFace::up(state.rotation().axes().x.z())
    }
}

impl<R: Real> RigidPointBody<R> for Disc<R> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        let normal = self.shape * self.mass * self.radius() * self.radius();
        let diameter = normal * R::HALF;
        R::Mat3::from_diagonal(R::Vec3::new(normal, diameter, diameter))
    }
    #[inline]
    fn is_symmetric(&self) -> bool {
        true
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        &[]
    }
    #[inline]
    fn rims(&self) -> &[Rim<R>] {
        &self.rim
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the disc", self.mass, " kg")?;
        error::above_zero("radius of the disc", self.radius(), " m")
    }
}
