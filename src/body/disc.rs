//! A coin with a round rim.

use super::coin::{CoinFace, tilt};
use super::{ContactPoint, RigidPointBody, Rim};
use crate::error::{self, SceneError};
use crate::real::{Matrix, Real, Vector};
use crate::state::State;

/// A thin coin whose contact is the whole circle of its rim: [`Coin`](super::Coin) in the limit of
/// many points.
///
/// Body axes: the normal is x, the rim lies in the yz plane. Mass properties are those of the
/// constructor, and do not depend on the number of points that the rim [stands for](Rim).
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Disc, FlatGround, State, Stepper, StrangSplitting, UniformGravity};
///
/// // On the ground of the report's 120 points it rolls upright at 4 rad/s and stays as high as it was to a micrometre: the corners of such a ring are 170 µm high.
/// let stepper = Stepper::new(Disc::ring(1.0, 0.5, 120))? // kg, m
///     .with_gravity(UniformGravity::down(9.8))? // m/s²
///     .with_ground(FlatGround::level(1000.0, 0.5))? // N/m and N s/m, for each of 120 points
///     .with_integrator(StrangSplitting { time_step: 1e-3 })?; // s
/// let mut state = State::at(DVec3::Z * 0.49);
/// stepper.advance(&mut state, 20.0)?; // until it has sunk in
/// let height = state.position.z;
/// state = stepper.with_angular_velocity(state.with_linear_velocity(DVec3::NEG_Y * 2.0), DVec3::X * 4.0); // m/s, rad/s
/// stepper.advance(&mut state, 1.0)?;
/// assert!((state.position.z - height).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Points or a round rim
///
/// - Points are the report's coin, and the cheaper one. Take [`Coin`](super::Coin) to repeat the
///   report, for pictures, and where 0.1 mm or a few hundredths of g do not matter.
/// - The round rim has no corners to enter. It rolls without a rattle, methods of high order keep
///   their order, and one that chooses its steps has no touch-downs to find.
///
/// The tables compare a `Disc` that stands for 120 points of 1000 N/m and 0.5 N s/m, with 1 kg on
/// 0.5 m, with rings of n points that have as much stiffness and damping on the whole rim: where
/// they come to in the report's trials (slip speed 1 mm/s), and how they roll upright at 4 rad/s.
/// `cargo run --release --example round_rim` prints them, `.ci/instructions` the counts.
///
/// | distance from the round rim, m | trial 1, 1 s | 5 s | trial 5, 1 s | 5 s | trial 8, 1 s | 5 s |
/// |---|---|---|---|---|---|---|
/// | 12 points | 1.6e-1 | 7.8e-1 | 1.5e-1 | 8.7e-1 | 2.9e-1 | 7.9e-1 |
/// | 120 points | 6.5e-5 | 1.8e-3 | 2.3e-3 | 2.9e-2 | 2.4e-3 | 5.5e-2 |
/// | 1200 points | 5.8e-7 | 6.8e-6 | 1.1e-5 | 4.7e-5 | 4.2e-6 | 4.7e-4 |
///
/// | upright, 4 rad/s | vertical acceleration, rms, over g | energy lost in 1 s with dampers and friction, J | instructions of a step of `SymplecticEuler`, start of trial 1 |
/// |---|---|---|---|
/// | 12 points | 2.4e0 | 0.2936 | 678 |
/// | 120 points | 7.0e-3 | 0.0430 | 990 |
/// | 1200 points | 2.1e-4 | 0.0431 | 4012 |
/// | round | 4.8e-14 | 0.0431 | 1614 |
///
/// In instructions a step of `SymplecticEuler` on the round rim costs 1.6 times that of 120 points
/// at the start of trial 1, and no more in flight; where the coin tumbles, so that friction
/// reverses on the arc and twice as many points and more are needed there, 5.4 times. One of
/// [`EnergyMomentum`](crate::EnergyMomentum) costs 5.5 and 4.4 times as much
/// (`cargo bench --bench ratios`).
///
/// How far the place of the round coin is off after a second of trial 1:
///
/// | steps of | [`Rk4`](crate::Rk4) | [`Nystrom`](crate::Nystrom) | [`StrangSplitting`](crate::StrangSplitting) | [`EnergyMomentum`](crate::EnergyMomentum) |
/// |---|---|---|---|---|
/// | 10 ms | 1e-4 m | 1e-5 m | 1e-3 m | 8e-4 m |
/// | 5 ms | 4e-6 m | 4e-7 m | 2e-4 m | 2e-4 m |
/// | 2 ms | 4e-8 m | 1e-8 m | 3e-5 m | 4e-5 m |
/// | 1 ms | 3e-9 m | 7e-10 m | 8e-6 m | 2e-5 m |
/// | 0.2 ms | 6e-12 m | 1e-12 m | 3e-7 m | 5e-6 m |
///
/// # Limits
///
/// - The arc is that below a plane. On [`Terrain`](crate::Terrain) it is the one that touches the
///   ground under the lowest place: good while half an arc is short beside the ground's radius of
///   curvature, and one arc alone. There the springs' energy is not quite their work, and the
///   energy limiter of `EnergyMomentum` holds what is lacking.
/// - With explicit methods forces are the integral of the laws over the arc to 2e-7 of themselves,
///   and mostly to 1e-9. They are less accurate where dampers hold back the lowest place and both
///   ends, so that only a short part between them pushes. `EnergyMomentum` has eight points between
///   kinks: where friction reverses on the arc, that leaves up to 1e-3 of the load, and 6e-3 for a
///   slip speed of 1e-10 m/s. So it does not tend to the same limit as its steps get shorter.
/// - The limit of many points is reached with the square of their number, if the points' contacts
///   are resolved in time. A ring that spins upright on the spot is an exception: the same points
///   stay about the lowest place, where friction reverses, and the limit is reached in proportion
///   to the number of points until their distance times the spin is below the slip speed.
/// - Each point that touches down is a jump of its damper's force. A fixed step adds an error in
///   proportion to the step size to the place of a ring of points, not to that of the round rim.
/// - `EnergyMomentum` is of order 2 on it without dampers; with those of the report it is of order
///   1 below steps of 2 ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc<R: Real = f64> {
    mass: R,
    /// About the normal, over `m r²`; that about a diameter is half of it.
    shape: R,
    rim: [Rim<R>; 1],
}

impl<R: Real> Disc<R> {
    /// A thin ring: moments `m r²` about the normal and `m r²/2` about a diameter. Mass in kg,
    /// radius in m; its rim stands for so many points on the ground.
    ///
    /// It is [`Coin::ring`](super::Coin::ring) with a round rim, on the same ground.
    #[must_use]
    pub fn ring(mass: R, radius: R, points: usize) -> Self {
        Self::with_shape(mass, radius, points, R::ONE)
    }

    /// A homogeneous disc, much thinner than wide: moments `m r²/2` about the normal and `m r²/4`
    /// about a diameter. Mass in kg, radius in m; its rim stands for so many points on the ground.
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

    /// How many points the rim stands for.
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

    /// The face that looks up.
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
    fn contacts(&self) -> &[ContactPoint<R>] {
        &[]
    }
    #[inline]
    fn rims(&self) -> &[Rim<R>] {
        &self.rim
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the disc", self.mass, " kg")
    }
}
