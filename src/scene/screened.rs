//! Scene whose laws are screened while a step evaluates them.
//!
//! Each value that a law returns is tested by a comparison that a broken contract fails. An
//! overflow or rounding may fail it too. A failed test sets a flag, and the step goes on. The
//! stepper then takes the step again with a [`DiagnosedScene`](super::DiagnosedScene), which tells
//! a broken contract from rounding.
//!
//! A method with several stages tests those of one stage ([`Dynamics::untested`]). It can miss a
//! value that is invalid at the pose of another stage only. A force that is not a number makes the
//! state invalid at any stage, which is an error too.
//!
//! A call in the loops over contacts would cost several times as much as the tests, so there is
//! only the flag. Sums of the violations without a branch take more instructions. For trusted laws
//! ([`SpringDamperGround::is_trusted`]) nothing of this is left in the program.

use core::cell::Cell;

use super::Dynamics;
use super::inspected::{InspectedForce, InspectedFriction, InspectedGround, Inspector, Slide};
use crate::body::InertiaProperties;
use crate::contact::{ContactModel, LoopOverLanes};
use crate::force::{Force, Wrench};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::{MeanForce, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Units in the last place by which a normal's length or its square may differ from 1: twice the
/// tolerance of `check_ground`.
pub(super) const NORMAL: f64 = 128.0;

/// Flag that a value has failed its test during a step.
///
/// It is raised by a branch, or in lanes by a count of the failed tests, without a branch.
#[derive(Default)]
pub(crate) struct Alarm<const IN_LANES: bool = false>(Cell<usize>);

impl<const IN_LANES: bool> Alarm<IN_LANES> {
    /// Returns true if a value has failed its test.
    #[inline(always)]
    pub(crate) fn is_raised(&self) -> bool {
        self.0.get() > 0
    }

    #[inline(always)]
    fn expect(&self, sound: bool) {
        if IN_LANES {
            self.0.set(self.0.get() + usize::from(!sound));
        } else if !sound {
            self.0.set(1);
        }
    }
}

impl<R: Real, const IN_LANES: bool> Inspector<R> for Alarm<IN_LANES> {
    #[inline(always)]
    fn surface(&self, surface: &Surface<R>, _point: R::Vec3, reach: R) {
        let off = (surface.normal.length_squared() - R::ONE).abs();
        let is_unit = off <= R::EPSILON * R::from_f64(NORMAL);
        // Farther away than the reach no contact touches, and the normal is not used.
        let is_far = surface.gap > reach;
        self.expect(is_far | (is_unit & (surface.gap >= -R::MAX)));
    }

    #[inline(always)]
    fn spring_force(&self, force: R, _depth: R) {
        self.expect(force.abs() <= R::MAX);
    }

    #[inline(always)]
    fn spring_energy(&self, energy: R, _depth: R) {
        self.expect(energy >= R::ZERO);
    }

    #[inline(always)]
    fn normal_force<G>(&self, ground: &G, force: R, depth: R, _closing_speed: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
        // An explicit method evaluates neither of the two, but the energy of its states does.
        let spring_force = ground.spring_force(depth);
        let energy = ground.spring_energy(depth);
        // NaN and infinity times 0 are NaN, so one comparison tests all three.
        let zero = (force + spring_force) * R::ZERO;
        self.expect(energy >= zero);
    }

    #[inline(always)]
    fn mean_force<G>(&self, _ground: &G, mean: &MeanForce<R>, _depths: [R; 2], _seconds: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
        self.expect(mean.force.abs() <= R::MAX);
    }

    #[inline(always)]
    fn friction<F>(&self, law: &F, force: R::Vec3, slide: &Slide<R>) -> R::Vec3
    where
        F: SlidingFriction<R> + ?Sized,
    {
        if !law.is_trusted() {
            self.expect(force.dot(slide.slip) <= R::ZERO);
        }
        force
    }

    #[inline(always)]
    fn resistance(&self, resistance: &RollingResistance<R>, _normal_force: R) {
        let is_torque = |torque: R| (torque >= R::ZERO) & (torque <= R::MAX);
        self.expect(is_torque(resistance.rolling));
        self.expect(is_torque(resistance.spinning));
        // At a turn speed of 0 the torque on a body at rest would be 0/0.
        let speed = resistance.turn_speed;
        self.expect((speed > R::ZERO) & (speed <= R::MAX));
    }

    #[inline(always)]
    fn wrench<E>(&self, force: &E, wrench: &Wrench<R>, motion: &Motion<R>)
    where
        E: Force<R> + ?Sized,
    {
        let power = wrench.power(motion);
        let bound = if force.is_passive() { R::ZERO } else { R::MAX };
        self.expect(wrench.is_finite() & (power <= bound));
    }
}

/// Scene with its laws screened.
pub(crate) struct ScreenedScene<'a, R: Real, D: Dynamics<R>> {
    scene: &'a D,
    ground: InspectedGround<'a, R, D::Ground, Alarm>,
    friction: InspectedFriction<'a, D::Friction, Alarm>,
    force: InspectedForce<'a, D::Force, Alarm>,
    alarm: &'a Alarm,
}

impl<'a, R: Real, D: Dynamics<R>> ScreenedScene<'a, R, D> {
    #[inline(always)]
    pub(crate) fn of(scene: &'a D, alarm: &'a Alarm) -> Self {
        Self {
            scene,
            ground: InspectedGround {
                ground: scene.ground(),
                reach: scene.bounding_radius(),
                inspector: alarm,
            },
            friction: InspectedFriction {
                friction: scene.friction(),
                inspector: alarm,
            },
            force: InspectedForce {
                force: scene.force(),
                inspector: alarm,
            },
            alarm,
        }
    }
}

impl<'a, R: Real, D: Dynamics<R>> Dynamics<R> for ScreenedScene<'a, R, D> {
    type Body = D::Body;
    type Ground = InspectedGround<'a, R, D::Ground, Alarm>;
    type Friction = InspectedFriction<'a, D::Friction, Alarm>;
    type Force = InspectedForce<'a, D::Force, Alarm>;
    type Untested = D::Untested;

    #[inline(always)]
    fn untested(&self) -> &D::Untested {
        self.scene.untested()
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        let model = self.scene.contact_model();
        model.with_laws(&self.ground, &self.friction)
    }
    #[inline(always)]
    fn gravity(&self) -> R::Vec3 {
        self.scene.gravity()
    }
    #[inline(always)]
    fn force(&self) -> &Self::Force {
        &self.force
    }
    #[inline(always)]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.scene.inertia_properties()
    }

    /// The tests of all lanes are counted in a variable of the loop.
    #[inline(always)]
    fn evaluate_in_lanes(&self, work: impl LoopOverLanes<R>) {
        let alarm = Alarm::<true>::default();
        let ground = InspectedGround {
            ground: self.scene.ground(),
            reach: self.ground.reach,
            inspector: &alarm,
        };
        let friction = InspectedFriction {
            friction: self.scene.friction(),
            inspector: &alarm,
        };
        work.run((&ground, &friction));
        self.alarm.expect(!alarm.is_raised());
    }

    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        let known = self.alarm.0.get();
        let value = evaluate();
        self.alarm.0.set(known);
        value
    }
}
