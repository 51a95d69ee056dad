//! Mass and inertia in the form that a step uses: principal axes, inverse moments, and the
//! torque-free rotation of two equal moments.

mod jacobi;

use crate::error::{self, Rule, SceneError};
use crate::real::{Matrix, Real, Vector, is_single};
use crate::rotation::{Axes, BodyAxis, Rotation};
use jacobi::principal_axes;

/// Mass and inertia of a body, computed once when a scene is composed.
///
/// The inverse inertia tensor is stored as `t 1 + s a aᵀ + d b bᵀ`:
///
/// - `t` is an inverse moment common to all axes.
/// - `s` is the excess of the inverse moment about the axis `a` of a (nearly) symmetric body.
/// - `d` is the excess about a second principal axis `b`.
///
/// `d` is 0 for a body with two equal moments. `s` and `d` are 0 for a body with three equal
/// moments. A moment of 0 (a point, or a line about itself) has the inverse 0 here: the body does
/// not rotate about that axis. The same holds for a moment below 64 units in the last place of the
/// largest one (1.4e-14 of it in f64, 7.6e-6 in f32), which is the rounding of 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaProperties<R: Real = f64> {
    mass: R,
    inverse_mass: R,
    moments: R::Vec3,
    principal: Axes<R>,
    common: R,
    symmetry: Excess<R>,
    asymmetry: Excess<R>,
    solving: Solving<R>,
}

/// Regular inertia tensor for equations that require one: `c 1 + s a aᵀ + d b bᵀ` with the axes of
/// the inverse tensor.
///
/// A principal moment of zero is replaced by the largest moment (for a point, by 1 m² times the
/// mass), and the angular momentum about that axis by zero. The axis then contributes no energy.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Solving<R: Real> {
    common: R,
    symmetry: R,
    asymmetry: R,
    turns: Turns,
}

/// Axes about which a body rotates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turns {
    /// All axes.
    Freely,
    /// All axes except the axis of symmetry: a rod.
    Across,
    /// No axis: a point.
    Never,
}

impl<R: Real> Solving<R> {
    fn new(
        mass: R,
        moments: [R; 3],
        inverse: [R; 3],
        [distinct, larger, smaller]: [usize; 3],
    ) -> Self {
        let turns = if nth(inverse, larger) == R::ZERO {
            Turns::Never
        } else if nth(inverse, distinct) == R::ZERO {
            Turns::Across
        } else {
            Turns::Freely
        };
        let excess = |moment: R| match turns {
            Turns::Freely => moment - nth(moments, larger),
            Turns::Across | Turns::Never => R::ZERO,
        };
        Self {
            common: if turns == Turns::Never {
                mass
            } else {
                nth(moments, larger)
            },
            symmetry: excess(nth(moments, distinct)),
            asymmetry: excess(nth(moments, smaller)),
            turns,
        }
    }
}

/// Excess of the inverse moment about one principal axis over the common inverse moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Excess<R: Real> {
    axis: BodyAxis<R>,
    /// Inverse moment, 1/(kg m²).
    inverse: R,
}

impl<R: Real> Excess<R> {
    /// Contribution to the angular velocity (rad/s, world axes).
    #[inline(always)]
    fn spin(&self, axes: &Axes<R>, angular_momentum: R::Vec3) -> R::Vec3 {
        self.spin_about(self.axis.in_world(axes), angular_momentum)
    }

    /// Contribution to the angular velocity, for the axis in world axes.
    #[inline(always)]
    fn spin_about(&self, axis: R::Vec3, angular_momentum: R::Vec3) -> R::Vec3 {
        axis * (self.inverse * axis.dot(angular_momentum))
    }

    /// Half of the angle of rotation about this axis (world axes) within `seconds`.
    #[inline(always)]
    fn half_turn(&self, axis: R::Vec3, angular_momentum: R::Vec3, seconds: R) -> R {
        self.inverse * axis.dot(angular_momentum) * (seconds * R::HALF)
    }

    /// Rotates `rotation` further about this axis of the body, by the contribution of this excess
    /// within `seconds`.
    #[inline(always)]
    fn turn(
        &self,
        rotation: Rotation<R>,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
        seconds: R,
    ) -> Rotation<R> {
        let axis = self.axis.in_world(axes);
        rotation.spun(self.axis, self.half_turn(axis, angular_momentum, seconds))
    }
}

impl<R: Real> InertiaProperties<R> {
    /// Computes the properties from the mass (kg) and the inertia tensor about the centre of mass
    /// (kg m², body axes).
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not above 0, the tensor is not symmetric or not
    /// finite, a principal moment is negative, or one moment exceeds the sum of the other two. Also
    /// returns it if the inverse of the mass or of a moment overflows.
    pub fn new(mass: R, inertia: R::Mat3) -> Result<Self, SceneError> {
        error::above_zero("mass", mass, " kg")?;
        error::finite_inverse("mass", mass, " kg")?;
        let (moments, principal) = principal_axes(check_tensor::<R>(inertia)?);
        let largest = moments[0].at_least(moments[1]).at_least(moments[2]);
        let rounding = rounding_of(largest);
        check_moments(moments, rounding)?;
        for moment in moments.into_iter().filter(|&moment| moment > rounding) {
            error::finite_inverse("a principal moment of inertia", moment, " kg m²")?;
        }
        let inverse = moments.map(|moment| {
            if moment > rounding {
                R::ONE / moment
            } else {
                R::ZERO
            }
        });
        let equal = |i: usize, j: usize| (nth(moments, i) - nth(moments, j)).abs() <= rounding;
        let [distinct, larger, smaller] = by_symmetry(moments);
        let common = nth(inverse, larger);
        let excess = |i: usize| Excess {
            axis: BodyAxis::along(nth(principal, i)),
            inverse: if equal(i, larger) {
                R::ZERO
            } else {
                nth(inverse, i) - common
            },
        };
        Ok(Self {
            mass,
            inverse_mass: R::ONE / mass,
            moments: R::Vec3::new(moments[0], moments[1], moments[2]),
            principal: Axes {
                x: principal[0],
                y: principal[1],
                z: principal[2],
            },
            common,
            symmetry: excess(distinct),
            asymmetry: excess(smaller),
            solving: Solving::new(mass, moments, inverse, [distinct, larger, smaller]),
        })
    }

    /// Mass, kg.
    #[inline]
    #[must_use]
    pub fn mass(&self) -> R {
        self.mass
    }

    /// Inverse of the mass, 1/kg.
    #[inline]
    #[must_use]
    pub fn inverse_mass(&self) -> R {
        self.inverse_mass
    }

    /// Principal moments about x, y and z of [`principal_axes`](Self::principal_axes), kg m².
    #[must_use]
    pub fn moments(&self) -> R::Vec3 {
        self.moments
    }

    /// Principal axes, unit vectors in body axes, right-handed.
    #[must_use]
    pub fn principal_axes(&self) -> &Axes<R> {
        &self.principal
    }

    /// Returns true if all three moments differ.
    #[inline]
    #[must_use]
    pub fn is_asymmetric(&self) -> bool {
        self.asymmetry.inverse != R::ZERO
    }

    /// Returns true if the moment about the axis of symmetry is smaller than the two equal ones, as
    /// that of a capsule is.
    #[inline]
    pub(crate) fn is_prolate(&self) -> bool {
        !self.is_asymmetric() && self.symmetry.inverse > rounding_of(self.common)
    }

    /// Returns true if the body does not rotate about the axis of this principal moment.
    #[inline]
    pub(crate) fn is_dead(&self, moment: R) -> bool {
        let [x, y, z] = [self.moments.x(), self.moments.y(), self.moments.z()];
        moment <= rounding_of(x.at_least(y).at_least(z))
    }

    /// Radius of gyration about the axis of the largest moment, m: `√(moment/mass)`.
    #[inline]
    pub(crate) fn radius_of_gyration(&self) -> R {
        let [x, y, z] = [self.moments.x(), self.moments.y(), self.moments.z()];
        (x.at_least(y).at_least(z) * self.inverse_mass).sqrt()
    }

    /// Angular velocity (rad/s, world axes) of a body with these axes and this angular momentum (kg
    /// m²/s, world axes): `ω = J⁻¹ L`.
    #[inline(always)]
    #[must_use]
    pub fn angular_velocity(&self, axes: &Axes<R>, angular_momentum: R::Vec3) -> R::Vec3 {
        let axis = self.symmetry.axis.in_world(axes);
        let mut spin = self.angular_velocity_of_symmetric(axis, angular_momentum);
        if self.is_asymmetric() {
            spin += self.asymmetry.spin(axes, angular_momentum);
        }
        spin
    }

    /// Angular momentum (kg m²/s, world axes) of a body with these axes and this angular velocity
    /// (rad/s, world axes): `L = J ω`.
    #[inline]
    #[must_use]
    pub fn angular_momentum(&self, axes: &Axes<R>, angular_velocity: R::Vec3) -> R::Vec3 {
        let spin = self.principal.to_body(axes.to_body(angular_velocity));
        let momentum = R::Vec3::new(
            self.moments.x() * spin.x(),
            self.moments.y() * spin.y(),
            self.moments.z() * spin.z(),
        );
        axes.to_world(self.principal.to_world(momentum))
    }

    /// Rotational energy (J) of a body with these axes and this angular momentum (kg m²/s, world
    /// axes): `L · J⁻¹ L/2`.
    ///
    /// It is computed as a sum of squares along and across the axes, so it is never below 0. For a
    /// rod, `L · ω` would be the rounding error of two huge numbers.
    #[inline]
    #[must_use]
    pub fn rotational_energy(&self, axes: &Axes<R>, angular_momentum: R::Vec3) -> R {
        if self.is_asymmetric() || is_single::<R>() {
            return self.steady_energy(axes, angular_momentum);
        }
        let axis = self.symmetry.axis.in_world(axes);
        let part = axis.dot(angular_momentum);
        let across = angular_momentum - axis * part;
        let along = part * part * (self.common + self.symmetry.inverse);
        (along + across.length_squared() * self.common) * R::HALF
    }

    /// Rotational energy for three different moments, and for f32, where the rounding of the
    /// squares is not negligible.
    ///
    /// It is `|L|²` with the inverse moment of the axis with the largest component, plus the
    /// differences that the small components cause. So a steady rotation has a steady energy.
    /// Rounding of the axes enters only with those small components. For three different moments,
    /// it would otherwise hide the small energy that a rotation about an axis next to a principal
    /// one has less than about that axis.
    fn steady_energy(&self, axes: &Axes<R>, angular_momentum: R::Vec3) -> R {
        let square = angular_momentum.length_squared();
        let (mut common, mut rest) = (self.common, R::ZERO);
        let mut add = |excess: &Excess<R>| {
            let axis = excess.axis.in_world(axes);
            let part = axis.dot(angular_momentum);
            if part * part * R::TWO > square {
                let across = angular_momentum - axis * part;
                common += excess.inverse;
                rest -= across.length_squared() * excess.inverse;
            } else {
                rest += part * part * excess.inverse;
            }
        };
        add(&self.symmetry);
        if self.is_asymmetric() {
            add(&self.asymmetry);
        }
        let energy = (square * common + rest) * R::HALF;
        // Written so that a NaN from overflowing squares is kept.
        if energy < R::ZERO { R::ZERO } else { energy }
    }

    /// Angular momentum without the part about axes with zero moment. An implicit step with a
    /// regular inertia leaves rounding errors there.
    #[inline]
    pub(crate) fn without_dead_spin(
        &self,
        rotation: Rotation<R>,
        angular_momentum: R::Vec3,
    ) -> R::Vec3 {
        if self.solving.turns == Turns::Freely {
            angular_momentum
        } else {
            let symmetry = self.symmetry.axis.in_world(&rotation.axes());
            self.without_dead_part(symmetry, angular_momentum)
        }
    }

    /// Angular momentum without the part about axes with zero moment, for a known axis of symmetry
    /// in world axes.
    #[inline]
    fn without_dead_part(&self, symmetry: R::Vec3, angular_momentum: R::Vec3) -> R::Vec3 {
        match self.solving.turns {
            Turns::Freely => angular_momentum,
            Turns::Across => angular_momentum - symmetry * symmetry.dot(angular_momentum),
            Turns::Never => R::Vec3::ZERO,
        }
    }

    /// Regular inertia tensor (columns, world axes) of a body with these axes, and the angular
    /// momentum without the part about axes with zero moment.
    #[inline]
    pub(crate) fn inertia_for_solving(
        &self,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
    ) -> ([R::Vec3; 3], R::Vec3) {
        let solving = &self.solving;
        let o = R::ZERO;
        let mut tensor = [
            R::Vec3::new(solving.common, o, o),
            R::Vec3::new(o, solving.common, o),
            R::Vec3::new(o, o, solving.common),
        ];
        let mut add = |axis: R::Vec3, moment: R| {
            let scaled = axis * moment;
            tensor[0] += scaled * axis.x();
            tensor[1] += scaled * axis.y();
            tensor[2] += scaled * axis.z();
        };
        let symmetry = self.symmetry.axis.in_world(axes);
        add(symmetry, solving.symmetry);
        if self.is_asymmetric() {
            add(self.asymmetry.axis.in_world(axes), solving.asymmetry);
        }
        let momentum = self.without_dead_part(symmetry, angular_momentum);
        (tensor, momentum)
    }

    /// Angular momentum of a body with these axes and this angular velocity, by the regular inertia
    /// tensor of [`inertia_for_solving`](Self::inertia_for_solving).
    ///
    /// It is computed in principal axes, where the smallest moment of a needle keeps its digits.
    #[inline]
    pub(crate) fn momentum_for_solving(
        &self,
        axes: &Axes<R>,
        angular_velocity: R::Vec3,
    ) -> R::Vec3 {
        if let Turns::Freely = self.solving.turns {
            return self.angular_momentum(axes, angular_velocity);
        }
        let ([x, y, z], _) = self.inertia_for_solving(axes, angular_velocity);
        let spin = angular_velocity;
        x * spin.x() + y * spin.y() + z * spin.z()
    }

    /// Largest inverse moment, 1/(kg m²): spin (rad/s) per angular momentum (kg m²/s) about the
    /// axis of the smallest nonzero moment. 0 for a point.
    #[inline]
    #[must_use]
    pub fn largest_inverse_moment(&self) -> R {
        self.common
            .at_least(self.common + self.symmetry.inverse)
            .at_least(self.common + self.asymmetry.inverse)
    }

    /// Torque-free rotation by the common and the symmetric part, not normalised. For a body with
    /// two equal moments this is [`turn_freely`](Self::turn_freely).
    #[inline(always)]
    pub(crate) fn turn_symmetric(
        &self,
        rotation: Rotation<R>,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
        seconds: R,
    ) -> Rotation<R> {
        let precession =
            Rotation::from_half_vector(self.half_precession(angular_momentum, seconds));
        precession.after(
            self.symmetry
                .turn(rotation, axes, angular_momentum, seconds),
        )
    }

    /// Half of the rotation vector of the common part of a torque-free rotation within `seconds`.
    #[inline(always)]
    pub(crate) fn half_precession(&self, angular_momentum: R::Vec3, seconds: R) -> R::Vec3 {
        angular_momentum * (self.common * (seconds * R::HALF))
    }

    /// Half of the angle of the symmetric part of a torque-free rotation within `seconds`, for the
    /// [axis of symmetry](Self::symmetry_axis) in world axes.
    #[inline(always)]
    pub(crate) fn half_spin(&self, axis: R::Vec3, angular_momentum: R::Vec3, seconds: R) -> R {
        self.symmetry.half_turn(axis, angular_momentum, seconds)
    }

    /// Angular velocity of a body with two equal moments, for its axis of symmetry in world axes.
    #[inline(always)]
    pub(crate) fn angular_velocity_of_symmetric(
        &self,
        axis: R::Vec3,
        angular_momentum: R::Vec3,
    ) -> R::Vec3 {
        angular_momentum * self.common + self.symmetry.spin_about(axis, angular_momentum)
    }

    /// Axis of symmetry.
    #[inline(always)]
    pub(crate) fn symmetry_axis(&self) -> BodyAxis<R> {
        self.symmetry.axis
    }

    /// Inverse moment of the third axis of [`unequal_axes`](Self::unequal_axes), 1/(kg m²).
    #[inline]
    pub(crate) fn common_inverse(&self) -> R {
        self.common
    }

    /// Excesses of the inverse moments of the first two axes of
    /// [`unequal_axes`](Self::unequal_axes) over that of the third, 1/(kg m²).
    #[inline]
    pub(crate) fn excesses(&self) -> [R; 2] {
        [self.symmetry.inverse, self.asymmetry.inverse]
    }

    /// Principal axes of three different moments, right-handed, for a body with these axes.
    #[inline]
    pub(crate) fn unequal_axes(&self, axes: &Axes<R>) -> [R::Vec3; 3] {
        let first = self.symmetry.axis.in_world(axes);
        let second = self.asymmetry.axis.in_world(axes);
        [first, second, first.cross(second)]
    }
}

/// Returns the rounding of a moment of 0, for the largest moment.
#[inline]
fn rounding_of<R: Real>(largest: R) -> R {
    largest * (R::EPSILON * R::from_f64(64.0))
}

/// Names of the entries of an inertia tensor, column by column.
const ENTRIES: [&str; 9] = [
    "xx of the inertia tensor",
    "yx of the inertia tensor",
    "zx of the inertia tensor",
    "xy of the inertia tensor",
    "yy of the inertia tensor",
    "zy of the inertia tensor",
    "xz of the inertia tensor",
    "yz of the inertia tensor",
    "zz of the inertia tensor",
];

/// Checks that each entry of an inertia tensor is finite.
pub(crate) fn finite_entries<R: Real>(inertia: R::Mat3) -> Result<(), SceneError> {
    let columns = inertia.columns().into_iter();
    let entries = columns.flat_map(|column| [column.x(), column.y(), column.z()]);
    for (name, entry) in ENTRIES.into_iter().zip(entries) {
        error::finite(name, entry, " kg m²")?;
    }
    Ok(())
}

/// Checks the tensor without its principal axes, and returns its entries.
fn check_tensor<R: Real>(inertia: R::Mat3) -> Result<[[R; 3]; 3], SceneError> {
    let rows = inertia
        .columns()
        .map(|column| [column.x(), column.y(), column.z()]);
    let mut largest = R::ZERO;
    finite_entries::<R>(inertia)?;
    for entry in rows.into_iter().flatten() {
        largest = largest.at_least(entry.abs());
    }
    for (i, j) in PAIRS {
        let gap = (nth(nth(rows, i), j) - nth(nth(rows, j), i)).abs();
        if gap > largest * R::EPSILON * R::from_f64(64.0) {
            return Err(SceneError::new(
                "the inertia tensor",
                Rule::Symmetric,
                gap.to_f64(),
                " kg m² between mirrored entries",
            ));
        }
    }
    Ok(rows)
}

fn check_moments<R: Real>(moments: [R; 3], rounding: R) -> Result<(), SceneError> {
    // A negative moment is reported first, because it also makes another moment exceed the sum.
    if let Some(moment) = moments.into_iter().find(|&moment| moment < -rounding) {
        return error::at_least_zero("a principal moment of inertia", moment, " kg m²");
    }
    for (i, moment) in moments.into_iter().enumerate() {
        let others = nth(moments, (i + 1) % 3) + nth(moments, (i + 2) % 3);
        if moment > others + rounding {
            return Err(SceneError::new(
                "a principal moment of inertia",
                Rule::TriangleInequality,
                moment.to_f64(),
                " kg m²",
            ));
        }
    }
    Ok(())
}

/// Element of an array of three, without a bounds check that could panic.
#[inline]
fn nth<T>([x, y, z]: [T; 3], index: usize) -> T {
    match index {
        0 => x,
        1 => y,
        _ => z,
    }
}

const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Numbers of the principal axes: the axis with the most different moment, then the other two, the
/// one with the larger moment first.
///
/// The two similar axes have most of their inverse moment in common. So the excess of the third
/// axis is least, and nearly equal moments are treated as nearly symmetric ones. The choice depends
/// on moments only, so that the motion does not depend on the axes in which the body is described.
fn by_symmetry<R: Real>(moments: [R; 3]) -> [usize; 3] {
    let [x, y, z] = moments;
    let [large, middle, small] = match (x >= y, y >= z, x >= z) {
        (true, true, _) => [0, 1, 2],
        (true, false, true) => [0, 2, 1],
        (true, false, false) => [2, 0, 1],
        (false, _, true) => [1, 0, 2],
        (false, true, false) => [1, 2, 0],
        (false, false, false) => [2, 1, 0],
    };
    if nth(moments, large) - nth(moments, middle) <= nth(moments, middle) - nth(moments, small) {
        [small, large, middle]
    } else {
        [large, middle, small]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat, DVec3};

    fn turned(moments: DVec3, turn: DQuat) -> DMat3 {
        let m = DMat3::from_quat(turn);
        m * DMat3::from_diagonal(moments) * m.transpose()
    }

    #[test]
    fn a_turned_tensor_has_the_moments_of_the_straight_one() {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 2.0));
        let moments = DVec3::new(1.0, 2.0, 2.5);
        let tensor = turned(moments, turn);
        let found =
            InertiaProperties::<f64>::new(1.0, (tensor + tensor.transpose()) * 0.5).unwrap();
        let mut sorted = found.moments().to_array();
        sorted.sort_by(f64::total_cmp);
        for (got, expected) in sorted.into_iter().zip(moments.to_array()) {
            assert!((got - expected).abs() < 1e-14, "{sorted:?}");
        }
        let axes = found.principal_axes();
        assert!((axes.x.cross(axes.y) - axes.z).length() < 1e-14);
    }

    #[test]
    fn momentum_and_velocity_are_inverse_to_each_other() {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 2.0));
        for moments in [
            DVec3::new(1.0, 2.0, 2.5),
            DVec3::new(2.0, 1.0, 2.0),
            DVec3::splat(3.0),
        ] {
            let tensor = turned(moments, turn);
            let mass = InertiaProperties::<f64>::new(1.0, tensor).unwrap();
            let axes = Rotation::<f64>::from_rotation_vector(DVec3::new(1.0, 0.2, 0.1)).axes();
            let momentum = DVec3::new(0.3, -0.2, 0.7);
            let velocity = mass.angular_velocity(&axes, momentum);
            let back = mass.angular_momentum(&axes, velocity);
            assert!((back - momentum).length() < 1e-14, "{moments}: {back}");
        }
    }

    #[test]
    fn a_point_does_not_turn_and_a_rod_does_not_spin_about_itself() {
        let axes = Rotation::<f64>::IDENTITY.axes();
        let point = InertiaProperties::<f64>::new(1.0, DMat3::ZERO).unwrap();
        assert_eq!(point.angular_velocity(&axes, DVec3::ONE), DVec3::ZERO);
        let rod =
            InertiaProperties::<f64>::new(1.0, DMat3::from_diagonal(DVec3::new(0.0, 2.0, 2.0)))
                .unwrap();
        assert_eq!(
            rod.angular_velocity(&axes, DVec3::new(4.0, 1.0, 0.0)),
            DVec3::new(0.0, 0.5, 0.0)
        );
    }

    #[test]
    fn the_free_turn_of_a_body_does_not_follow_the_numbers_of_its_axes() {
        // Tops of each kind: nearly a disc, nearly a rod, halfway between, two equal moments, and
        // three equal moments.
        for [a, b, c] in [
            [3.9e-3, 0.1334, 0.1373],
            [1.0, 1.1, 2.0],
            [1.0, 2.0, 3.0],
            [1.0, 1.0, 2.0],
            [1.0, 2.0, 2.0],
            [2.0, 2.0, 2.0],
        ] {
            let orders = [
                [a, b, c],
                [a, c, b],
                [b, a, c],
                [b, c, a],
                [c, a, b],
                [c, b, a],
            ];
            let kinds = orders.map(|moments| by_symmetry(moments).map(|i| moments[i]));
            assert_eq!(kinds, [kinds[0]; 6]);
            let [distinct, larger, smaller]: [f64; 3] = kinds[0];
            let gap = larger - smaller;
            assert!(gap >= 0.0, "{kinds:?}");
            assert!(gap <= (distinct - larger).abs(), "{kinds:?}");
            assert!(gap <= (distinct - smaller).abs(), "{kinds:?}");
        }
    }

    #[test]
    fn impossible_inertia_is_refused_with_its_value() {
        let of =
            |x, y, z| InertiaProperties::<f64>::new(1.0, DMat3::from_diagonal(DVec3::new(x, y, z)));
        assert_eq!(
            of(1.0, 1.0, 2.5).unwrap_err().rule,
            Rule::TriangleInequality
        );
        for negative in [of(-1.0, 1.0, 1.0), of(1.0, -1.0, 1.0), of(1.0, 1.0, -1.0)] {
            assert_eq!(negative.unwrap_err().rule, Rule::AtLeastZero);
        }
        assert_eq!(of(f64::NAN, 1.0, 1.0).unwrap_err().rule, Rule::Finite);
        let lopsided = DMat3::from_cols(
            DVec3::new(1.0, 0.5, 0.0),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(0.0, 0.0, 1.0),
        );
        let error = InertiaProperties::<f64>::new(1.0, lopsided).unwrap_err();
        assert_eq!(error.rule, Rule::Symmetric);
        let error = InertiaProperties::<f64>::new(-2.0, DMat3::IDENTITY).unwrap_err();
        assert_eq!(std::format!("{error}"), "mass must be above 0, got -2 kg");
    }
}
