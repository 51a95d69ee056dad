//! One friction law for each surface of a ground of several.

use super::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::error::{Rule, SceneError};
use crate::real::{Real, Vector};

/// Evaluates `$answer` for the law of one surface, or returns `$otherwise` if there is none.
macro_rules! of_law {
    ($friction:expr, $index:expr, $otherwise:expr, |$law:ident| $answer:expr) => {{
        let mut answer = $otherwise;
        $friction.with_surface($index, &mut |$law| answer = $answer);
        answer
    }};
}

/// Friction law of one surface of a ground.
///
/// If all surfaces have the same law, this is the law itself, without a cost.
#[derive(Debug)]
pub(crate) struct LawOfSurface<'a, F: ?Sized> {
    friction: &'a F,
    index: usize,
}

impl<'a, F: ?Sized> LawOfSurface<'a, F> {
    /// Law of a surface by its index.
    #[inline(always)]
    pub(crate) fn of(friction: &'a F, index: usize) -> Self {
        Self { friction, index }
    }
}

/// Methods of the law of one surface. Those of one law among several are functions of their own, so
/// that the code of a scene with one law is not longer than without them.
macro_rules! methods_of_one {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $answer:ty, else $otherwise:expr;)*) => {
        impl<R: Real, F: SlidingFriction<R> + ?Sized> SlidingFriction<R> for LawOfSurface<'_, F> {
            $(#[inline(always)]
            fn $name(&self, $($argument: $kind),*) -> $answer {
                #[cold]
                #[inline(never)]
                fn among_several<R: Real, F: SlidingFriction<R> + ?Sized>(
                    friction: &F,
                    index: usize,
                    $($argument: $kind),*
                ) -> $answer {
                    of_law!(friction, index, $otherwise, |law| law.$name($($argument),*))
                }
                if self.friction.surfaces().is_some() {
                    among_several(self.friction, self.index, $($argument),*)
                } else {
                    self.friction.$name($($argument),*)
                }
            })*
            #[inline(always)]
            fn depends_on_position(&self) -> bool {
                self.friction.depends_on_position()
            }
            #[inline(always)]
            fn is_proportional_to_load(&self) -> bool {
                self.friction.is_proportional_to_load()
            }
            #[inline(always)]
            fn is_trusted(&self) -> bool {
                self.friction.is_trusted()
            }
        }
    };
}
methods_of_one! {
    force(normal_force: R, slip: R::Vec3) -> R::Vec3, else R::Vec3::ZERO;
    force_at(position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3, else R::Vec3::ZERO;
    jacobian(normal_force: R, slip: R::Vec3) -> FrictionJacobian<R>, else FrictionJacobian::NONE;
    jacobian_at(position: R::Vec3, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R>,
        else FrictionJacobian::NONE;
    metric_at(position: R::Vec3) -> Option<[R::Vec3; 3]>, else None;
    rolling_resistance(normal_force: R) -> Option<RollingResistance<R>>, else None;
    rolling_resistance_at(position: R::Vec3, normal_force: R) -> Option<RollingResistance<R>>,
        else None;
}

/// Checks that a law inside another law is one law, not several.
///
/// The law around it would evaluate the first of them on every surface.
pub(super) fn check_is_one<R: Real>(inner: &impl SlidingFriction<R>) -> Result<(), SceneError> {
    inner.surfaces().map_or(Ok(()), |count| {
        let quantity = "number of laws inside a friction law";
        Err(SceneError::new(
            quantity,
            Rule::Exactly(1),
            count as f64,
            "",
        ))
    })
}

/// Number of surfaces for which one part of a friction law holds.
#[inline]
fn count_of<R: Real, F: SlidingFriction<R> + ?Sized>(part: &F) -> usize {
    part.surfaces().unwrap_or(1)
}

/// Calls `visit` with the law of a surface of one part.
#[inline]
fn visit_part<R: Real, F: SlidingFriction<R>>(
    part: &F,
    index: usize,
    visit: &mut dyn FnMut(&dyn SlidingFriction<R>),
) {
    match part.surfaces() {
        None if index == 0 => visit(part),
        None => {}
        Some(_) => part.with_surface(index, visit),
    }
}

/// First resistance to rotation among the laws.
///
/// It only shows whether any law has one.
fn first_resistance<R: Real, F: SlidingFriction<R> + ?Sized>(
    friction: &F,
    normal_force: R,
) -> Option<RollingResistance<R>> {
    (0..count_of(friction)).find_map(|index| {
        of_law!(friction, index, None, |law| law
            .rolling_resistance(normal_force))
    })
}

/// The methods that are the same for each kind of several laws.
macro_rules! methods_of_several {
    () => {
        fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
            of_law!(self, 0, R::Vec3::ZERO, |law| law.force(normal_force, slip))
        }
        fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
            of_law!(self, 0, R::Vec3::ZERO, |law| law.force_at(
                position,
                normal_force,
                slip
            ))
        }
        fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
            first_resistance(self, normal_force)
        }
    };
}

/// The friction laws of several surfaces, all of the same type.
impl<R: Real, F: SlidingFriction<R>> SlidingFriction<R> for [F] {
    methods_of_several!();

    fn surfaces(&self) -> Option<usize> {
        Some(self.iter().map(count_of).sum())
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        let mut index = index;
        for part in self {
            let count = count_of(part);
            if index < count {
                return visit_part(part, index, visit);
            }
            index -= count;
        }
    }
    fn depends_on_position(&self) -> bool {
        self.iter().any(F::depends_on_position)
    }
    fn check(&self) -> Result<(), SceneError> {
        self.iter().try_for_each(F::check)
    }
    fn is_proportional_to_load(&self) -> bool {
        self.iter().all(F::is_proportional_to_load)
    }
    fn is_trusted(&self) -> bool {
        self.iter().all(F::is_trusted)
    }
}

/// The friction laws of several surfaces, all of the same type.
impl<R: Real, F: SlidingFriction<R>, const N: usize> SlidingFriction<R> for [F; N] {
    methods_of_several!();

    #[inline]
    fn surfaces(&self) -> Option<usize> {
        self.as_slice().surfaces()
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        self.as_slice().with_surface(index, visit);
    }
    fn depends_on_position(&self) -> bool {
        self.as_slice().depends_on_position()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.as_slice().check()
    }
    fn is_proportional_to_load(&self) -> bool {
        self.as_slice().is_proportional_to_load()
    }
    fn is_trusted(&self) -> bool {
        self.as_slice().is_trusted()
    }
}

/// Implements the trait for a tuple of laws, each of its own type.
macro_rules! of_tuple {
    ($($part:ident $place:tt),*) => {
        /// The friction laws of several surfaces, each of its own type.
        impl<R: Real, $($part: SlidingFriction<R>),*> SlidingFriction<R> for ($($part),*) {
            methods_of_several!();

            #[inline]
            fn surfaces(&self) -> Option<usize> {
                Some(0 $(+ count_of(&self.$place))*)
            }
            fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
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
            fn depends_on_position(&self) -> bool {
                false $(|| self.$place.depends_on_position())*
            }
            fn check(&self) -> Result<(), SceneError> {
                $(self.$place.check()?;)*
                Ok(())
            }
            fn is_proportional_to_load(&self) -> bool {
                true $(&& self.$place.is_proportional_to_load())*
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

#[cfg(test)]
mod tests {
    use crate::{Coulomb, SlidingFriction};

    #[test]
    fn an_array_with_an_invalid_law_is_refused() {
        let law = |coefficient| Coulomb {
            coefficient,
            slip_speed: 1e-3,
        };
        assert!(SlidingFriction::<f64>::check(&[law(0.3), law(0.4)]).is_ok());
        assert!(SlidingFriction::<f64>::check(&[law(0.3), law(-0.4)]).is_err());
        assert!(SlidingFriction::<f64>::check(&[law(f64::NAN), law(0.4)]).is_err());
    }
}
