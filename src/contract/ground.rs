//! Requirements of a ground.

use super::plan::{CheckPlan, across, cube_directions, unit};
use super::{
    Input, Requirement, Violation, cannot_be, check_centre, demand_at_least, demand_at_most,
    demand_finite, ulps, wide,
};
use crate::error::{self, SceneError};
use crate::ground::{GroundBounds, OneSurface, Plane, SpringDamperGround, Surface};
use crate::quadrature::UNIT_3;
use crate::real::{Real, Vector};

/// Region, penetration depths and speeds for which a ground is intended. The check evaluates
/// nothing beyond them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundRange<R: Real = f64> {
    /// Middle of the region, m, world axes, preferably on the surface.
    pub centre: R::Vec3,
    /// Distance from the middle to each side of the region, m, above 0. Hills and edges should be
    /// at least some hundredths of it wide.
    ///
    /// The check also evaluates points this far above and below the surface. On a
    /// [`Terrain`](crate::Terrain) choose it below the least radius of curvature, and check several
    /// regions. The gap beyond is not that of a terrain, and is reported as a fault of the surface.
    pub size: R,
    /// Largest penetration depth of a contact, m, above 0.
    pub depth: R,
    /// Largest closing or separating speed of a contact, m/s, above 0.
    pub speed: R,
}

impl<R: Real> GroundRange<R> {
    fn check(&self) -> Result<(), SceneError> {
        check_centre::<R>(self.centre)?;
        error::above_zero("size of the range", self.size, " m")?;
        error::above_zero("depth of the range", self.depth, " m")?;
        error::above_zero("speed of the range", self.speed, " m/s")
    }
}

/// Checks a ground.
///
/// *The surface*, at points of the region and near the surface: the normal has length 1, and the
/// `bounds` are true. The gap changes between two points by `normal · path`, otherwise the springs
/// would generate energy as a contact moves along. So the gap is a distance. A height field's
/// `(z - h(x, y)) cos θ` is a distance at the surface only, and fails by penetration depth times
/// curvature.
///
/// *The motion* of a ground that moves is along the surface at each of these points.
///
/// Each of several surfaces is checked as a ground of its own.
///
/// *The law*, from 10⁻¹² of the penetration depth to the full depth, at speeds of both signs and 0:
/// springs push and never pull. Their energy increases and is the integral of the force, by Gauss's
/// rule on 64 parts. The normal force is at least 0. The force beyond that of the springs only
/// dissipates energy.
///
/// *The mean force*, on paths into, in, out of and above the ground: no number is negative. Its
/// work `force · path` is at least the energy that the springs store, and at most the energy that
/// they return. It is the mean of the normal force along the path, to 5 % of the largest force
/// there. The three points of the provided method have this error where the force is clamped.
///
/// *Limits:* the check samples, and may miss narrow faults. In a range of 1 m, 5 cm and 5 m/s, for
/// 100 seeds:
///
/// | fault | found with 200 cases (default) | 1000 | 5000 |
/// |---|---|---|---|
/// | a ridge across the region, 0.2 mm wide and 1 mm high | 2 % | 10 % | 54 % |
/// | a spike of the spring force, 0.2 mm of depth wide and twice as high | 21 % | 74 % | 100 % |
/// | a cliff of 2 cm in the gap | 1 % | 2 % | 16 % |
///
/// A needle of that width on the surface was not found with 100,000 cases by any of 20 seeds. Make
/// the range as small as the expected fault, or increase [`CheckPlan::cases`].
///
/// Tolerances are some units in the last place of the terms. For integrals they also include four
/// times the difference between partitions. The springs' energy may deviate by 1024 units in the
/// last place of the energy at the largest penetration depth. A formula such as `e^x - 1 - x`
/// deviates so much at small penetration depths, where `exp_m1` is more accurate. Forces must be at
/// least 0 without tolerance. The slope and the damping of a mean force are checked by their signs
/// alone. `EnergyMomentum` iterates with both, so with wrong ones it may lose energy in long steps.
///
/// ```
/// use tumble::contract::{CheckPlan, GroundRange, check_ground};
/// use tumble::glam::DVec3;
///
/// let range = GroundRange { centre: DVec3::ZERO, size: 1.0, depth: 0.1, speed: 10.0 };
/// check_ground(&tumble::FlatGround::level(1000.0, 0.5), &range, CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// Returns the first [`Violation`], with the requirement that is broken and the input that breaks
/// it. A quantity of the range that is invalid is named with its rule and its value.
pub fn check_ground<R: Real, G: SpringDamperGround<R> + ?Sized>(
    ground: &G,
    range: &GroundRange<R>,
    plan: CheckPlan,
) -> Result<(), Violation> {
    range.check().map_err(cannot_be)?;
    ground.check().map_err(cannot_be)?;
    (0..ground.surfaces().unwrap_or(1)).try_for_each(|index| {
        let surface = OneSurface::of(ground, index);
        check_surface(&surface, range, plan)
    })
}

/// Checks a ground of one surface.
fn check_surface<R: Real>(
    ground: &impl SpringDamperGround<R>,
    range: &GroundRange<R>,
    plan: CheckPlan,
) -> Result<(), Violation> {
    let check = Check { ground, range };
    check.surface_everywhere(plan)?;
    check.law_everywhere(plan)?;
    check.mean_force_everywhere(plan)
}

/// Fractions of the penetration depth that are combined.
const SHARES: [f64; 8] = [1e-12, 1e-9, 1e-6, 1e-3, 0.03, 0.3, 0.9, 1.0];
/// Fractions of the speed.
const SPEEDS: [f64; 9] = [0.0, 1e-9, -1e-9, 1e-3, -1e-3, 0.1, -0.1, 1.0, -1.0];
/// Ends of paths, as fractions of the penetration depth.
const ENDS: [f64; 9] = [-1.0, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.3, 0.9, 1.0];

struct Check<'a, R: Real, G: ?Sized> {
    ground: &'a G,
    range: &'a GroundRange<R>,
}

impl<R: Real, G: SpringDamperGround<R> + ?Sized> Check<'_, R, G> {
    fn surface_everywhere(&self, plan: CheckPlan) -> Result<(), Violation> {
        let (centre, size) = (self.range.centre, self.range.size);
        self.bounds_are_a_plane()?;
        for direction in cube_directions::<R>() {
            for share in [0.0, 1e-6, 0.5, 1.0] {
                let place = centre + direction * (size * R::from_f64(share));
                self.surface_around(place, direction)?;
            }
        }
        let mut draw = plan.draw();
        for _ in 0..plan.cases {
            let place = centre + draw.place::<R>() * size;
            self.surface_around(place, draw.direction::<R>())?;
        }
        Ok(())
    }

    /// Checks the surface at a point, and near the surface below or above it.
    fn surface_around(&self, place: R::Vec3, direction: R::Vec3) -> Result<(), Violation> {
        self.surface_at(place, direction)?;
        let surface = self.ground.surface(place);
        let within = self.range.size * R::from_f64(4.0);
        if surface.gap.abs() <= within {
            let depth = self.range.depth;
            for height in [R::ZERO, depth * R::HALF, -(depth * R::HALF)] {
                let moved = place - surface.normal * (surface.gap - height);
                self.surface_at(moved, direction)?;
            }
        }
        Ok(())
    }

    fn surface_at(&self, place: R::Vec3, direction: R::Vec3) -> Result<(), Violation> {
        let input = || Input::Point {
            point: wide::<R>(place),
        };
        let surface = self.ground.surface(place);
        demand_finite(surface.gap, input)?;
        let off = (surface.normal.length() - R::ONE).abs();
        demand_at_most(off, ulps(32.0), Requirement::UnitNormal, input)?;
        self.under_is_surface(&surface, place)?;
        self.bounds_hold_at(place)?;
        self.motion_along(&surface, place)?;
        if self.ground.bounds() == GroundBounds::Nowhere {
            return Ok(());
        }
        let level = across::<R>(surface.normal, direction);
        let slanted = unit::<R>(surface.normal + level);
        for way in [surface.normal, level, slanted] {
            self.gap_along(place, way)?;
        }
        Ok(())
    }

    /// Checks the surface for contacts without a radius, and with one that touches by rounding or
    /// does not.
    fn under_is_surface(&self, surface: &Surface<R>, place: R::Vec3) -> Result<(), Violation> {
        let rounding = (place.length() + self.range.size) * ulps(32.0);
        let near = surface.gap.abs();
        let touching = near + rounding * R::from_f64(16.0);
        for radius in [R::ZERO, near * R::HALF, touching] {
            let least = match self.ground.surface_under(place, radius) {
                None => radius - rounding,
                Some(under) if under == *surface => continue,
                Some(_) => R::MAX,
            };
            demand_at_least(surface.gap, least, Requirement::SurfaceUnder, || {
                Input::Point {
                    point: wide::<R>(place),
                }
            })?;
        }
        Ok(())
    }

    /// Checks that the material of a ground that moves stays on its surface.
    fn motion_along(&self, surface: &Surface<R>, place: R::Vec3) -> Result<(), Violation> {
        let Some(motion) = self.ground.motion() else {
            return Ok(());
        };
        let input = || Input::Point {
            point: wide::<R>(place),
        };
        let foot = place - surface.normal * surface.gap;
        let across = motion.velocity_at(foot).dot(surface.normal);
        demand_finite(across, input)?;
        let fastest = motion.velocity.length() + motion.angular_velocity.length() * foot.length();
        let allowed = fastest * ulps(64.0);
        let requirement = Requirement::MotionAlongSurface;
        demand_at_most(across.abs(), allowed, requirement, input)
    }

    /// Compares the change of the gap over a short displacement with `∫ normal · ds` by Simpson's
    /// rule.
    ///
    /// The mean of the normal lies between the normals found. If they differ, at a curve or an
    /// edge, the tolerance includes the difference.
    fn gap_along(&self, place: R::Vec3, way: R::Vec3) -> Result<(), Violation> {
        let length = self.range.size * R::EPSILON.sqrt().sqrt();
        let half = way * (length * R::HALF);
        let [a, m, b] = [place - half, place, place + half];
        let [from, middle, to] = [a, m, b].map(|point| self.ground.surface(point));
        if from.gap.at_most(to.gap) > self.range.size {
            // Nothing of the region's size touches there.
            return Ok(());
        }
        let bend = (from.normal - to.normal)
            .length()
            .at_least((from.normal - middle.normal).length())
            .at_least((middle.normal - to.normal).length());
        let mean =
            (from.normal + middle.normal * R::from_f64(4.0) + to.normal) * R::from_f64(1.0 / 6.0);
        let change = to.gap - from.gap;
        let expected = mean.dot(b - a);
        let numbers = place.length() + self.range.size + from.gap.abs() + to.gap.abs();
        let slack = numbers * ulps(32.0) + bend * length;
        demand_at_most(
            (change - expected).abs(),
            slack,
            Requirement::GapAlongNormal,
            || Input::Displacement {
                from: wide::<R>(a),
                to: wide::<R>(b),
            },
        )
    }

    fn bounds_are_a_plane(&self) -> Result<(), Violation> {
        match self.ground.bounds() {
            GroundBounds::Plane(plane) | GroundBounds::Below(plane) => {
                plane.check().map_err(cannot_be)
            }
            GroundBounds::Nowhere | GroundBounds::Everywhere => Ok(()),
        }
    }

    fn bounds_hold_at(&self, place: R::Vec3) -> Result<(), Violation> {
        match self.ground.bounds() {
            GroundBounds::Nowhere => self.nowhere_holds_at(place),
            GroundBounds::Plane(plane) => self.plane_holds_at(&plane, place),
            GroundBounds::Below(plane) => {
                self.bound_holds_at(&plane, place)?;
                // Also slightly above the plane, where a wrong bound shows first.
                let hair = self.range.size * R::from_f64(1e-6);
                let lifted = place + plane.normal * (hair - plane.gap(place));
                self.bound_holds_at(&plane, lifted)
            }
            GroundBounds::Everywhere => Ok(()),
        }
    }

    /// Checks that not even a body of the region's size touches.
    fn nowhere_holds_at(&self, place: R::Vec3) -> Result<(), Violation> {
        let gap = self.ground.surface(place).gap;
        demand_at_least(gap, self.range.size, Requirement::GroundBounds, || {
            Input::Point {
                point: wide::<R>(place),
            }
        })
    }

    fn plane_holds_at(&self, plane: &Plane<R>, place: R::Vec3) -> Result<(), Violation> {
        let input = || Input::Point {
            point: wide::<R>(place),
        };
        let surface = self.ground.surface(place);
        let off = (surface.gap - plane.gap(place)).abs();
        demand_at_most(
            off,
            self.rounding(plane, place),
            Requirement::GroundBounds,
            input,
        )?;
        let turned = (surface.normal - plane.normal).length();
        demand_at_most(turned, ulps(32.0), Requirement::GroundBounds, input)
    }

    /// Checks that a point above the plane is at least as far from the ground as from the plane.
    fn bound_holds_at(&self, plane: &Plane<R>, place: R::Vec3) -> Result<(), Violation> {
        let above = plane.gap(place);
        if above < R::ZERO {
            return Ok(());
        }
        let bound = above - self.rounding(plane, place);
        let gap = self.ground.surface(place).gap;
        demand_at_least(gap, bound, Requirement::GroundBounds, || Input::Point {
            point: wide::<R>(place),
        })
    }

    fn rounding(&self, plane: &Plane<R>, place: R::Vec3) -> R {
        (place.length() + plane.height.abs() + self.range.size) * ulps(32.0)
    }
}

/// Checks of the law.
impl<R: Real, G: SpringDamperGround<R> + ?Sized> Check<'_, R, G> {
    fn law_everywhere(&self, plan: CheckPlan) -> Result<(), Violation> {
        let at = |share: f64| self.range.depth * R::from_f64(share);
        for (i, share) in SHARES.into_iter().enumerate() {
            for speed in SPEEDS {
                self.law_at(at(share), self.range.speed * R::from_f64(speed))?;
            }
            self.energy_between(R::ZERO, at(share))?;
            for further in SHARES.into_iter().skip(i + 1) {
                self.energy_between(at(share), at(further))?;
            }
        }
        let mut draw = plan.draw();
        for _ in 0..plan.cases {
            let depth = self.range.depth * draw.scale(40);
            let further = depth + (self.range.depth - depth) * draw.scale(20);
            let speed = self.range.speed * draw.scale(30);
            self.law_at(depth, speed)?;
            self.law_at(depth, -speed)?;
            self.energy_between(depth, further)?;
        }
        Ok(())
    }

    fn law_at(&self, depth: R, closing_speed: R) -> Result<(), Violation> {
        let input = || Input::Penetration {
            depth: depth.to_f64(),
            closing_speed: closing_speed.to_f64(),
        };
        let spring = self.ground.spring_force(depth);
        let normal = self.ground.normal_force(depth, closing_speed);
        demand_finite(spring, input)?;
        demand_finite(normal, input)?;
        demand_at_least(spring, R::ZERO, Requirement::SpringPushes, input)?;
        demand_at_least(normal, R::ZERO, Requirement::NeverPulls, input)?;
        let taken = (normal - spring) * closing_speed;
        let bound = -((spring + normal) * closing_speed.abs() * ulps(8.0));
        demand_at_least(taken, bound, Requirement::DamperTakes, input)
    }

    fn energy_between(&self, from: R, to: R) -> Result<(), Violation> {
        let input = || Input::Depths {
            from: from.to_f64(),
            to: to.to_f64(),
        };
        let (start, end) = (self.energy(from), self.energy(to));
        demand_finite(end, input)?;
        // A formula's terms may be as large as the largest force makes them.
        let largest = self.ground.spring_force(self.range.depth);
        demand_finite(largest, || Input::Penetration {
            depth: self.range.depth.to_f64(),
            closing_speed: 0.0,
        })?;
        let terms = largest * to * ulps(8.0);
        let slack = (start + end) * ulps(256.0) + terms + self.rounding_of_energy();
        demand_at_least(end, -slack, Requirement::SpringEnergyRises, input)?;
        let stored = end - start;
        demand_at_least(stored, -slack, Requirement::SpringEnergyRises, input)?;
        let (work, doubt) = integral(from, to, |depth| self.ground.spring_force(depth));
        let slack = slack + work.abs() * ulps(256.0) + doubt;
        let off = (stored - work).abs();
        demand_at_most(off, slack, Requirement::EnergyIsIntegral, input)
    }

    fn energy(&self, depth: R) -> R {
        if depth > R::ZERO {
            self.ground.spring_energy(depth)
        } else {
            R::ZERO
        }
    }

    /// Rounding that the terms of a formula may leave in a small energy, J. For `e^x - 1 - x` at a
    /// small x, it is some rounding of 1.
    fn rounding_of_energy(&self) -> R {
        self.energy(self.range.depth).abs() * ulps(1024.0)
    }

    /// Error that underflow may leave in a small energy, J.
    fn least_energy(&self) -> R {
        self.energy(self.range.depth).abs() * R::EPSILON * R::EPSILON
    }
}

/// Checks of the mean force.
impl<R: Real, G: SpringDamperGround<R> + ?Sized> Check<'_, R, G> {
    fn mean_force_everywhere(&self, plan: CheckPlan) -> Result<(), Violation> {
        for start in ENDS {
            for end in ENDS {
                for speed in [1.0, 0.03, 1e-6] {
                    self.mean_force_between(
                        self.range.depth * R::from_f64(start),
                        self.range.depth * R::from_f64(end),
                        self.range.speed * R::from_f64(speed),
                    )?;
                }
            }
        }
        let mut draw = plan.draw();
        for _ in 0..plan.cases {
            let start = self.range.depth * draw.either();
            let end = match draw.pick(3) {
                0 => self.range.depth * draw.either(),
                1 => start * (R::ONE + draw.either::<R>() * draw.scale(30)),
                _ => self.range.depth * draw.scale(30),
            };
            self.mean_force_between(start, end, self.range.speed * draw.scale(30))?;
        }
        Ok(())
    }

    fn mean_force_between(&self, start: R, end: R, speed: R) -> Result<(), Violation> {
        let path = end - start;
        let still = path == R::ZERO;
        let seconds = if still { self.range.depth } else { path.abs() } / speed;
        let input = || Input::Path {
            start: start.to_f64(),
            end: end.to_f64(),
            seconds: seconds.to_f64(),
        };
        let mean = self.ground.mean_force(start, end, seconds);
        for number in [mean.force, mean.slope, mean.stiffness, mean.damping] {
            demand_finite(number, input)?;
            demand_at_least(number, R::ZERO, Requirement::MeanForceSigns, input)?;
        }
        if start <= R::ZERO && end <= R::ZERO {
            return demand_at_most(mean.force, R::ZERO, Requirement::MeanForceAbove, input);
        }
        let (before, after) = (self.energy(start), self.energy(end));
        let work = mean.force * path;
        let slack = (before + after + work.abs()) * ulps(256.0) + self.rounding_of_energy();
        let least = (after - before) - slack;
        demand_at_least(work, least, Requirement::MeanForceTakes, input)?;

        let (expected, largest) = self.mean_by_definition(start, end, seconds);
        let off = (mean.force - expected).abs();
        let mut slack = largest * R::from_f64(0.05) + self.least_energy() / self.range.depth;
        if !still {
            slack += self.rounding_of_energy() / path.abs();
        }
        demand_at_most(off, slack, Requirement::MeanForceIsMean, input)
    }

    /// Mean of the normal force along a path, and the largest force on it.
    fn mean_by_definition(&self, start: R, end: R, seconds: R) -> (R, R) {
        let (path, closing_speed) = (end - start, (end - start) / seconds);
        let mut largest = R::ZERO;
        let mut force = |depth: R| {
            let normal = self.ground.normal_force(depth, closing_speed);
            let spring = self.ground.spring_force(depth);
            largest = largest.at_least(normal).at_least(spring);
            normal
        };
        if path == R::ZERO {
            return (force(start), largest);
        }
        let (from, to) = (start.at_least(R::ZERO), end.at_least(R::ZERO));
        // A path in the ground so short that its middle is its mean. Parts of it would be rounding.
        let mean = if (to - from).abs() < (from + to) * ulps(1e4) {
            force((from + to) * R::HALF)
        } else {
            integral(from, to, &mut force).0 / path
        };
        (mean, largest)
    }
}

/// `∫ f` over `from ... to`, and a bound of its error.
///
/// The bound is four times the difference between partitions, plus a contribution from the ends,
/// which the outermost points do not sample.
///
/// The partitions share no inner border. So a discontinuity of `f` cannot be at the same distance
/// from a border in all of them.
fn integral<R: Real>(from: R, to: R, mut f: impl FnMut(R) -> R) -> (R, R) {
    let mut by_gauss = |parts: usize| {
        let width = (to - from) / R::from_usize(parts);
        let mut sum = R::ZERO;
        for part in 0..parts {
            let start = from + width * R::from_usize(part);
            for [place, weight] in UNIT_3 {
                sum += f(start + width * R::from_f64(place)) * R::from_f64(weight);
            }
        }
        sum * width
    };
    let [a, b, c, d] = [7, 17, 31, PARTS].map(&mut by_gauss);
    let doubt = (a - b).abs() + (b - c).abs() + (c - d).abs();
    let width = (to - from) / R::from_usize(PARTS);
    let ends = unseen(&mut f, from, width) + unseen(&mut f, to, -width);
    (d, doubt * R::from_f64(4.0) + ends)
}

/// Possible contribution between the border of an integral and the point next to it. It is the
/// deviation of `f` at the border from the line through the next two points.
fn unseen<R: Real>(f: &mut impl FnMut(R) -> R, border: R, width: R) -> R {
    let [near, middle] = [UNIT_3[0][0], 0.5].map(|place| f(border + width * R::from_f64(place)));
    let share = R::from_f64(UNIT_3[0][0]);
    let line = near + (near - middle) * (share / (R::HALF - share));
    // Slightly inside, because laws are not evaluated at the surface itself.
    let at_border = f(border + width * ulps(4.0));
    ((at_border - line) * width * share).abs()
}

/// Number of parts of the finest partition.
const PARTS: usize = 64;

#[cfg(test)]
mod tests;
