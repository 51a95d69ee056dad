//! Sums of forces: a tuple acts as the sum of its parts.

use super::{Force, ForcePower, Wrench};
use crate::error::SceneError;
use crate::real::Real;
use crate::state::Motion;

/// The sum of two forces. The parts count as drag or as drive, each for itself.
impl<R: Real, A: Force<R>, B: Force<R>> Force<R> for (A, B) {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let (a, b) = (&self.0, &self.1);
        match (a.acts(), b.acts()) {
            (true, true) => a.wrench(motion).plus(&b.wrench(motion), R::ONE),
            (true, false) => a.wrench(motion),
            (false, true) => b.wrench(motion),
            (false, false) => Wrench::ZERO,
        }
    }

    #[inline]
    fn is_passive(&self) -> bool {
        self.0.is_passive() && self.1.is_passive()
    }

    #[inline]
    fn constant_force(&self) -> Option<R::Vec3> {
        match (self.0.constant_force(), self.1.constant_force()) {
            (Some(a), Some(b)) => Some(a + b),
            (a, b) => a.or(b),
        }
    }

    #[inline]
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        let (a, b) = (self.0.power(motion), self.1.power(motion));
        ForcePower {
            drag: a.drag + b.drag,
            drive: a.drive + b.drive,
        }
    }

    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        let a = (self.0).wrench_change(motion, linear_change, angular_change);
        let b = (self.1).wrench_change(motion, linear_change, angular_change);
        a.plus(&b, R::ONE)
    }

    #[inline]
    fn acts(&self) -> bool {
        self.0.acts() || self.1.acts()
    }

    fn check(&self) -> Result<(), SceneError> {
        self.0.check()?;
        self.1.check()
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.0.is_trusted() && self.1.is_trusted()
    }
}

/// Implements the trait for a longer tuple, by a pair of pairs.
macro_rules! as_pair {
    ($($part:ident),*: |$parts:ident| $pair:expr) => {
        impl<R: Real, $($part: Force<R>),*> Force<R> for ($($part),*) {
            #[inline]
            fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
                let $parts = self;
                $pair.wrench(motion)
            }
            #[inline]
            fn is_passive(&self) -> bool {
                let $parts = self;
                Force::<R>::is_passive(&$pair)
            }
            #[inline]
            fn constant_force(&self) -> Option<R::Vec3> {
                let $parts = self;
                Force::<R>::constant_force(&$pair)
            }
            #[inline]
            fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
                let $parts = self;
                $pair.power(motion)
            }
            #[inline]
            fn wrench_change(
                &self,
                motion: &Motion<R>,
                linear_change: R::Vec3,
                angular_change: R::Vec3,
            ) -> Wrench<R> {
                let $parts = self;
                $pair.wrench_change(motion, linear_change, angular_change)
            }
            #[inline]
            fn acts(&self) -> bool {
                let $parts = self;
                Force::<R>::acts(&$pair)
            }
            fn check(&self) -> Result<(), SceneError> {
                let $parts = self;
                Force::<R>::check(&$pair)
            }
            #[inline]
            fn is_trusted(&self) -> bool {
                let $parts = self;
                Force::<R>::is_trusted(&$pair)
            }
        }
    };
}
as_pair!(A, B, C: |parts| ((&parts.0, &parts.1), &parts.2));
as_pair!(A, B, C, D: |parts| ((&parts.0, &parts.1), (&parts.2, &parts.3)));
