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
//! only the flag. For trusted laws ([`SpringDamperGround::is_trusted`]) nothing of this is left in
//! the program.

use core::cell::Cell;

use super::Dynamics;
use crate::body::InertiaProperties;
use crate::contact::ContactModel;
use crate::force::{Force, ForcePower, Wrench};
use crate::friction::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::ground::{GroundBounds, GroundMotion, MeanForce, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Units in the last place by which the square of a normal's length may differ from 1: twice the
/// tolerance of `check_ground`.
pub(super) const NORMAL: f64 = 128.0;

/// Flag that a value has failed its test during a step.
#[derive(Default)]
pub(crate) struct Alarm(Cell<bool>);

impl Alarm {
    /// Returns true if a value has failed its test.
    #[inline(always)]
    pub(crate) fn is_raised(&self) -> bool {
        self.0.get()
    }

    #[inline(always)]
    fn expect(&self, sound: bool) {
        if !sound {
            self.0.set(true);
        }
    }
}

/// Scene with its laws screened.
pub(crate) struct ScreenedScene<'a, R: Real, D: Dynamics<R>> {
    scene: &'a D,
    ground: ScreenedGround<'a, R, D::Ground>,
    friction: ScreenedFriction<'a, D::Friction>,
    force: ScreenedForce<'a, D::Force>,
    alarm: &'a Alarm,
}

impl<'a, R: Real, D: Dynamics<R>> ScreenedScene<'a, R, D> {
    #[inline(always)]
    pub(crate) fn of(scene: &'a D, alarm: &'a Alarm) -> Self {
        Self {
            scene,
            ground: ScreenedGround {
                ground: scene.ground(),
                bounding_radius: scene.bounding_radius(),
                alarm,
            },
            friction: ScreenedFriction {
                friction: scene.friction(),
                alarm,
            },
            force: ScreenedForce {
                force: scene.force(),
                alarm,
            },
            alarm,
        }
    }
}

impl<'a, R: Real, D: Dynamics<R>> Dynamics<R> for ScreenedScene<'a, R, D> {
    type Body = D::Body;
    type Ground = ScreenedGround<'a, R, D::Ground>;
    type Friction = ScreenedFriction<'a, D::Friction>;
    type Force = ScreenedForce<'a, D::Force>;
    type Untested = D::Untested;

    #[inline(always)]
    fn untested(&self) -> &D::Untested {
        self.scene.untested()
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        let model = self.scene.contact_model();
        ContactModel {
            body: model.body,
            ground: &self.ground,
            friction: &self.friction,
            bounding_radius: model.bounding_radius,
            has_radii: model.has_radii,
        }
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

    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        let known = self.alarm.is_raised();
        let value = evaluate();
        self.alarm.0.set(known);
        value
    }
}

/// Ground whose values are screened.
pub(crate) struct ScreenedGround<'a, R, G: ?Sized> {
    ground: &'a G,
    /// Bounding radius of the body, m. No contact has a larger radius.
    bounding_radius: R,
    alarm: &'a Alarm,
}

impl<R: Real, G: SpringDamperGround<R> + ?Sized> SpringDamperGround<R>
    for ScreenedGround<'_, R, G>
{
    #[inline(always)]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let surface = self.ground.surface(point);
        if !self.ground.is_trusted() {
            let off = (surface.normal.length_squared() - R::ONE).abs();
            let is_unit = off <= R::EPSILON * R::from_f64(NORMAL);
            // Farther away than the bounding radius no contact touches, and the normal is not used.
            let is_far = surface.gap > self.bounding_radius;
            self.alarm
                .expect(is_far | (is_unit & (surface.gap >= -R::MAX)));
        }
        surface
    }

    #[inline(always)]
    fn spring_force(&self, depth: R) -> R {
        let force = self.ground.spring_force(depth);
        if !self.ground.is_trusted() {
            self.alarm.expect(force.abs() <= R::MAX);
        }
        force
    }

    #[inline(always)]
    fn spring_energy(&self, depth: R) -> R {
        let energy = self.ground.spring_energy(depth);
        if !self.ground.is_trusted() {
            self.alarm.expect(energy >= R::ZERO);
        }
        energy
    }

    #[inline(always)]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        let force = self.ground.normal_force(depth, closing_speed);
        if !self.ground.is_trusted() {
            // An explicit method evaluates neither of the two, but the energy of its states does.
            let spring_force = self.ground.spring_force(depth);
            let energy = self.ground.spring_energy(depth);
            // NaN and infinity times 0 are NaN, so one comparison tests all three.
            let zero = (force + spring_force) * R::ZERO;
            self.alarm.expect(energy >= zero);
        }
        force
    }

    #[inline(always)]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let mean = self.ground.mean_force(start, end, seconds);
        if !self.ground.is_trusted() {
            self.alarm.expect(mean.force.abs() <= R::MAX);
        }
        mean
    }

    #[inline(always)]
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }
    #[inline(always)]
    fn surfaces(&self) -> Option<usize> {
        self.ground.surfaces()
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        let (bounding_radius, alarm) = (self.bounding_radius, self.alarm);
        self.ground.with_surface(index, &mut |ground| {
            visit(&ScreenedGround {
                ground,
                bounding_radius,
                alarm,
            });
        });
    }
    #[inline]
    fn motion(&self) -> Option<GroundMotion<R>> {
        self.ground.motion()
    }

    #[inline(always)]
    fn is_trusted(&self) -> bool {
        self.ground.is_trusted()
    }
}

/// Friction law whose values are screened.
pub(crate) struct ScreenedFriction<'a, F: ?Sized> {
    friction: &'a F,
    alarm: &'a Alarm,
}

impl<F: ?Sized> ScreenedFriction<'_, F> {
    #[inline(always)]
    fn screen<R: Real>(&self, force: R::Vec3, slip: R::Vec3) -> R::Vec3
    where
        F: SlidingFriction<R>,
    {
        if !self.friction.is_trusted() {
            let power = force.dot(slip);
            self.alarm.expect(power <= R::ZERO);
        }
        force
    }

    #[inline(always)]
    fn screen_resistance<R: Real>(
        &self,
        resistance: Option<RollingResistance<R>>,
    ) -> Option<RollingResistance<R>>
    where
        F: SlidingFriction<R>,
    {
        if let (Some(values), false) = (&resistance, self.friction.is_trusted()) {
            let RollingResistance {
                rolling,
                spinning,
                turn_speed,
            } = values;
            let sound = [rolling, spinning, turn_speed].map(|&value| value >= R::ZERO);
            self.alarm.expect(sound[0] & sound[1] & sound[2]);
        }
        resistance
    }
}

impl<R: Real, F: SlidingFriction<R> + ?Sized> SlidingFriction<R> for ScreenedFriction<'_, F> {
    #[inline(always)]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.screen(self.friction.force(normal_force, slip), slip)
    }

    #[inline(always)]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.screen(self.friction.force_at(position, normal_force, slip), slip)
    }

    #[inline(always)]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        self.friction.jacobian(normal_force, slip)
    }

    #[inline(always)]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        self.friction.jacobian_at(position, normal_force, slip)
    }

    #[inline(always)]
    fn depends_on_position(&self) -> bool {
        self.friction.depends_on_position()
    }

    #[inline(always)]
    fn surfaces(&self) -> Option<usize> {
        self.friction.surfaces()
    }

    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        let alarm = self.alarm;
        self.friction.with_surface(index, &mut |friction| {
            visit(&ScreenedFriction { friction, alarm });
        });
    }

    #[inline(always)]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        self.screen_resistance(self.friction.rolling_resistance(normal_force))
    }

    #[inline(always)]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        self.screen_resistance(self.friction.rolling_resistance_at(position, normal_force))
    }

    #[inline(always)]
    fn is_trusted(&self) -> bool {
        self.friction.is_trusted()
    }
}

/// Applied force whose values are screened.
pub(crate) struct ScreenedForce<'a, E> {
    force: &'a E,
    alarm: &'a Alarm,
}

impl<R: Real, E: Force<R>> Force<R> for ScreenedForce<'_, E> {
    #[inline(always)]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let wrench = self.force.wrench(motion);
        if !self.force.is_trusted() {
            let power = wrench.power(motion);
            let bound = if self.force.is_passive() {
                R::ZERO
            } else {
                R::MAX
            };
            self.alarm.expect(wrench.is_finite() & (power <= bound));
        }
        wrench
    }

    #[inline(always)]
    fn is_passive(&self) -> bool {
        self.force.is_passive()
    }

    #[inline(always)]
    fn constant_force(&self) -> Option<R::Vec3> {
        self.force.constant_force()
    }

    #[inline(always)]
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        self.force.power(motion)
    }

    #[inline(always)]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        self.force
            .wrench_change(motion, linear_change, angular_change)
    }

    #[inline(always)]
    fn acts(&self) -> bool {
        self.force.acts()
    }

    #[inline(always)]
    fn is_trusted(&self) -> bool {
        self.force.is_trusted()
    }
}
