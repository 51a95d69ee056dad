//! Scene whose laws are examined value by value, to name what a law does wrong.
//!
//! A comparison with NaN is false. So a contact with a NaN gap would not touch, and a NaN force
//! would be lost in the next maximum. An implicit method would treat the push of an active friction
//! law as an error of its own. The stepper therefore takes a step again with this scene if the
//! [`ScreenedScene`](super::ScreenedScene) has raised its alarm. It records the first value that
//! breaks a contract, wherever the method evaluates it. The stepper converts the record into an
//! error.

use core::cell::Cell;

use super::Dynamics;
use super::inspected::{InspectedForce, InspectedFriction, InspectedGround, Inspector, Slide};
use super::screened::NORMAL;
use crate::body::{InertiaProperties, RigidPointBody};
use crate::contact::{ContactModel, Extent};
use crate::error::LawQuantity;
use crate::force::{Force, Wrench};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::{MeanForce, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Units in the last place of `|force| |slip|` by which the power of friction may exceed 0: 16
/// times the tolerance of `check_friction`.
const POWER: f64 = 64.0;

/// Power (W) that may be rounding of a product of a force and a velocity, for the product of their
/// lengths. Products may also underflow: then they are far below half of the smallest normal
/// number.
fn rounding_of_power<R: Real>(product: R) -> R {
    product * (R::EPSILON * R::from_f64(POWER)) + R::ONE / R::MAX
}

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

impl<R: Real> Record<R> {
    /// Records a value that is NaN. Infinity is an overflow, and after an overflowed input every
    /// value is accepted.
    #[cold]
    #[inline(never)]
    fn blame(&self, quantity: LawQuantity, value: R, [a, b]: [R; 2]) {
        if is_nan(value) && a.is_finite() && b.is_finite() {
            self.note(quantity, value);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_energy(&self, energy: R, depth: R) {
        self.blame(LawQuantity::SpringEnergy, energy, [depth; 2]);
        if depth.is_finite() && energy < R::ZERO {
            self.note_energy(energy);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_surface(&self, surface: &Surface<R>, point: R::Vec3, reach: R) {
        if !point.length_squared().is_finite() {
            return;
        }
        if is_nan(surface.gap) {
            self.note(LawQuantity::Gap, surface.gap);
        } else if surface.gap <= reach {
            // Farther away no contact touches, and the normal is never used.
            let length = surface.normal.length();
            let sound = (length - R::ONE).abs() <= R::EPSILON * R::from_f64(NORMAL);
            if !sound {
                self.note(LawQuantity::Normal, length);
            }
        }
    }

    /// Evaluates the values that make up a mean force first. If one of them is infinite, the mean
    /// has overflowed.
    #[cold]
    #[inline(never)]
    fn blame_mean<G>(&self, ground: &G, mean: R, [start, end]: [R; 2], seconds: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
        let speed = (end - start) / seconds;
        let mut overflows = !(start.is_finite() && end.is_finite() && speed.is_finite());
        for depth in [start, end] {
            if depth > R::ZERO && !overflows {
                let energy = ground.spring_energy(depth);
                self.spring_energy(energy, depth);
                let spring_force = ground.spring_force(depth);
                self.spring_force(spring_force, depth);
                let force = ground.normal_force(depth, speed);
                self.normal_force(ground, force, depth, speed);
                let values = [energy, spring_force, force];
                overflows = values.iter().any(|value| value.abs() > R::MAX);
            }
        }
        if !overflows {
            self.blame(LawQuantity::MeanForce, mean, [start, end]);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_friction(&self, force: R::Vec3, slide: &Slide<R>) {
        let (normal_force, slip) = (slide.normal_force, slide.slip);
        let is_load = normal_force >= R::ZERO && normal_force.is_finite();
        // Beyond the largest number, a position is as good as any number.
        let is_place = slide.position.length_squared().is_finite();
        if !(is_load && is_place && slip.length_squared().is_finite()) {
            return;
        }
        let (size, power) = (force.length(), force.dot(slip));
        let rounding = rounding_of_power(size * slip.length());
        if !force.is_finite() {
            self.note(LawQuantity::FrictionForce, size);
        } else if power > rounding {
            self.note(LawQuantity::FrictionPower, power);
        }
    }

    #[cold]
    #[inline(never)]
    fn blame_wrench(&self, wrench: &Wrench<R>, motion: &Motion<R>, is_passive: bool) {
        let (velocity, spin) = (motion.linear_velocity, motion.angular_velocity);
        let is_far = !motion.position.length_squared().is_finite();
        if is_far || !(velocity.length_squared() + spin.length_squared()).is_finite() {
            return;
        }
        let (force, torque) = (wrench.force.length(), wrench.torque.length());
        let power = wrench.power(motion);
        let terms = force * velocity.length() + torque * spin.length();
        let rounding = rounding_of_power(terms);
        if !wrench.force.is_finite() {
            self.note(LawQuantity::AppliedForce, force);
        } else if !wrench.torque.is_finite() {
            self.note(LawQuantity::AppliedTorque, torque);
        } else if is_passive && power > rounding {
            self.note(LawQuantity::AppliedPower, power);
        }
    }
}

impl<R: Real> Inspector<R> for Record<R> {
    fn surface(&self, surface: &Surface<R>, point: R::Vec3, reach: R) {
        let off = (surface.normal.length_squared() - R::ONE).abs();
        let sound = off <= R::EPSILON * R::from_f64(NORMAL) && surface.gap.abs() <= R::MAX;
        if !sound {
            self.blame_surface(surface, point, reach);
        }
    }

    fn spring_force(&self, force: R, depth: R) {
        self.blame(LawQuantity::SpringForce, force, [depth; 2]);
    }

    fn spring_energy(&self, energy: R, depth: R) {
        let sound = energy >= R::ZERO;
        if !sound {
            self.blame_energy(energy, depth);
        }
    }

    fn normal_force<G>(&self, ground: &G, force: R, depth: R, closing_speed: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
        self.blame(LawQuantity::NormalForce, force, [depth, closing_speed]);
        // An explicit method evaluates neither of the two, but the energy of its states does.
        self.spring_force(ground.spring_force(depth), depth);
        self.spring_energy(ground.spring_energy(depth), depth);
    }

    fn mean_force<G>(&self, ground: &G, mean: &MeanForce<R>, depths: [R; 2], seconds: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
        let sound = mean.force.abs() <= R::MAX;
        if !sound {
            self.blame_mean(ground, mean.force, depths, seconds);
        }
    }

    fn friction<F>(&self, law: &F, force: R::Vec3, slide: &Slide<R>) -> R::Vec3
    where
        F: SlidingFriction<R> + ?Sized,
    {
        let power = force.dot(slide.slip);
        let sound = power <= R::ZERO && power >= -R::MAX;
        if !sound && !law.is_trusted() {
            self.blame_friction(force, slide);
        }
        force
    }

    fn resistance(&self, resistance: &RollingResistance<R>, normal_force: R) {
        let is_torque = |torque: R| torque >= R::ZERO && torque <= R::MAX;
        let torques = [resistance.rolling, resistance.spinning];
        let torque = torques.into_iter().find(|&torque| !is_torque(torque));
        // At a turn speed of 0 the torque on a body at rest would be 0/0.
        let speed = resistance.turn_speed;
        let is_speed = speed > R::ZERO && speed <= R::MAX;
        let broken = torque.or((!is_speed).then_some(speed));
        if let Some(value) = broken.filter(|_| normal_force >= R::ZERO && normal_force.is_finite())
        {
            self.note(LawQuantity::RollingResistance, value);
        }
    }

    fn wrench<E>(&self, force: &E, wrench: &Wrench<R>, motion: &Motion<R>)
    where
        E: Force<R> + ?Sized,
    {
        let power = wrench.power(motion);
        let sound = wrench.is_finite() && (power <= R::ZERO || !force.is_passive());
        if !sound {
            self.blame_wrench(wrench, motion, force.is_passive());
        }
    }
}

/// Ground whose values are recorded.
type Ground<'a, R> = InspectedGround<'a, R, dyn SpringDamperGround<R> + 'a, Record<R>>;
/// Friction law whose values are recorded.
type Friction<'a, R> = InspectedFriction<'a, dyn SlidingFriction<R> + 'a, Record<R>>;
/// Applied force whose values are recorded.
type Applied<'a, R> = InspectedForce<'a, dyn Force<R> + 'a, Record<R>>;

/// Scene with its laws examined.
///
/// Its parts are behind pointers, so that an integrator is compiled only once for all examined
/// scenes.
pub(crate) struct DiagnosedScene<'a, R: Real> {
    body: &'a dyn RigidPointBody<R>,
    ground: Ground<'a, R>,
    friction: Friction<'a, R>,
    force: Applied<'a, R>,
    gravity: R::Vec3,
    inertia_properties: &'a InertiaProperties<R>,
    extent: Extent<R>,
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
            ground: InspectedGround {
                ground: scene.ground(),
                reach: scene.bounding_radius(),
                inspector: record,
            },
            friction: InspectedFriction {
                friction: scene.friction(),
                inspector: record,
            },
            force: InspectedForce {
                force: scene.force(),
                inspector: record,
            },
            gravity: scene.gravity(),
            inertia_properties: scene.inertia_properties(),
            extent: scene.contact_model().extent(),
        }
    }
}

impl<'a, R: Real> Dynamics<R> for DiagnosedScene<'a, R> {
    type Body = &'a dyn RigidPointBody<R>;
    type Ground = Ground<'a, R>;
    type Friction = Friction<'a, R>;
    type Force = Applied<'a, R>;
    type Untested = Self;

    #[inline]
    fn untested(&self) -> &Self {
        self
    }
    #[inline]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        ContactModel::composed(&self.body, &self.ground, &self.friction, self.extent)
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
        let record = self.ground.inspector;
        let known = record.0.get();
        let value = evaluate();
        record.0.set(known);
        value
    }
}

fn is_nan<R: Real>(value: R) -> bool {
    !(value >= R::ZERO || value <= R::ZERO)
}
