//! Coin with a thickness and two round rims.

use super::coin::{inertia_of_thick, tilt};
use super::{CoinFace, ContactPoint, RigidPointBody, Rim};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::State;

/// Coin with a thickness: a homogeneous cylinder whose contacts are the whole circles of its two
/// rims.
///
/// It can lie on a face, roll on one rim, roll on both, and stand on its edge. It is a
/// [`SolidCoin`](super::SolidCoin) in the limit of many points.
///
/// Body axes: the normal is x. The rims are at `x = ±thickness/2`. Moments: `m r²/2` about the
/// normal, `m (3 r² + h²)/12` about a diameter, with the thickness h.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{CoinFace, EnergyMomentum, FlatGround, State, Stepper, ThickDisc, UniformGravity};
///
/// // A coin of 20 mm x 2 mm stands on its edge, and sinks in by some micrometres.
/// let coin = ThickDisc::solid(5e-3, 10e-3, 2e-3, 48); // kg, m, m
/// let stepper = Stepper::builder(coin)
///     .gravity(UniformGravity::down(9.81)) // m/s²
///     .ground(FlatGround::level(2e4, 1.0)) // N/m and N s/m, for each of 48 points a rim
///     .integrator(EnergyMomentum { time_step: 1e-4 }) // s
///     .build()?;
/// let mut state = State::at(DVec3::Z * 10e-3); // m
/// stepper.advance(&mut state, 0.1)?; // s
/// assert_eq!(coin.face_up(&state), CoinFace::Edge);
/// let depth = 10e-3 - state.position.z;
/// assert!(depth > 1e-6 && depth < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Limits
///
/// - Each rim is a line. The cylinder's side between the rims and its faces have no contact of
///   their own. They never touch a plane without a rim, but they do touch a narrow post or a hill
///   shorter than the coin.
/// - The accuracy on each rim is that of a [`Disc`](super::Disc), whose limits hold here too.
/// - The edge is sharp. A coin with a bevel stands less well.
/// - On a plane at rest, the coin of thickness h and radius r stands on its edge only if its lowest
///   points penetrate by less than `3 h²/(8 r)`, for thin coins: to 1 % up to a thickness of a
///   fifth of the radius. A coin as thick as its radius stands up to 1.11 of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThickDisc<R: Real = f64> {
    mass: R,
    thickness: R,
    /// The rim at -x and the one at +x.
    rims: [Rim<R>; 2],
}

impl<R: Real> ThickDisc<R> {
    /// Creates a homogeneous cylinder. Mass in kg, radius and thickness in m.
    ///
    /// Each of the two rims represents `points` points on the ground.
    #[must_use]
    pub fn solid(mass: R, radius: R, thickness: R, points: usize) -> Self {
        let normal = R::Vec3::new(R::ONE, R::ZERO, R::ZERO);
        let half = thickness * R::HALF;
        let rim = |side: R| Rim::new(normal * side, normal, radius, points);
        Self {
            mass,
            thickness,
            rims: [rim(-half), rim(half)],
        }
    }

    /// Number of points that each rim represents.
    #[cfg(feature = "serde")]
    pub(super) fn points(&self) -> usize {
        let [rim, _] = &self.rims;
        rim.points().floor_index()
    }

    /// Radius, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        let [rim, _] = &self.rims;
        rim.radius()
    }

    /// Thickness, m.
    #[inline]
    #[must_use]
    pub fn thickness(&self) -> R {
        self.thickness
    }

    /// Angle between the coin's plane and the horizontal, rad: π/2 upright, 0 flat on either face.
    #[must_use]
    pub fn tilt(&self, state: &State<R>) -> R {
        tilt(state)
    }

    /// Face that points up if the coin comes to rest from here without bouncing.
    ///
    /// Returns [`CoinFace::Edge`] if the centre of mass is above the edge, that is if
    /// `r |n_z| < (h/2) √(1 - n_z²)` with the normal n.
    #[must_use]
    pub fn face_up(&self, state: &State<R>) -> CoinFace {
        CoinFace::of_thick(self.radius(), self.thickness, state)
    }
}

impl<R: Real> RigidPointBody<R> for ThickDisc<R> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }

    #[inline]
    fn inertia(&self) -> R::Mat3 {
        inertia_of_thick(self.mass, self.radius(), self.thickness)
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
        &self.rims
    }

    #[inline]
    fn bounding_radius(&self) -> R {
        let half = self.thickness * R::HALF;
        (self.radius() * self.radius() + half * half).sqrt()
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the coin", self.mass, " kg")?;
        error::above_zero("radius of the coin", self.radius(), " m")?;
        error::above_zero("thickness of the coin", self.thickness, " m")
    }
}
