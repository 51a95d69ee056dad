//! Scene whose laws are examined value by value, to name what a law does wrong.
//!
//! A comparison with NaN is false. So a contact with a NaN gap would not touch, and a NaN force
//! would be lost in the next maximum. An implicit method would treat the push of an active friction
//! law as an error of its own. The stepper therefore takes a step again with this scene if the
//! [`ScreenedScene`](super::ScreenedScene) has raised its alarm. It forwards all calls and records
//! the first value that breaks a contract, wherever the method evaluates it. The stepper converts
//! the record into an error.

use core::cell::Cell;

use super::Dynamics;
use super::screened::NORMAL;
use crate::body::{InertiaProperties, RigidPointBody};
use crate::contact::ContactModel;
use crate::error::LawQuantity;
use crate::force::{Force, ForcePower, Wrench};
use crate::friction::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::ground::{GroundBounds, GroundMotion, MeanForce, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Units in the last place of `|force| |slip|` by which the power of friction may exceed 0: 16
/// times the tolerance of `check_friction`.
const POWER: f64 = 64.0;

/// Values that break a contract.
#[derive(Clone, Copy, Debug)]
struct Findings<R> {
    /// First violation that rounding cannot explain, and its value.
    certain: Option<(LawQuantity, R)>,
    /// Least spring energy, J, or 0 if none is negative. Rounding of the law's terms may explain
    /// it.
    least_energy: R,
}

/// Record of the values that break a contract during a step.
pub(crate) struct Record<R>(Cell<Findings<R>>);

impl<R: Real> Record<R> {
    pub(crate) const fn new() -> Self {
        Self(Cell::new(Findings {
            certain: None,
            least_energy: R::ZERO,
        }))
    }

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        let findings = self.0.get();
        findings.certain.is_none() && findings.least_energy >= R::ZERO
    }

    /// Returns the first value that breaks a contract by more than the rounding of the energy (J).
    pub(crate) fn violation(&self, rounding: R) -> Option<(LawQuantity, R)> {
        let findings = self.0.get();
        let negative = -findings.least_energy > rounding;
        let energy = negative.then_some((LawQuantity::SpringEnergy, findings.least_energy));
        findings.certain.or(energy)
    }

    fn note(&self, quantity: LawQuantity, value: R) {
        let findings = self.0.get();
        self.0.set(Findings {
            certain: findings.certain.or(Some((quantity, value))),
            ..findings
        });
    }

    fn note_energy(&self, energy: R) {
        let findings = self.0.get();
        self.0.set(Findings {
            least_energy: findings.least_energy.at_most(energy),
            ..findings
        });
    }
}

/// Scene with its laws examined.
///
/// Its parts are behind pointers, so that an integrator is compiled only once for all examined
/// scenes.
pub(crate) struct DiagnosedScene<'a, R: Real> {
    body: &'a dyn RigidPointBody<R>,
    ground: DiagnosedGround<'a, R>,
    friction: DiagnosedFriction<'a, R>,
    force: DiagnosedForce<'a, R>,
    gravity: R::Vec3,
    inertia_properties: &'a InertiaProperties<R>,
    has_radii: bool,
}

impl<'a, R: Real> DiagnosedScene<'a, R> {
    pub(crate) fn of<D: Dynamics<R>>(scene: &'a D, record: &'a Record<R>) -> Self
    where
        D::Body: Sized,
        D::Ground: Sized,
        D::Friction: Sized,
        D::Force: Sized,
    {
        Self {
            body: scene.body(),
            ground: DiagnosedGround {
                ground: scene.ground(),
                bounding_radius: scene.bounding_radius(),
                record,
            },
            friction: DiagnosedFriction {
                friction: scene.friction(),
                record,
            },
            force: DiagnosedForce {
                force: scene.force(),
                record,
            },
            gravity: scene.gravity(),
            inertia_properties: scene.inertia_properties(),
            has_radii: scene.contact_model().has_radii,
        }
    }
}

impl<'a, R: Real> Dynamics<R> for DiagnosedScene<'a, R> {
    type Body = &'a dyn RigidPointBody<R>;
    type Ground = DiagnosedGround<'a, R>;
    type Friction = DiagnosedFriction<'a, R>;
    type Force = DiagnosedForce<'a, R>;
    type Untested = Self;

    #[inline]
    fn untested(&self) -> &Self {
        self
    }
    #[inline]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        ContactModel {
            body: &self.body,
            ground: &self.ground,
            friction: &self.friction,
            bounding_radius: self.ground.bounding_radius,
            has_radii: self.has_radii,
        }
    }
    #[inline]
    fn gravity(&self) -> R::Vec3 {
        self.gravity
    }
    #[inline]
    fn force(&self) -> &Self::Force {
        &self.force
    }
    #[inline]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.inertia_properties
    }

    #[inline]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        let is_trusted =
            self.ground.is_trusted() && self.friction.is_trusted() && self.force.is_trusted();
        if is_trusted {
            return evaluate();
        }
        let record = self.ground.record;
        let known = record.0.get();
        let value = evaluate();
        record.0.set(known);
        value
    }
}

/// Ground whose values are examined.
pub(crate) struct DiagnosedGround<'a, R: Real> {
    ground: &'a dyn SpringDamperGround<R>,
    /// Bounding radius of the body, m. No contact has a larger radius.
    bounding_radius: R,
    record: &'a Record<R>,
}

impl<R: Real> DiagnosedGround<'_, R> {
    /// Checks a force (N) that the law returns for two numbers.
    #[inline]
    fn check_force(&self, quantity: LawQuantity, force: R, input: [R; 2]) {
        let sound = force.abs() <= R::MAX;
        if !sound && !self.ground.is_trusted() {
            self.blame(quantity, force, input);
        }
    }

    /// Records a NaN. Infinity is an overflow, and after an overflowed input every value is
    /// accepted.
    #[cold]
    #[inline(never)]
    fn blame(&self, quantity: LawQuantity, value: R, [a, b]: [R; 2]) {
        if is_nan(value) && a.is_finite() && b.is_finite() {
            self.record.note(quantity, value);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_energy(&self, energy: R, depth: R) {
        self.blame(LawQuantity::SpringEnergy, energy, [depth; 2]);
        if depth.is_finite() && energy < R::ZERO {
            self.record.note_energy(energy);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_surface(&self, point: R::Vec3, surface: &Surface<R>) {
        if !point.length_squared().is_finite() {
            return;
        }
        if is_nan(surface.gap) {
            self.record.note(LawQuantity::Gap, surface.gap);
        } else if surface.gap <= self.bounding_radius {
            // Farther away no contact touches, and the normal is never used.
            let length = surface.normal.length();
            let sound = (length - R::ONE).abs() <= R::EPSILON * R::from_f64(NORMAL);
            if !sound {
                self.record.note(LawQuantity::Normal, length);
            }
        }
    }

    /// Evaluates the values that make up a mean force first. If one of them is infinite, the mean
    /// has overflowed.
    #[cold]
    #[inline(never)]
    fn blame_mean(&self, mean: R, [start, end]: [R; 2], seconds: R) {
        let speed = (end - start) / seconds;
        let mut overflows = !(start.is_finite() && end.is_finite() && speed.is_finite());
        for depth in [start, end] {
            if depth > R::ZERO && !overflows {
                let values = [
                    self.spring_energy(depth),
                    self.spring_force(depth),
                    self.normal_force(depth, speed),
                ];
                overflows = values.iter().any(|value| value.abs() > R::MAX);
            }
        }
        if !overflows {
            self.blame(LawQuantity::MeanForce, mean, [start, end]);
        }
    }
}

impl<R: Real> SpringDamperGround<R> for DiagnosedGround<'_, R> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let surface = self.ground.surface(point);
        let off = (surface.normal.length_squared() - R::ONE).abs();
        let sound = off <= R::EPSILON * R::from_f64(NORMAL) && surface.gap.abs() <= R::MAX;
        if !sound && !self.ground.is_trusted() {
            self.blame_surface(point, &surface);
        }
        surface
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        let force = self.ground.spring_force(depth);
        self.check_force(LawQuantity::SpringForce, force, [depth; 2]);
        force
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        let energy = self.ground.spring_energy(depth);
        let sound = energy >= R::ZERO;
        if !sound && !self.ground.is_trusted() {
            self.blame_energy(energy, depth);
        }
        energy
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        let force = self.ground.normal_force(depth, closing_speed);
        self.check_force(LawQuantity::NormalForce, force, [depth, closing_speed]);
        if !self.ground.is_trusted() {
            // An explicit method evaluates neither of the two, but the energy of its states does.
            self.spring_force(depth);
            self.spring_energy(depth);
        }
        force
    }

    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let mean = self.ground.mean_force(start, end, seconds);
        let sound = mean.force.abs() <= R::MAX;
        if !sound && !self.ground.is_trusted() {
            self.blame_mean(mean.force, [start, end], seconds);
        }
        mean
    }

    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }
    #[inline]
    fn surfaces(&self) -> Option<usize> {
        self.ground.surfaces()
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        let (bounding_radius, record) = (self.bounding_radius, self.record);
        self.ground.with_surface(index, &mut |ground| {
            visit(&DiagnosedGround {
                ground,
                bounding_radius,
                record,
            });
        });
    }
    #[inline]
    fn motion(&self) -> Option<GroundMotion<R>> {
        self.ground.motion()
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.ground.is_trusted()
    }
}

/// Friction law whose values are examined.
pub(crate) struct DiagnosedFriction<'a, R: Real> {
    friction: &'a dyn SlidingFriction<R>,
    record: &'a Record<R>,
}

impl<R: Real> DiagnosedFriction<'_, R> {
    #[inline]
    fn examine(&self, force: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let power = force.dot(slip);
        let sound = power <= R::ZERO && power >= -R::MAX;
        if !sound && !self.friction.is_trusted() {
            self.blame(force, normal_force, slip);
        }
        force
    }

    #[inline]
    fn examine_turning(
        &self,
        turning: Option<RollingResistance<R>>,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        if let Some(values) = &turning {
            let sound = values.rolling >= R::ZERO
                && values.spinning >= R::ZERO
                && values.turn_speed >= R::ZERO;
            if !sound && !self.friction.is_trusted() {
                self.blame_turning(values, normal_force);
            }
        }
        turning
    }

    #[cold]
    #[inline(never)]
    fn blame(&self, force: R::Vec3, normal_force: R, slip: R::Vec3) {
        let is_load = normal_force >= R::ZERO && normal_force.is_finite();
        if !(is_load && slip.length_squared().is_finite()) {
            return;
        }
        let (size, power) = (force.length(), force.dot(slip));
        let rounding = size * slip.length() * (R::EPSILON * R::from_f64(POWER));
        if !force.is_finite() {
            self.record.note(LawQuantity::FrictionForce, size);
        } else if power > rounding {
            self.record.note(LawQuantity::FrictionPower, power);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_turning(&self, turning: &RollingResistance<R>, normal_force: R) {
        let values = [turning.rolling, turning.spinning, turning.turn_speed];
        let broken = values.into_iter().find(|&value| {
            let sound = value >= R::ZERO;
            !sound
        });
        if let Some(value) = broken.filter(|_| normal_force >= R::ZERO && normal_force.is_finite())
        {
            self.record.note(LawQuantity::RollingResistance, value);
        }
    }
}

impl<R: Real> SlidingFriction<R> for DiagnosedFriction<'_, R> {
    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let force = self.friction.force(normal_force, slip);
        self.examine(force, normal_force, slip)
    }

    #[inline]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let force = self.friction.force_at(position, normal_force, slip);
        // Beyond the largest number, a position is as good as any number.
        if !position.length_squared().is_finite() {
            return force;
        }
        self.examine(force, normal_force, slip)
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        self.friction.jacobian(normal_force, slip)
    }

    #[inline]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        self.friction.jacobian_at(position, normal_force, slip)
    }

    #[inline]
    fn depends_on_position(&self) -> bool {
        self.friction.depends_on_position()
    }

    #[inline]
    fn surfaces(&self) -> Option<usize> {
        self.friction.surfaces()
    }

    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        let record = self.record;
        self.friction.with_surface(index, &mut |friction| {
            visit(&DiagnosedFriction { friction, record });
        });
    }

    #[inline]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        self.examine_turning(self.friction.rolling_resistance(normal_force), normal_force)
    }

    #[inline]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        let turning = self.friction.rolling_resistance_at(position, normal_force);
        self.examine_turning(turning, normal_force)
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.friction.is_trusted()
    }
}

/// Applied force whose values are examined.
pub(crate) struct DiagnosedForce<'a, R: Real> {
    force: &'a dyn Force<R>,
    record: &'a Record<R>,
}

impl<R: Real> DiagnosedForce<'_, R> {
    #[cold]
    #[inline(never)]
    fn blame(&self, wrench: &Wrench<R>, motion: &Motion<R>) {
        let (velocity, spin) = (motion.linear_velocity, motion.angular_velocity);
        let is_far = !motion.position.length_squared().is_finite();
        if is_far || !(velocity.length_squared() + spin.length_squared()).is_finite() {
            return;
        }
        let (force, torque) = (wrench.force.length(), wrench.torque.length());
        let power = wrench.power(motion);
        let terms = force * velocity.length() + torque * spin.length();
        let rounding = terms * (R::EPSILON * R::from_f64(POWER));
        if !wrench.force.is_finite() {
            self.record.note(LawQuantity::AppliedForce, force);
        } else if !wrench.torque.is_finite() {
            self.record.note(LawQuantity::AppliedTorque, torque);
        } else if self.force.is_passive() && power > rounding {
            self.record.note(LawQuantity::AppliedPower, power);
        }
    }
}

impl<R: Real> Force<R> for DiagnosedForce<'_, R> {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let wrench = self.force.wrench(motion);
        if !self.force.is_trusted() {
            let power = wrench.power(motion);
            let sound = wrench.is_finite() && (power <= R::ZERO || !self.force.is_passive());
            if !sound {
                self.blame(&wrench, motion);
            }
        }
        wrench
    }

    #[inline]
    fn is_passive(&self) -> bool {
        self.force.is_passive()
    }

    #[inline]
    fn constant_force(&self) -> Option<R::Vec3> {
        self.force.constant_force()
    }

    #[inline]
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        self.force.power(motion)
    }

    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        self.force
            .wrench_change(motion, linear_change, angular_change)
    }

    #[inline]
    fn acts(&self) -> bool {
        self.force.acts()
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.force.is_trusted()
    }
}

fn is_nan<R: Real>(value: R) -> bool {
    !(value >= R::ZERO || value <= R::ZERO)
}
