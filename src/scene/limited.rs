//! Scene whose friction is limited to what a step of an explicit method resolves.
//!
//! Friction acts like a damper `c = |f|/|slip|` at each contact. An explicit step of `h` amplifies
//! the slip of a contact that sticks, if `c` times the mobility `w` of the contact exceeds `z/h`.
//! Here `z` is the limit of stability of the method on the negative real axis. In such a step each
//! of the `n` contacts has at most the damper `z/(h w n)`. So the step is stable, whatever the slip
//! speed of the law. Contacts that slide are not affected, to the last bit.
//!
//! The friction that is removed is summed, so that an estimate of the error can contain it. A
//! contact with a slip of exactly 0 has no friction, and loses none. An example is the lowest point
//! of a coin that spins upright on the spot.

use core::cell::Cell;

use super::inspected::{InspectedFriction, Inspector, Slide};
use super::{Dynamics, mobility};
use crate::body::InertiaProperties;
use crate::contact::ContactModel;
use crate::friction::SlidingFriction;
use crate::real::{Real, Vector};

/// Contact at which friction acts like the largest damper.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stiffest<R> {
    /// Square of the damper, (N s/m)².
    damper: R,
    /// Square of the friction, N².
    friction: R,
}

impl<R: Real> Stiffest<R> {
    /// Returns the acceleration of the farthest point that the friction of this contact causes at
    /// most, m/s².
    #[inline]
    pub(crate) fn acceleration<D: Dynamics<R>>(&self, scene: &D) -> R {
        self.friction.sqrt() * mobility(scene)
    }
}

/// Largest damper that friction may have at one contact, and what it had.
pub(crate) struct FrictionLimit<R> {
    /// Square of the largest damper, (N s/m)².
    largest: R,
    stiffest: Cell<Stiffest<R>>,
    /// Sum of the forces that were removed, N.
    removed: Cell<R>,
}

impl<R: Real> FrictionLimit<R> {
    /// Returns the limit for a step of `seconds` with a number of contacts.
    ///
    /// `stable` is the largest stable product of the step size and a damping rate.
    #[inline]
    pub(crate) fn of<D: Dynamics<R>>(scene: &D, seconds: R, contacts: usize, stable: f64) -> Self {
        let rate = seconds * mobility(scene) * R::from_f64(contacts as f64);
        let damper = R::from_f64(stable) / rate;
        Self::with_largest(damper * damper)
    }

    /// Returns no limit, which still records the friction.
    #[inline]
    pub(crate) fn none() -> Self {
        // Infinite. A comparison with infinity times 0 is false.
        Self::with_largest(R::ONE / R::ZERO)
    }

    #[inline]
    fn with_largest(largest: R) -> Self {
        Self {
            largest,
            stiffest: Cell::new(Stiffest::default()),
            removed: Cell::new(R::ZERO),
        }
    }

    /// Returns true if there is a limit.
    #[inline]
    pub(crate) fn applies(&self) -> bool {
        self.largest.is_finite()
    }

    /// Returns true if the limit changes the friction of a contact.
    #[inline]
    pub(crate) fn changes(&self, contact: &Stiffest<R>) -> bool {
        contact.damper > self.largest
    }

    /// Begins the search for the stiffest contact, and the sum of the friction that is removed,
    /// again.
    #[inline]
    pub(crate) fn search(&self) {
        self.stiffest.set(Stiffest::default());
        self.removed.set(R::ZERO);
    }

    /// Returns the stiffest contact since the search began.
    #[inline]
    pub(crate) fn stiffest(&self) -> Stiffest<R> {
        self.stiffest.get()
    }

    /// Returns the acceleration of the farthest point by all friction that was removed since the
    /// search began, m/s². Each evaluation of a contact adds what it has removed.
    #[inline]
    pub(crate) fn removed<D: Dynamics<R>>(&self, scene: &D) -> R {
        self.removed.get() * mobility(scene)
    }

    #[inline(always)]
    fn limited(&self, force: R::Vec3, slip: R::Vec3) -> R::Vec3 {
        let (friction, square) = (force.length_squared(), slip.length_squared());
        if friction > self.stiffest.get().damper * square {
            let damper = friction / square;
            self.stiffest.set(Stiffest { damper, friction });
        }
        if friction > self.largest * square {
            self.reduced(force, self.largest * square / friction)
        } else {
            force
        }
    }

    #[inline(never)]
    fn reduced(&self, force: R::Vec3, square: R) -> R::Vec3 {
        let fraction = square.sqrt();
        let removed = force.length() * (R::ONE - fraction);
        self.removed.set(self.removed.get() + removed);
        force * fraction
    }
}

impl<R: Real> Inspector<R> for FrictionLimit<R> {
    #[inline(always)]
    fn friction<F>(&self, _law: &F, force: R::Vec3, slide: &Slide<R>) -> R::Vec3
    where
        F: SlidingFriction<R> + ?Sized,
    {
        self.limited(force, slide.slip)
    }
}

/// Scene with a [`FrictionLimit`].
pub(crate) struct LimitedScene<'a, R: Real, D: Dynamics<R>> {
    scene: &'a D,
    friction: InspectedFriction<'a, D::Friction, FrictionLimit<R>>,
}

impl<'a, R: Real, D: Dynamics<R>> LimitedScene<'a, R, D> {
    #[inline(always)]
    pub(crate) fn of(scene: &'a D, limit: &'a FrictionLimit<R>) -> Self {
        let friction = scene.friction();
        Self {
            scene,
            friction: InspectedFriction {
                friction,
                inspector: limit,
            },
        }
    }

    #[inline(always)]
    pub(crate) fn limit(&self) -> &'a FrictionLimit<R> {
        self.friction.inspector
    }
}

impl<'a, R: Real, D: Dynamics<R>> Dynamics<R> for LimitedScene<'a, R, D> {
    type Body = D::Body;
    type Ground = D::Ground;
    type Friction = InspectedFriction<'a, D::Friction, FrictionLimit<R>>;
    type Force = D::Force;
    type Untested = Self;

    #[inline(always)]
    fn untested(&self) -> &Self {
        self
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        let model = self.scene.contact_model();
        model.with_laws(model.ground(), &self.friction)
    }
    #[inline(always)]
    fn gravity(&self) -> R::Vec3 {
        self.scene.gravity()
    }
    #[inline(always)]
    fn force(&self) -> &Self::Force {
        self.scene.force()
    }
    #[inline(always)]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.scene.inertia_properties()
    }
    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        self.scene.probe(evaluate)
    }
}
