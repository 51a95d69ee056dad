//! A ground that counts how often it is evaluated.

use core::cell::Cell;
use tumble::real::Real;
use tumble::{GroundBounds, MeanForce, SpringDamperGround, Surface};

/// Ground that counts its evaluations.
#[derive(Debug)]
pub(crate) struct Counting<G> {
    ground: G,
    counts: Cell<Evaluations>,
}

/// Number of evaluations of a ground.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Evaluations {
    /// Evaluations of the surface under a point.
    pub(crate) surfaces: u32,
    /// Evaluations of a force or of an energy.
    pub(crate) laws: u32,
}

impl<G> Counting<G> {
    pub(crate) fn new(ground: G) -> Self {
        Self {
            ground,
            counts: Cell::default(),
        }
    }

    /// Returns the number of evaluations since the last call.
    pub(crate) fn take(&self) -> Evaluations {
        self.counts.take()
    }

    fn counted(&self, count: impl FnOnce(&mut Evaluations)) -> &G {
        let mut counts = self.counts.get();
        count(&mut counts);
        self.counts.set(counts);
        &self.ground
    }

    fn law(&self) -> &G {
        self.counted(|counts| counts.laws += 1)
    }
}

impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for Counting<G> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.counted(|counts| counts.surfaces += 1).surface(point)
    }
    fn spring_force(&self, depth: R) -> R {
        self.law().spring_force(depth)
    }
    fn spring_energy(&self, depth: R) -> R {
        self.law().spring_energy(depth)
    }
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.law().normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        self.law().mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }
}
