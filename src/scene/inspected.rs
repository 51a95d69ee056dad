//! Laws whose values are inspected while a step evaluates them.
//!
//! An [`Inspector`] sees each value that a law returns. All else is answered by the law itself.

use crate::force::{Force, ForcePower, Wrench};
use crate::friction::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::ground::{GroundBounds, GroundMotion, MeanForce, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// What is done with the values of laws. The provided methods do nothing.
///
/// The values of a trusted law are not inspected, but for its friction.
pub(crate) trait Inspector<R: Real> {
    /// Inspects the surface at a point (m) for contacts with a radius of at most `reach` (m).
    #[inline(always)]
    fn surface(&self, _surface: &Surface<R>, _point: R::Vec3, _reach: R) {}

    /// Inspects a spring force (N) at a depth (m).
    #[inline(always)]
    fn spring_force(&self, _force: R, _depth: R) {}

    /// Inspects a spring energy (J) at a depth (m).
    #[inline(always)]
    fn spring_energy(&self, _energy: R, _depth: R) {}

    /// Inspects a normal force (N) of a ground at a depth (m) and a closing speed (m/s).
    #[inline(always)]
    fn normal_force<G>(&self, _ground: &G, _force: R, _depth: R, _closing_speed: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
    }

    /// Inspects a mean force of a ground between two depths (m).
    #[inline(always)]
    fn mean_force<G>(&self, _ground: &G, _mean: &MeanForce<R>, _depths: [R; 2], _seconds: R)
    where
        G: SpringDamperGround<R> + ?Sized,
    {
    }

    /// Inspects the friction (N) of a law, and returns the friction that acts.
    fn friction<F>(&self, law: &F, force: R::Vec3, slide: &Slide<R>) -> R::Vec3
    where
        F: SlidingFriction<R> + ?Sized;

    /// Inspects the resistance to rolling and spinning under a normal force (N).
    #[inline(always)]
    fn resistance(&self, _resistance: &RollingResistance<R>, _normal_force: R) {}

    /// Inspects the wrench of an applied force.
    #[inline(always)]
    fn wrench<E>(&self, _force: &E, _wrench: &Wrench<R>, _motion: &Motion<R>)
    where
        E: Force<R> + ?Sized,
    {
    }
}

/// What a friction law is asked for.
pub(crate) struct Slide<R: Real> {
    /// Position of the contact, m; the origin for a law that does not depend on it.
    pub(super) position: R::Vec3,
    /// N.
    pub(super) normal_force: R,
    /// m/s.
    pub(super) slip: R::Vec3,
}

/// Ground whose values are inspected.
pub(crate) struct InspectedGround<'a, R, G: ?Sized, I> {
    pub(super) ground: &'a G,
    /// Bounding radius of the body, m. No contact has a larger radius.
    pub(super) reach: R,
    pub(super) inspector: &'a I,
}

impl<R: Real, G: SpringDamperGround<R> + ?Sized, I: Inspector<R>> SpringDamperGround<R>
    for InspectedGround<'_, R, G, I>
{
    #[inline(always)]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let surface = self.ground.surface(point);
        if !self.ground.is_trusted() {
            self.inspector.surface(&surface, point, self.reach);
        }
        surface
    }
    #[inline(always)]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        let surface = self.ground.surface_under(centre, radius)?;
        if !self.ground.is_trusted() {
            self.inspector.surface(&surface, centre, self.reach);
        }
        Some(surface)
    }
    #[inline(always)]
    fn spring_force(&self, depth: R) -> R {
        let force = self.ground.spring_force(depth);
        if !self.ground.is_trusted() {
            self.inspector.spring_force(force, depth);
        }
        force
    }
    #[inline(always)]
    fn spring_energy(&self, depth: R) -> R {
        let energy = self.ground.spring_energy(depth);
        if !self.ground.is_trusted() {
            self.inspector.spring_energy(energy, depth);
        }
        energy
    }
    #[inline(always)]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        let force = self.ground.normal_force(depth, closing_speed);
        if !self.ground.is_trusted() {
            self.inspector
                .normal_force(self.ground, force, depth, closing_speed);
        }
        force
    }
    #[inline(always)]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let mean = self.ground.mean_force(start, end, seconds);
        if !self.ground.is_trusted() {
            self.inspector
                .mean_force(self.ground, &mean, [start, end], seconds);
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
        let (reach, inspector) = (self.reach, self.inspector);
        self.ground.with_surface(index, &mut |ground| {
            visit(&InspectedGround {
                ground,
                reach,
                inspector,
            });
        });
    }
    #[inline(always)]
    fn motion(&self) -> Option<GroundMotion<R>> {
        self.ground.motion()
    }
    #[inline(always)]
    fn is_trusted(&self) -> bool {
        self.ground.is_trusted()
    }
}

/// Friction law whose values are inspected.
pub(crate) struct InspectedFriction<'a, F: ?Sized, I> {
    pub(super) friction: &'a F,
    pub(super) inspector: &'a I,
}

impl<F: ?Sized, I> InspectedFriction<'_, F, I> {
    #[inline(always)]
    fn resistance<R: Real>(
        &self,
        resistance: Option<RollingResistance<R>>,
        normal_force: R,
    ) -> Option<RollingResistance<R>>
    where
        F: SlidingFriction<R>,
        I: Inspector<R>,
    {
        if let (Some(resistance), false) = (&resistance, self.friction.is_trusted()) {
            self.inspector.resistance(resistance, normal_force);
        }
        resistance
    }
}

impl<R: Real, F: SlidingFriction<R> + ?Sized, I: Inspector<R>> SlidingFriction<R>
    for InspectedFriction<'_, F, I>
{
    #[inline(always)]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let force = self.friction.force(normal_force, slip);
        let slide = Slide {
            position: R::Vec3::ZERO,
            normal_force,
            slip,
        };
        self.inspector.friction(self.friction, force, &slide)
    }
    #[inline(always)]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let force = self.friction.force_at(position, normal_force, slip);
        let slide = Slide {
            position,
            normal_force,
            slip,
        };
        self.inspector.friction(self.friction, force, &slide)
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
    fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
        self.friction.metric_at(position)
    }
    #[inline(always)]
    fn depends_on_position(&self) -> bool {
        self.friction.depends_on_position()
    }
    #[inline(always)]
    fn is_proportional_to_load(&self) -> bool {
        self.friction.is_proportional_to_load()
    }
    #[inline(always)]
    fn surfaces(&self) -> Option<usize> {
        self.friction.surfaces()
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        let inspector = self.inspector;
        self.friction.with_surface(index, &mut |friction| {
            visit(&InspectedFriction {
                friction,
                inspector,
            });
        });
    }
    #[inline(always)]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        let resistance = self.friction.rolling_resistance(normal_force);
        self.resistance(resistance, normal_force)
    }
    #[inline(always)]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        let resistance = self.friction.rolling_resistance_at(position, normal_force);
        self.resistance(resistance, normal_force)
    }
    #[inline(always)]
    fn is_trusted(&self) -> bool {
        self.friction.is_trusted()
    }
}

/// Applied force whose values are inspected.
pub(crate) struct InspectedForce<'a, E: ?Sized, I> {
    pub(super) force: &'a E,
    pub(super) inspector: &'a I,
}

impl<R: Real, E: Force<R> + ?Sized, I: Inspector<R>> Force<R> for InspectedForce<'_, E, I> {
    #[inline(always)]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let wrench = self.force.wrench(motion);
        if !self.force.is_trusted() {
            self.inspector.wrench(self.force, &wrench, motion);
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
