//! Stiffness and damping of the contacts of a state, and the longest step for which a method is
//! stable there.
//!
//! # Derivation
//!
//! Let `y` be a small displacement of the body (translation and rotation) and `M` its mass matrix.
//! A contact at lever arm `r` with normal `n` has a penetration depth that decreases by `g · y`,
//! where `g = (n, r × n)`. With stiffness `k`, damping `c` and friction force `F`, the linearised
//! equation of motion is
//!
//! ```text
//! M y'' + C y' + K y = 0
//! K = Σ k (g + f) gᵀ      f = (t, r × t), t = ∂F/∂N: friction grows with the load
//! C = Σ c (g + f) gᵀ + Σ d (e, r × e) (e, r × e)ᵀ      e: both directions along the surface
//! ```
//!
//! `N` is the normal force. `d` is the derivative of friction with respect to the slip,
//! `μ N/slip speed` in stick. The lever arm and the inertia enter through `M⁻¹`. A single contact
//! has `ω² = k (1/m + (r × n) · J⁻¹ (r × (n + t)))`.
//!
//! An applied force with the wrench `W(y, y')` adds `-∂W/∂y` to K and `-∂W/∂y'` to C. Its damping
//! needs no springs, as that of friction.
//!
//! A Runge-Kutta method multiplies the solution `e^(λ t) x` by a function of `h λ`. So it is stable
//! for the motion if it is stable for the oscillator `y'' + δ y' + κ y = 0` of each pair of
//! eigenvalues λ, with `κ = |λ|²` and `δ = -2 Re λ` (`modes`). This holds for any K and C, also
//! where sliding on several contacts makes the frequencies complex. A motion that grows by itself
//! has no stable step. It is left out if it grows by more than a tenth per rad.
//!
//! The other methods do not multiply by a function of `h λ` if K and C have different eigenvectors,
//! or complex frequencies. A step of such a method is a linear function of the coordinates and
//! velocities, and the method is stable while no eigenvalue of its matrix exceeds 1 in magnitude.
//! The limit is searched from short steps on, in parts of the limit of the modes (`amplification`).
//! Growth that rounding hides in these eigenvalues is taken from the modes. It matters to methods
//! that amplify an oscillation at every step size: their limit is where weak damping removes as
//! much.
//!
//! Two effects are neglected: the rotation of lever arms and normals under load (of relative size
//! depth/arm), and the gyroscopic torque.

mod amplification;
mod eigenvalues;
mod matrix;
mod modes;
mod motion;
mod response;

use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

use amplification::Amplification;
use modes::Modes;
pub use motion::LinearMotion;
pub(crate) use motion::ahead;
use response::Response;

/// Longest stable step of a method at a state, s. `None` if there is no bound.
///
/// `limit(κ, δ)` is the limit of the method for an oscillator, s. `step` takes its step of a linear
/// motion. It returns `None` if the limits of the modes are those of the motion.
pub(crate) fn largest_stable_step<R: Real>(
    scene: &impl Dynamics<R>,
    state: &State<R>,
    limit: impl Fn(R, R) -> Option<R>,
    step: impl Fn(&LinearMotion, [[f64; 6]; 2], f64) -> Option<[[f64; 6]; 2]>,
) -> Option<R> {
    // A method without a limit needs no evaluation of the contacts.
    limit(R::ONE, R::ONE)?;
    if state.not_finite().is_some() {
        return None;
    }
    let motion = LinearMotion::of(&Response::at(scene, state))?;
    let modes = Modes::of(&motion, &limit);
    let steps_by_modes = step(&motion, [[0.0; 6]; 2], 1.0).is_none();
    if steps_by_modes {
        return motion.seconds(modes.limit);
    }
    if modes.scale == f64::INFINITY {
        return None;
    }
    let amplification = Amplification::new(&motion, &modes, |start, size| {
        step(&motion, start, size).unwrap_or(start)
    });
    motion.seconds(amplification.largest_step())
}
