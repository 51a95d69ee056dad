//! The events of a body on a ground.

use super::{Event, EventDirection};
use crate::error::{self, SceneError};
use crate::observer::Sample;
use crate::real::{Real, Vector};

/// Gap of the lowest point, m. A body without contacts is never at the ground.
#[inline]
fn lowest_gap<R: Real>(sample: &Sample<'_, R>) -> R {
    sample.lowest_point().map_or(R::ONE, |lowest| lowest.gap)
}

/// Event that the lowest point of the body reaches the ground.
///
/// Its value is the gap of the [lowest point](crate::LowestPoint), m, falling. It occurs when the
/// first contact of a body in flight closes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Landing;

impl<R: Real> Event<R> for Landing {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        lowest_gap(sample)
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Falling
    }
}

/// Event that the last point of the body leaves the ground.
///
/// Its value is the gap of the [lowest point](crate::LowestPoint), m, rising. The force of a
/// damped contact may end earlier, because a ground never pulls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiftOff;

impl<R: Real> Event<R> for LiftOff {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        lowest_gap(sample)
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Rising
    }
}

/// Event that the vertical velocity of the centre of mass vanishes at the top of its path.
///
/// Its value is the velocity along world z, m/s, falling. `Apex.rising()` is the bottom of the
/// path. A body that is let go at rest begins at the top of its path: the first occurrence is then
/// at the start, and `Apex.nth(2)` is the top of its first bounce.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Apex;

impl<R: Real> Event<R> for Apex {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        sample.state.linear_velocity.z()
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Falling
    }
}

/// Event that a contact of the body closes.
///
/// Its value is the [number of contacts that touch](crate::SceneQuery::touching), rising. Contacts
/// that close at the same time are one occurrence. The number of a circular [`Rim`](crate::Rim) is
/// that of its quadrature points, so use [`Landing`] for a body with rims.
///
/// *Limit:* a number has no extremum that could be located. If one contact closes and another opens
/// within a step, or one closes and opens, neither is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCloses;

impl<R: Real> Event<R> for ContactCloses {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        R::from_usize(sample.touching())
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Rising
    }
    fn is_integer_valued(&self) -> bool {
        true
    }
}

/// Event that a contact of the body opens.
///
/// Its value is the [number of contacts that touch](crate::SceneQuery::touching), falling. The
/// limits of [`ContactCloses`] apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactOpens;

impl<R: Real> Event<R> for ContactOpens {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        R::from_usize(sample.touching())
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Falling
    }
    fn is_integer_valued(&self) -> bool {
        true
    }
}

/// Event that the slip of the lowest point ends.
///
/// Its value is the slip speed of the [lowest point](crate::LowestPoint) minus a given speed, m/s,
/// falling. The friction laws are finite at zero slip, so a slip decreases to a creep and does not
/// vanish. Choose a speed of some slip speeds of the law, above that of the creep. A body in flight
/// has no slip to end. If it touches down without slip, the event occurs at the touch-down.
///
/// *Limit:* the slip jumps where another contact becomes the lowest. A jump below the speed counts
/// as an end of the slip, also while other contacts slip faster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipEnds<R: Real = f64> {
    speed: R,
}

impl<R: Real> SlipEnds<R> {
    /// Creates the event that the slip falls below `speed`, m/s.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the speed is not above 0 or not finite. The error names the
    /// quantity, the rule and the value.
    pub fn below(speed: R) -> Result<Self, SceneError> {
        error::above_zero("speed at which a slip ends", speed, " m/s")?;
        Ok(Self { speed })
    }
}

impl<R: Real> Event<R> for SlipEnds<R> {
    fn value(&self, sample: &Sample<'_, R>) -> R {
        match sample.lowest_point() {
            Some(lowest) if lowest.gap < R::ZERO => lowest.slip_velocity.length() - self.speed,
            _ => self.speed,
        }
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Falling
    }
}
