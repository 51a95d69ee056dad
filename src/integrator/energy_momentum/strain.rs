//! Strain of friction and dampers in a step: whether the step resolves them.
//!
//! A contact that resists a velocity `u` with the force `c u` slows it as `e^-z` in a step, with
//! `z = h c/M`. The effective mass `M` of a contact with the arm `r` and the normal `n` is
//! `1/M = 1/m + (r × n)·J⁻¹ (r × n)`. Several dampers slow each motion of the body, and the fastest
//! of these has the largest eigenvalue of `M⁻¹ Σ cᵢ uᵢ uᵢᵀ`, with the mass matrix `M` and
//! `uᵢ = (nᵢ, rᵢ × nᵢ)`. It follows by the power method, in a few passes over the contacts.
//!
//! Friction is computed with the mass `m` of the body. Its slip is of the size of the slip speed.

use super::contacts::Contacts;
use super::problem::Problem;
use super::resist::MOST_OF_PRECISION;
use super::touch::Push;
use crate::body::InertiaProperties;
use crate::friction::FrictionJacobian;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::scene::Dynamics;
use crate::state::State;

/// Passes of the power method. They find an eigenvalue that is twice the next one to
/// 0.4 %, from a start that contains both equally.
const PASSES: u32 = 4;

/// Resistance of all contacts to sliding and to closing, N s/m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain<R> {
    pub(super) contacts: R,
    pub(super) friction: R,
    pub(super) damping: R,
}

impl<R: Real> Strain<R> {
    pub(super) const NONE: Self = Self {
        contacts: R::ZERO,
        friction: R::ZERO,
        damping: R::ZERO,
    };

    #[inline]
    pub(super) fn add(&mut self, push: &Push<R>, jacobian: &FrictionJacobian<R>) {
        self.contacts += R::ONE;
        self.friction += jacobian.coefficient;
        self.damping += push.mean.damping;
    }

    /// Strain of the stored contacts at the trial for which they were last evaluated, with that of
    /// the `others`.
    pub(super) fn at<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        others: Self,
    ) -> Self {
        let mut strain = others;
        contacts.recall(problem, |touch, jacobian| strain.add(&touch.push, jacobian));
        strain
    }

    /// Impulse of friction (N s) over a path (m) along the ground, if the slope of friction is that
    /// of stick.
    #[inline]
    pub(super) fn friction_over(&self, path: R) -> R {
        self.friction * path
    }

    /// Strain of friction and dampers in a step, `z = h Σc/m`, as for contacts without an arm. A
    /// step does not resolve a strain above 2.
    #[inline]
    pub(super) fn of_step<D>(&self, problem: &Problem<'_, R, D>) -> Self {
        let factor = problem.seconds / problem.mass;
        Self {
            friction: self.friction * factor,
            damping: self.damping * factor,
            ..*self
        }
    }

    /// Returns the strain in a step with that of dampers for the effective masses of their
    /// contacts, at the orientation of the `end`. It is computed only if it may exceed 2.
    #[inline]
    pub(super) fn with_arms<D: Dynamics<R>>(
        self,
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        end: &State<R>,
    ) -> Self {
        let properties = problem.scene.inertia_properties();
        if self.damping * largest_leverage(properties, problem.bounding_radius) <= R::TWO {
            return self;
        }
        Self {
            damping: self.damping * joint_leverage(properties, contacts, end),
            ..self
        }
    }

    /// Returns true if neither friction nor a damper resists.
    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.friction == R::ZERO && self.damping == R::ZERO
    }

    /// Returns true if the dampers hide the inertia in the rounding of their force. A trial may
    /// then pass for a solution whatever its momentum is.
    #[inline]
    pub(super) fn hides_inertia(&self) -> bool {
        self.damping * R::EPSILON > R::from_f64(MOST_OF_PRECISION)
    }

    #[inline]
    pub(super) fn is_resolved(&self) -> bool {
        self.friction <= R::TWO && self.damping <= R::TWO
    }
}

/// Strain of all dampers over that of dampers without an arm, at least 1.
///
/// The stored contacts are a sample, if there are more. The function does not depend on the type of
/// the scene, so that it is compiled once.
#[cold]
#[inline(never)]
fn joint_leverage<R: Real>(
    properties: &InertiaProperties<R>,
    contacts: &Contacts<R>,
    end: &State<R>,
) -> R {
    let axes = end.rotation().axes();
    let (mut sum, mut largest, mut start) = (R::ZERO, R::ZERO, Along::NONE);
    for push in damped(contacts) {
        let along = Along::of(push);
        sum += push.mean.damping;
        let strain = push.mean.damping * leverage(properties, &axes, &along);
        if strain > largest {
            (largest, start) = (strain, along);
        }
    }
    let mut motion = start.per_inertia(properties, &axes);
    let mut rate = largest;
    for _ in 0..PASSES {
        let resisted = damped(contacts).fold(Along::NONE, |resisted, push| {
            let along = Along::of(push);
            resisted.plus(&along, push.mean.damping * along.dot(&motion))
        });
        let slowed = resisted.per_inertia(properties, &axes);
        let growth = resisted.dot(&slowed) / resisted.dot(&motion);
        // It is NaN if no damper acts.
        if !growth.is_finite() || growth <= R::ZERO {
            break;
        }
        rate = growth * properties.mass();
        motion = Along::NONE.plus(&slowed, R::ONE / growth);
    }
    (rate / sum).at_least(R::ONE)
}

/// The contacts that are stored and push.
fn damped<R: Real>(contacts: &Contacts<R>) -> impl Iterator<Item = &Push<R>> {
    (contacts.stored().iter())
        .map(|touch| &touch.push)
        .filter(|push| push.is_active())
}

/// A force and its torque about the centre of mass, or a velocity and an angular velocity.
#[derive(Clone, Copy)]
pub(super) struct Along<R: Real> {
    normal: R::Vec3,
    turning: R::Vec3,
}

impl<R: Real> Along<R> {
    const NONE: Self = Self {
        normal: R::Vec3::ZERO,
        turning: R::Vec3::ZERO,
    };

    /// Unit force at the end of an arm, m.
    pub(super) fn at(arm: R::Vec3, normal: R::Vec3) -> Self {
        Self {
            normal,
            turning: arm.cross(normal),
        }
    }

    /// Unit force of a contact.
    fn of(push: &Push<R>) -> Self {
        Self::at(push.end_arm - push.normal * push.radius, push.normal)
    }

    fn dot(&self, other: &Self) -> R {
        self.normal.dot(other.normal) + self.turning.dot(other.turning)
    }

    fn plus(self, other: &Self, factor: R) -> Self {
        Self {
            normal: self.normal + other.normal * factor,
            turning: self.turning + other.turning * factor,
        }
    }

    /// Change of the velocities by an impulse.
    #[inline(never)]
    fn per_inertia(self, properties: &InertiaProperties<R>, axes: &Axes<R>) -> Self {
        Self {
            normal: self.normal * properties.inverse_mass(),
            turning: properties.angular_velocity(axes, self.turning),
        }
    }
}

/// Mass of the body over the effective mass of a contact, at least 1.
#[inline]
pub(super) fn leverage<R: Real>(
    properties: &InertiaProperties<R>,
    axes: &Axes<R>,
    along: &Along<R>,
) -> R {
    properties.mass() * along.dot(&along.per_inertia(properties, axes))
}

/// Upper bound of the [`leverage`] of any contact of a body.
#[inline]
fn largest_leverage<R: Real>(properties: &InertiaProperties<R>, bounding_radius: R) -> R {
    let square = bounding_radius * bounding_radius;
    R::ONE + properties.mass() * square * properties.largest_inverse_moment()
}
