//! Requirements of a friction law.

mod derivatives;

use super::plan::{CheckPlan, across, cube_directions};
use super::{
    Input, Requirement, Violation, cannot_be, check_centre, demand, demand_at_least,
    demand_at_most, demand_finite, ulps, wide,
};
use derivatives::{Slide, inward};

use crate::error::{self, SceneError};
use crate::friction::{LawOfSurface, Metric, RollingResistance, SlidingFriction};
use crate::real::{Real, Vector, unit};

/// Range of positions, loads and slips for which a friction law is intended, with the surface. The
/// check evaluates nothing beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRange<R: Real = f64> {
    /// Middle of the region, m, world axes.
    pub centre: R::Vec3,
    /// Distance from the middle to each side of the region, m, at least 0. Patches should be at
    /// least some hundredths of it wide.
    pub size: R,
    /// Normal of the surface, any length above 0. Slips lie in the surface.
    pub normal: R::Vec3,
    /// Largest normal force of a contact, N, above 0.
    pub normal_force: R,
    /// Largest slip, m/s, above 0.
    pub slip: R,
}

impl<R: Real> FrictionRange<R> {
    fn check(&self) -> Result<(), SceneError> {
        check_centre::<R>(self.centre)?;
        error::at_least_zero("size of the range", self.size, " m")?;
        let normal = [self.normal.x(), self.normal.y(), self.normal.z()];
        for component in normal {
            error::finite("a component of the normal of the range", component, "")?;
        }
        // The square of the length may underflow or overflow.
        let largest = normal.map(R::abs).into_iter().fold(R::ZERO, R::at_least);
        error::above_zero("length of the normal of the range", largest, "")?;
        error::above_zero("normal force of the range", self.normal_force, " N")?;
        error::above_zero("slip of the range", self.slip, " m/s")
    }
}

/// Checks a friction law at loads and slips from 10⁻¹² of the largest to the largest, at 0, in all
/// directions of the surface, and at positions of the region.
///
/// The requirements are:
///
/// - If [`depends_on_position`](SlidingFriction::depends_on_position) is false, force and
///   resistance are the same at every position.
/// - If [`is_proportional_to_load`](SlidingFriction::is_proportional_to_load) is true, half of a
///   load gives half of the force and of the resistance, to 64 units of rounding.
/// - The force is finite, lies in the surface, and opposes the slip (`force · slip <= 0`).
/// - The force is 0 without load and 0 without slip. It has no jump at zero slip: as the slip falls
///   from 2·10⁻¹⁵⁰ m/s to a thousandth of it (from 2·10⁻¹⁵ m/s in `f32`), the force falls to half
///   or less.
/// - `rolling_resistance` is always `Some` or never. Its torques are at least 0, and 0 without
///   load. Its rotation speed is above 0.
/// - `jacobian` has finite numbers, a coefficient of at least 0, a width above 0 and a growth from
///   0 to 1. Its coefficient is `-force · slip/slip²` to the square root of the rounding, since it
///   only controls an iteration.
/// - The other numbers of `jacobian` are the derivatives of the coefficient, as differences of the
///   force show them to 32 square roots of the rounding. A growth that would be below 0 or above 1
///   is 0 or 1. Where a derivative jumps, any value between its two limits is right.
/// - `metric_at` is always `Some` or never. It is symmetric to 16 units of rounding, and the force
///   points along `-M M u` to the square root of the rounding.
///
/// *Limits:* a jump of the force at a slip other than 0 is hardly ever found. A law with a slip
/// speed below 3·10⁻¹⁵³ m/s (2·10⁻¹⁸ m/s in `f32`) is reported as one with a jump at zero slip. So
/// is a force in proportion to a power of the slip below 0.1.
///
/// ```
/// use tumble::contract::{CheckPlan, FrictionRange, check_friction};
/// use tumble::glam::DVec3;
///
/// let range = FrictionRange {
///     centre: DVec3::ZERO,
///     size: 1.0, // m
///     normal: DVec3::Z,
///     normal_force: 1e3, // N
///     slip: 10.0, // m/s
/// };
/// let ice = tumble::Coulomb { coefficient: 0.02, slip_speed: 1e-3 };
/// check_friction(&ice, &range, CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// Returns the first [`Violation`], with the requirement that is broken and the input that breaks
/// it. A quantity of the range that is invalid is named with its rule and its value.
pub fn check_friction<R: Real, F: SlidingFriction<R> + ?Sized>(
    friction: &F,
    range: &FrictionRange<R>,
    plan: CheckPlan,
) -> Result<(), Violation> {
    range.check().map_err(cannot_be)?;
    friction.check().map_err(cannot_be)?;
    (0..friction.surfaces().unwrap_or(1)).try_for_each(|index| {
        let law = LawOfSurface::of(friction, index);
        check_law(&law, range, plan)
    })
}

/// Checks a law that holds for one surface.
fn check_law<R: Real>(
    friction: &impl SlidingFriction<R>,
    range: &FrictionRange<R>,
    plan: CheckPlan,
) -> Result<(), Violation> {
    let normal = unit::<R>(range.normal);
    let check = |position: R::Vec3| Check {
        friction,
        normal,
        position: range.centre + position * range.size,
        centre: range.centre,
    };
    let places = [R::Vec3::ZERO]
        .into_iter()
        .chain(cube_directions::<R>().filter(|_| friction.depends_on_position()));
    for place in places {
        check(place).at_all(range)?;
    }
    let mut draw = plan.draw();
    for _ in 0..plan.cases {
        let direction = across::<R>(normal, draw.direction::<R>());
        let slip = direction * (range.slip * draw.scale(40));
        let load = range.normal_force * draw.scale(40);
        check(draw.place::<R>()).at(load, slip)?;
    }
    Ok(())
}

/// Fractions of the largest load and slip that are combined. The largest comes first, so that a
/// violation shows in large numbers.
const SHARES: [f64; 7] = [1.0, 0.3, 1e-2, 1e-4, 1e-8, 1e-12, 0.0];

/// Largest force (N) whose square underflows, so that it has no length: 1e-19 N in f32.
fn unresolved<R: Real>() -> R {
    R::TWO / R::MAX.sqrt()
}

/// Factor between the two slips at which a jump at zero slip shows.
const APART: f64 = 1024.0;

/// Larger one of these slips, m/s: 2e-150 m/s in f64. Even the square of the smaller one does not
/// underflow.
fn nearly_still<R: Real>() -> R {
    unresolved::<R>() * R::from_f64(16.0 * APART)
}

struct Check<'a, R: Real, F: ?Sized> {
    friction: &'a F,
    normal: R::Vec3,
    position: R::Vec3,
    /// Middle of the region.
    centre: R::Vec3,
}

impl<R: Real, F: SlidingFriction<R> + ?Sized> Check<'_, R, F> {
    fn at_all(&self, range: &FrictionRange<R>) -> Result<(), Violation> {
        for load in SHARES {
            let load = range.normal_force * R::from_f64(load);
            for direction in cube_directions::<R>() {
                let direction = across::<R>(self.normal, direction);
                for speed in SHARES {
                    self.at(load, direction * (range.slip * R::from_f64(speed)))?;
                }
            }
        }
        cube_directions::<R>()
            .map(|direction| across::<R>(self.normal, direction))
            .try_for_each(|direction| self.has_no_jump(range, direction))
    }

    /// Checks that the force tends to 0 with the slip.
    ///
    /// Both slips are far below any slip speed of use. There a regularised force is in proportion
    /// to the slip, and a jump is the same at both.
    fn has_no_jump(&self, range: &FrictionRange<R>, direction: R::Vec3) -> Result<(), Violation> {
        let (load, speed) = (range.normal_force, nearly_still::<R>());
        if speed > range.slip {
            return Ok(());
        }
        let slip = direction * speed;
        let nearer = slip * R::from_f64(1.0 / APART);
        let [force, remaining] =
            [slip, nearer].map(|slip| self.friction.force_at(self.position, load, slip).length());
        let input = || self.input(load, nearer);
        demand_finite(force, || self.input(load, slip))?;
        demand_finite(remaining, input)?;
        demand_at_most(remaining, force * R::HALF, Requirement::Continuous, input)
    }

    fn input(&self, load: R, slip: R::Vec3) -> Input {
        Input::Slide {
            position: wide::<R>(self.position),
            normal_force: load.to_f64(),
            slip: wide::<R>(slip),
        }
    }

    fn at(&self, load: R, slip: R::Vec3) -> Result<(), Violation> {
        let input = || self.input(load, slip);
        let force = self.friction.force_at(self.position, load, slip);
        let (size, speed) = (force.length(), slip.length());
        demand_finite(size, input)?;
        if load == R::ZERO {
            demand_at_most(size, R::ZERO, Requirement::NoLoadNoForce, input)?;
        }
        if slip == R::Vec3::ZERO {
            demand_at_most(size, R::ZERO, Requirement::NoSlipNoForce, input)?;
        }
        // Bound of a product that is 0 except for the rounding of its three terms.
        let bound = size * speed * ulps(4.0);
        demand_at_most(force.dot(slip), bound, Requirement::Opposes, input)?;
        let lifted = force.dot(self.normal).abs();
        let bound = size * ulps(16.0) + unresolved();
        demand_at_most(lifted, bound, Requirement::InSurface, input)?;
        self.same_everywhere(load, slip, force)?;
        self.turning_at(load, slip)?;
        self.same_resistance(load, slip)?;
        self.proportional_to_load(load, slip, force)?;
        self.jacobian_at(load, slip, force)?;
        self.metric_at(load, slip, force)?;
        self.derivatives_at(load * inward(), slip * inward())
    }

    fn same_everywhere(&self, load: R, slip: R::Vec3, force: R::Vec3) -> Result<(), Violation> {
        if self.friction.depends_on_position() {
            return Ok(());
        }
        let input = || self.input(load, slip);
        let elsewhere = self.friction.force_at(self.centre, load, slip);
        let without = self.friction.force(load, slip);
        let off = (force - elsewhere).length() + (force - without).length();
        demand_at_most(off, R::ZERO, Requirement::SameEverywhere, input)
    }

    fn turning_at(&self, load: R, slip: R::Vec3) -> Result<(), Violation> {
        let input = || self.input(load, slip);
        let found = (self.friction).rolling_resistance_at(self.position, load);
        let o = R::ZERO;
        let says = |resists: bool| if resists { R::ONE } else { o };
        let never = says(self.friction.rolling_resistance(o).is_some());
        let off = (says(found.is_some()) - never).abs();
        demand_at_most(off, o, Requirement::TurningOpposes, input)?;
        let Some(turning) = found else {
            return Ok(());
        };
        for limit in [turning.rolling, turning.spinning] {
            demand_finite(limit, input)?;
            demand_at_least(limit, o, Requirement::TurningOpposes, input)?;
            if load == o {
                demand_at_most(limit, o, Requirement::NoLoadNoForce, input)?;
            }
        }
        let speed = turning.turn_speed;
        demand_finite(speed, input)?;
        demand(speed > o, Requirement::TurningOpposes, speed, o, input)
    }

    /// Checks that the resistance is the same here, in the middle and without a position, unless
    /// the law depends on the position.
    fn same_resistance(&self, load: R, slip: R::Vec3) -> Result<(), Violation> {
        if self.friction.depends_on_position() {
            return Ok(());
        }
        // A law without resistance has the turn speed 0, which no resistance has.
        let numbers = |found: Option<RollingResistance<R>>| {
            found.map_or([R::ZERO; 3], |r| [r.rolling, r.spinning, r.turn_speed])
        };
        let at = |position| numbers(self.friction.rolling_resistance_at(position, load));
        let (here, elsewhere) = (at(self.position), at(self.centre));
        let without = numbers(self.friction.rolling_resistance(load));
        for (here, others) in here.into_iter().zip(elsewhere.into_iter().zip(without)) {
            let off = (here - others.0).abs() + (here - others.1).abs();
            let input = || self.input(load, slip);
            demand_at_most(off, R::ZERO, Requirement::SameEverywhere, input)?;
        }
        Ok(())
    }

    /// Checks that half of the load gives half of force and resistance, if the law says so.
    fn proportional_to_load(
        &self,
        load: R,
        slip: R::Vec3,
        force: R::Vec3,
    ) -> Result<(), Violation> {
        if !self.friction.is_proportional_to_load() {
            return Ok(());
        }
        let (input, fits) = (|| self.input(load, slip), Requirement::ProportionalToLoad);
        let half = load * R::HALF;
        let of_half = self.friction.force_at(self.position, half, slip);
        let off = (of_half * R::TWO - force).length();
        demand_at_most(off, force.length() * ulps(64.0) + unresolved(), fits, input)?;
        let resistances = [load, half].map(|load| {
            let found = self.friction.rolling_resistance_at(self.position, load);
            found.map_or([R::ZERO; 2], |found| [found.rolling, found.spinning])
        });
        let [whole, half] = resistances;
        for (whole, half) in whole.into_iter().zip(half) {
            let off = (half * R::TWO - whole).abs();
            demand_at_most(off, whole * ulps(64.0) + unresolved(), fits, input)?;
        }
        Ok(())
    }

    fn jacobian_at(&self, load: R, slip: R::Vec3, force: R::Vec3) -> Result<(), Violation> {
        let input = || self.input(load, slip);
        let jacobian = self.friction.jacobian_at(self.position, load, slip);
        for number in [
            jacobian.coefficient,
            jacobian.per_load,
            jacobian.width,
            jacobian.growth,
        ] {
            demand_finite(number, input)?;
        }
        let (o, fits) = (R::ZERO, Requirement::JacobianFits);
        demand_at_least(jacobian.coefficient, o, fits, input)?;
        demand_at_least(jacobian.growth, o, fits, input)?;
        demand_at_most(jacobian.growth, R::ONE + ulps(8.0), fits, input)?;
        demand(jacobian.width > o, fits, jacobian.width, o, input)?;
        let speed = slip.length();
        if speed > R::ZERO {
            let braking = -(force.dot(slip) / speed);
            let off = (jacobian.coefficient * speed - braking).abs();
            let bound = (braking + force.length()) * R::EPSILON.sqrt() + unresolved();
            demand_at_most(off, bound, fits, input)?;
        }
        Ok(())
    }

    fn metric_at(&self, load: R, slip: R::Vec3, force: R::Vec3) -> Result<(), Violation> {
        let (input, fits) = (|| self.input(load, slip), Requirement::MetricFits);
        let [found, always] = [self.position, R::Vec3::ZERO].map(|at| self.friction.metric_at(at));
        let off = if found.is_some() == always.is_some() {
            R::ZERO
        } else {
            R::ONE
        };
        demand_at_most(off, R::ZERO, fits, input)?;
        let Some([x, y, z]) = found else {
            return Ok(());
        };
        let size = x.length() + y.length() + z.length();
        demand_finite(size, input)?;
        let skew = R::Vec3::new(z.y() - y.z(), x.z() - z.x(), y.x() - x.y());
        demand_at_most(skew.length(), size * ulps(16.0), fits, input)?;
        // Products of smaller forces underflow.
        let is_resolved = force.length().at_most(slip.length()) > unresolved::<R>().sqrt();
        let metric = Metric::of(self.friction, self.position, slip);
        if let (Some(metric), true) = (metric, is_resolved) {
            let along = metric.along_friction(slip);
            let off = force.cross(along).length();
            let bound = force.length() * along.length() * R::EPSILON.sqrt();
            demand_at_most(off, bound, fits, input)?;
        }
        Ok(())
    }

    fn derivatives_at(&self, load: R, slip: R::Vec3) -> Result<(), Violation> {
        let slide = Slide {
            friction: self.friction,
            position: self.position,
            load,
            slip,
        };
        slide.check(|| self.input(load, slip))
    }
}

#[cfg(test)]
mod tests;
