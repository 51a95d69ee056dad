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
//! has no stable step and is left out.
//!
//! The other methods do not multiply by a function of `h λ` if K and C have different eigenvectors,
//! or complex frequencies.
//! Every solution satisfies `λ² + δ λ + κ = 0` with the Rayleigh quotients `κ = x* K x` and
//! `δ = x* C x` (in coordinates where M = 1). If K and C are symmetric, the pairs (κ, δ) therefore
//! lie in the joint numerical range of K and C, which is convex. The amplification factor of a step
//! of `SymplecticEuler` solves a quadratic eigenvalue problem in the same matrices. In that of
//! Strang splitting the mass is `(1 - h C/2)⁻¹`, whose quotient is at least `1/(1 - h δ/2)`.
//!
//! The upper side of that range is enclosed by its supporting lines: the largest eigenvalue of
//! `p K + q C` bounds `p κ + q δ` (`outline`). The limit is the smallest of the scalar limits of
//! the modes and along the outline. The lower side matters to methods that amplify oscillations: a
//! softer motion may have less damping than the stiffest. There the modes alone count.
//!
//! The derivative of friction with respect to the load, `f`, makes K and the first part of C
//! non-symmetric by the same factors. The outline has two limiting cases:
//!
//! * While the body slides, both matrices have the same eigenvectors, and the spectral radius
//!   replaces the largest eigenvalue.
//! * Where the damping by friction is strong, it holds the contact along the surface. The normal
//!   stiffness is then at most the stiffness without `f`.
//!
//! The outline counts in both cases. It is not proven for the intermediate one, where the damping
//! by friction across the slip, `μ N/slip`, is comparable with the damping or the stiffness along
//! the normal: a slip near the slip speed, or a small load. Two effects are neglected: the rotation
//! of lever arms and normals under load (of relative size depth/arm), and the gyroscopic torque.

mod matrix;
mod modes;
mod outline;
mod response;

use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

use modes::each_mode;
use outline::{least_along, outline};
use response::{Friction, Response};

/// Longest stable step of a method at a state, s, from its scalar `limit(κ, δ)`, s. `None` if there
/// is no bound.
pub(crate) fn largest_stable_step<R: Real>(
    scene: &impl Dynamics<R>,
    state: &State<R>,
    limit: impl Fn(R, R) -> Option<R>,
) -> Option<R> {
    // A method without a limit needs no evaluation of the contacts.
    limit(R::ONE, R::ONE)?;
    if state.not_finite().is_some() {
        return None;
    }
    let response = Response::at(scene, state, Friction::GrowsWithLoad);
    let modes = Modes::of(&response, &limit);
    let mut least = least_along(&outline(&response, modes.least_ratio), &limit)?;
    least = least.at_most(modes.limit);
    if response.is_coupled {
        let response = Response::at(scene, state, Friction::HasNoLoad);
        let modes = Modes::of(&response, &limit);
        least = least.at_most(least_along(&outline(&response, modes.least_ratio), &limit)?);
    }
    (least < R::MAX).then_some(least)
}

/// What the modes of a response say of the step.
struct Modes<R> {
    /// Smallest limit of a mode, s.
    limit: R,
    /// Smallest ratio of damping to stiffness of a mode that oscillates, s.
    least_ratio: R,
}

impl<R: Real> Modes<R> {
    fn of(response: &Response<R>, limit: &impl Fn(R, R) -> Option<R>) -> Self {
        let mut modes = Self {
            limit: R::MAX,
            least_ratio: R::MAX,
        };
        each_mode(
            &response.stiffness,
            &response.damping,
            |[stiffness, damping]| {
                if let Some(step) = limit(stiffness, damping) {
                    modes.limit = modes.limit.at_most(step);
                }
                if stiffness > R::ZERO {
                    modes.least_ratio = modes.least_ratio.at_most(damping / stiffness);
                }
            },
        );
        modes
    }
}
