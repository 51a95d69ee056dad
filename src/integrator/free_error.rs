//! The error of a Runge-Kutta method in torque-free rotation, which its steps leave out.
//!
//! A step that adds quaternions has two errors: that of the torques, and that which it would have
//! without any torque. The second is the larger one in flight. For three different moments, next to
//! the middle axis, the motion amplifies it. It is known. The same step in a scene without forces
//! ends at an orientation `q_f`, and the exact rotation
//! ([`turn_freely`](crate::InertiaProperties::turn_freely)) at `q_e`. So the end `q` of the step
//! becomes
//!
//! ```text
//! q (q_f⁻¹ q_e)^w
//! ```
//! The weight `w` is 1 in flight, where `q = q_f`, so that the result is exact there. It decreases
//! with the change of the angular momentum in the step, and is 0 from 1/4096 of it. A contact then
//! causes the larger error, and a correction would only cost time. The correction is of the order
//! of the method's local error. So the order stays, and the end of a step is a continuous function
//! of the torques.
//!
//! *Estimate:* an adaptive method compares two ends, which differ by `d`, and by `d_f` in the step
//! without torques. Both ends have the same `q_e`. To first order the corrected ends are
//! `q - w (q_f - q_e)`, so they differ by `d - w d_f`.
//!
//! The estimate needs `w d_f` all the same where a contact may come into reach, because the stages
//! of the method have that error. Without torques `2T = ω·L = Σ j L²` is constant. Let `j` be the
//! largest inverse moment. Then
//!
//! ```text
//! |ω|² = Σ j² L² ≤ j 2T      |ω'| ≤ j |L × ω| = j √(L² |ω|² - (2T)²) ≤ j √(2T (j L² - 2T))
//! ```
//! at any time. So the acceleration `a` of a point has a bound, and between two ends of a step `h`
//! the gap of a contact is at most `a h²/8` below the smaller one of its gaps at the ends.
//!
//! *Bodies:* adaptive methods correct any body, because the error of their steps is to be within a
//! tolerance. With two or three equal moments it is corrected if there is no torque at all, or an
//! applied force. The small torque of a contact causes the larger error. [`Rk4`](crate::Rk4) and
//! [`Nystrom`](crate::Nystrom) correct the bodies whose rotation
//! [amplifies the error](amplifies_errors): those with three different moments, and those whose
//! moment about the axis of symmetry is the smallest. The steps of others have the same bits
//! [in lanes](crate::Stepper::advance_many).

use crate::contact::Motion;
use crate::force::Force;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, TorqueFree, amplifies_errors, is_asymmetric};

/// Relative change of the angular momentum in a step above which the error of the contacts is the
/// larger one.
const SMALL: f64 = 1.0 / 4096.0;

/// Returns the weight `w` for two angular momenta, which is above 0 in a nearly free step that is
/// corrected. It is NaN for a body without angular momentum.
#[inline]
pub(in crate::integrator) fn weight<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [R::Vec3; 2],
) -> R {
    let weight = R::ONE - (end - start).length() / (start.length() * R::from_f64(SMALL));
    let is_corrected = weight == R::ONE || is_asymmetric(scene) || scene.force().acts();
    if is_corrected { weight } else { R::ZERO }
}

/// A step that hardly changes the angular momentum.
pub(in crate::integrator) struct NearlyFree<R: Real> {
    /// The weight `w`, above 0 and at most 1.
    pub(in crate::integrator) weight: R,
    /// The exact end `q_e` without torques.
    pub(in crate::integrator) exact: Rotation<R>,
}

impl<R: Real> NearlyFree<R> {
    /// Compares the ends of a step. Returns `None` if the torques change the angular momentum by
    /// more than a small part, or if there is none.
    #[inline]
    pub(in crate::integrator) fn of<D: Dynamics<R>>(
        scene: &D,
        start: &Point<R>,
        end: &Point<R>,
        seconds: R,
    ) -> Option<Self> {
        let (rotation, momentum) = (start.orientation, start.angular_momentum);
        let weight = weight(scene, [momentum, end.angular_momentum]);
        // False for a body without angular momentum, too.
        let is_nearly_free = weight > R::ZERO;
        is_nearly_free.then(|| {
            let inertia = scene.inertia_properties();
            let exact = inertia.turn_freely(rotation, &rotation.axes(), momentum, seconds);
            Self { weight, exact }
        })
    }

    /// Returns true if there are no torques.
    ///
    /// Torques below the rounding of the momentum do not change the rotation. Torques of the stages
    /// that cancel to the last bit, which no scene is known to have, would count as none.
    #[inline]
    pub(in crate::integrator) fn is_free(&self) -> bool {
        self.weight == R::ONE
    }

    /// Returns the end `q` of the step without the error of the end `q_f`.
    #[inline]
    pub(in crate::integrator) fn corrected(
        &self,
        end: Rotation<R>,
        free_end: Rotation<R>,
    ) -> Rotation<R> {
        let error = free_end.inverse().after(self.exact);
        end.after(error.part(self.weight)).normalised()
    }
}

/// Bodies whose rotation a method gets wrong without torques.
#[derive(Clone, Copy, PartialEq)]
pub(in crate::integrator) enum Bodies {
    /// Those whose rotation amplifies the error.
    Amplifying,
    All,
}

/// Returns the orientation at the `end` of a step of `seconds`, without the error that its method
/// makes in the torque-free rotation of these `bodies`.
///
/// `by_method` returns the orientation after the same step in another scene.
#[inline(always)]
pub(in crate::integrator) fn removed<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, end): (&Point<R>, &Point<R>),
    seconds: R,
    bodies: Bodies,
    by_method: impl FnOnce(&TorqueFree<'_, D>, &Point<R>, R) -> Rotation<R>,
) -> Rotation<R> {
    if bodies == Bodies::All || amplifies_errors(scene) {
        // Copies, because references would keep both points in memory through the whole step.
        corrected(scene, &{ *start }, &{ *end }, seconds, by_method)
    } else {
        end.orientation
    }
}

#[inline(never)]
fn corrected<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Point<R>,
    end: &Point<R>,
    seconds: R,
    by_method: impl FnOnce(&TorqueFree<'_, D>, &Point<R>, R) -> Rotation<R>,
) -> Rotation<R> {
    let Some(free) = NearlyFree::of(scene, start, end, seconds) else {
        return end.orientation;
    };
    if free.is_free() {
        return free.exact;
    }
    let free_end = by_method(&TorqueFree(scene), start, seconds);
    free.corrected(end.orientation, free_end)
}

/// Returns true if no contact can come into reach in a nearly free step between two ends.
///
/// The angular momentum is that of the start. The acceleration is that of the centre of mass, m/s².
pub(in crate::integrator) fn is_out_of_reach<R: Real, D: Dynamics<R>>(
    scene: &D,
    ends: [&Motion<R>; 2],
    (angular_momentum, acceleration): (R::Vec3, R),
    seconds: R,
) -> bool {
    let model = scene.contact_model();
    if model.surfaces() == 0 {
        return true;
    }
    let [start, _] = ends;
    let most = scene.inertia_properties().largest_inverse_moment();
    let energy = start.angular_velocity.dot(angular_momentum);
    let across = most * angular_momentum.length_squared() - energy;
    let bend = most * (energy + (energy * across.at_least(R::ZERO)).sqrt());
    let margin =
        (acceleration + bend * scene.bounding_radius()) * (seconds * seconds * R::from_f64(0.125));
    (0..model.surfaces()).all(|surface| {
        ends.iter().all(|end| {
            // The range is that of contacts alone.
            let near = model.range_of_surface(surface, margin, end.position, &end.axes);
            near.count == 0 && !model.has_rim_near(surface, margin, (end.position, &end.axes))
        })
    })
}
