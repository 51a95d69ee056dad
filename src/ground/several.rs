//! Grounds of several surfaces: a floor and walls, a step, a groove, a lid.

use super::{GroundBounds, GroundMotion, MeanForce, NoGround, SpringDamperGround, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// Evaluates `$answer` for one surface of `$ground`, or returns `$otherwise` if there is none.
macro_rules! of_surface {
    ($ground:expr, $index:expr, $otherwise:expr, |$part:ident| $answer:expr) => {{
        let mut answer = $otherwise;
        $ground.with_surface($index, &mut |$part| answer = $answer);
        answer
    }};
}

/// One surface of a ground, as a ground of its own.
///
/// If the ground has one surface only, this is the ground itself, without a cost.
#[derive(Debug)]
pub(crate) struct OneSurface<'a, G: ?Sized> {
    ground: &'a G,
    index: usize,
}

impl<'a, G: ?Sized> OneSurface<'a, G> {
    /// Surface of a ground by its index.
    #[inline(always)]
    pub(crate) fn of(ground: &'a G, index: usize) -> Self {
        Self { ground, index }
    }

    /// Index of the surface; 0 if the ground is one surface.
    #[inline(always)]
    pub(crate) fn index(&self) -> usize {
        self.index
    }
}

/// Methods of one surface. Those of a surface among several are functions of their own, so that the
/// code of a ground of one surface is not longer than without them.
macro_rules! methods_of_one {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $answer:ty, else $otherwise:expr;)*) => {
        impl<R: Real, G: SpringDamperGround<R> + ?Sized> SpringDamperGround<R>
            for OneSurface<'_, G>
        {
            $(#[inline(always)]
            fn $name(&self, $($argument: $kind),*) -> $answer {
                #[cold]
                #[inline(never)]
                fn among_several<R: Real, G: SpringDamperGround<R> + ?Sized>(
                    ground: &G,
                    index: usize,
                    $($argument: $kind),*
                ) -> $answer {
                    of_surface!(ground, index, $otherwise, |part| part.$name($($argument),*))
                }
                if self.ground.surfaces().is_some() {
                    among_several(self.ground, self.index, $($argument),*)
                } else {
                    self.ground.$name($($argument),*)
                }
            })*
            #[inline(always)]
            fn motion(&self) -> Option<GroundMotion<R>> {
                // All surfaces of a ground move as one.
                self.ground.motion()
            }
            #[inline(always)]
            fn is_trusted(&self) -> bool {
                self.ground.is_trusted()
            }
        }
    };
}
methods_of_one! {
    surface(point: R::Vec3) -> Surface<R>, else NoGround.surface(point);
    surface_under(centre: R::Vec3, radius: R) -> Option<Surface<R>>, else None;
    spring_force(depth: R) -> R, else R::ZERO;
    spring_energy(depth: R) -> R, else R::ZERO;
    normal_force(depth: R, closing_speed: R) -> R, else R::ZERO;
    mean_force(start: R, end: R, seconds: R) -> MeanForce<R>, else MeanForce::NONE;
    bounds() -> GroundBounds<R>, else GroundBounds::Nowhere;
}

/// Number of surfaces of one part of a ground.
#[inline]
fn count_of<R: Real, G: SpringDamperGround<R> + ?Sized>(part: &G) -> usize {
    part.surfaces().unwrap_or(1)
}

/// Calls `visit` with a surface of one part of a ground.
#[inline]
fn visit_part<R: Real, G: SpringDamperGround<R>>(
    part: &G,
    index: usize,
    visit: &mut dyn FnMut(&dyn SpringDamperGround<R>),
) {
    match part.surfaces() {
        None if index == 0 => visit(part),
        None => {}
        Some(_) => part.with_surface(index, visit),
    }
}

/// Checks that a part of a ground is valid and at rest.
fn check_part<R: Real, G: SpringDamperGround<R>>(part: &G) -> Result<(), SceneError> {
    part.check()?;
    if let GroundBounds::Plane(plane) | GroundBounds::Below(plane) = part.bounds() {
        plane.check()?;
    }
    part.motion().map_or(Ok(()), |motion| {
        motion.check_at_rest([
            "velocity of one surface among several",
            "angular velocity of one surface among several",
        ])
    })
}

/// Surface of a ground of several that is nearest to a point, or deepest above it.
fn nearest<R: Real, G: SpringDamperGround<R> + ?Sized>(ground: &G, point: R::Vec3) -> Surface<R> {
    let mut nearest = NoGround.surface(point);
    for index in 0..count_of(ground) {
        ground.with_surface(index, &mut |part| {
            let surface = part.surface(point);
            if surface.gap < nearest.gap {
                nearest = surface;
            }
        });
    }
    nearest
}

/// Bounds of a ground of several surfaces.
fn bounds_of_all<R: Real, G: SpringDamperGround<R> + ?Sized>(ground: &G) -> GroundBounds<R> {
    let mut bounds = GroundBounds::Nowhere;
    for index in 0..count_of(ground) {
        let part = of_surface!(ground, index, GroundBounds::Nowhere, |part| part.bounds());
        if part != GroundBounds::Nowhere {
            bounds = GroundBounds::Everywhere;
        }
    }
    bounds
}

/// The methods that are the same for each kind of ground of several surfaces.
macro_rules! methods_of_several {
    () => {
        fn surface(&self, point: R::Vec3) -> Surface<R> {
            nearest(self, point)
        }
        fn spring_force(&self, depth: R) -> R {
            of_surface!(self, 0, R::ZERO, |part| part.spring_force(depth))
        }
        fn spring_energy(&self, depth: R) -> R {
            of_surface!(self, 0, R::ZERO, |part| part.spring_energy(depth))
        }
        fn normal_force(&self, depth: R, closing_speed: R) -> R {
            of_surface!(self, 0, R::ZERO, |part| part
                .normal_force(depth, closing_speed))
        }
        fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
            of_surface!(self, 0, MeanForce::NONE, |part| part
                .mean_force(start, end, seconds))
        }
        fn bounds(&self) -> GroundBounds<R> {
            bounds_of_all(self)
        }
    };
}

/// A ground of all surfaces of the slice. Each has the same type.
impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for [G] {
    methods_of_several!();

    fn surfaces(&self) -> Option<usize> {
        Some(self.iter().map(count_of).sum())
    }
    #[inline]
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        let mut index = index;
        for part in self {
            let count = count_of(part);
            if index < count {
                return visit_part(part, index, visit);
            }
            index -= count;
        }
    }
    fn check(&self) -> Result<(), SceneError> {
        self.iter().try_for_each(check_part)
    }
    fn is_trusted(&self) -> bool {
        self.iter().all(G::is_trusted)
    }
}

/// A ground of all surfaces of the array. Each has the same type.
impl<R: Real, G: SpringDamperGround<R>, const N: usize> SpringDamperGround<R> for [G; N] {
    methods_of_several!();

    #[inline]
    fn surfaces(&self) -> Option<usize> {
        self.as_slice().surfaces()
    }
    #[inline]
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        self.as_slice().with_surface(index, visit);
    }
    fn check(&self) -> Result<(), SceneError> {
        self.as_slice().check()
    }
    fn is_trusted(&self) -> bool {
        self.as_slice().is_trusted()
    }
}

/// Implements the trait for a tuple of grounds, each of its own type.
macro_rules! of_tuple {
    ($($part:ident $place:tt),*) => {
        impl<R: Real, $($part: SpringDamperGround<R>),*> SpringDamperGround<R> for ($($part),*) {
            methods_of_several!();

            #[inline]
            fn surfaces(&self) -> Option<usize> {
                Some(0 $(+ count_of(&self.$place))*)
            }
            #[inline]
            fn with_surface(
                &self,
                index: usize,
                visit: &mut dyn FnMut(&dyn SpringDamperGround<R>),
            ) {
                let first = 0;
                $(
                    let next = first + count_of(&self.$place);
                    if (first..next).contains(&index) {
                        return visit_part(&self.$place, index - first, visit);
                    }
                    let first = next;
                )*
                let _ = first;
            }
            fn check(&self) -> Result<(), SceneError> {
                $(check_part(&self.$place)?;)*
                Ok(())
            }
            fn is_trusted(&self) -> bool {
                true $(&& self.$place.is_trusted())*
            }
        }
    };
}
of_tuple!(A 0, B 1);
of_tuple!(A 0, B 1, C 2);
of_tuple!(A 0, B 1, C 2, D 3);
of_tuple!(A 0, B 1, C 2, D 3, E 4);
of_tuple!(A 0, B 1, C 2, D 3, E 4, F 5);
