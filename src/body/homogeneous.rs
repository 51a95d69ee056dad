//! Mass properties of homogeneous solids: a formula for each, and the public constructors, which
//! check the sizes first.
//!
//! A size enters its moments as a square, so that a negative one would leave no trace in them. The
//! bodies of this crate store their sizes and check them when a scene is composed: they take the
//! formulas.

use super::MassProperties;
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

// A parameter type `V` of a method is `R::Vec3`. As a type parameter it lets the compiler infer the
// precision, which a projection does not.
impl<R: Real> MassProperties<R> {
    /// Thin straight rod along z: moment `m l²/12` across it, 0 about its own axis. Mass in kg,
    /// length in m.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or the length is negative or not finite.
    pub fn rod(mass: R, length: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        error::at_least_zero("length of the rod", length, " m")?;
        Ok(rod(mass, length))
    }

    /// Ball: moments `2 m r²/5`. Mass in kg, radius in m.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or the radius is negative or not finite.
    pub fn ball(mass: R, radius: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        error::at_least_zero("radius of the ball", radius, " m")?;
        Ok(ball(mass, radius))
    }

    /// Thin spherical shell: moments `2 m r²/3`. Mass in kg, radius in m.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or the radius is negative or not finite.
    pub fn shell(mass: R, radius: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        error::at_least_zero("radius of the shell", radius, " m")?;
        Ok(shell(mass, radius))
    }

    /// Ellipsoid with these semi-axes (m): moment `m (b² + c²)/5` about the first, and so on. Mass
    /// in kg.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or a semi-axis is negative or not finite.
    pub fn ellipsoid<V: Vector<R>>(mass: R, semi_axes: V) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        finite_mass(mass)?;
        error::at_least_zero("x semi-axis of the ellipsoid", semi_axes.x(), " m")?;
        error::at_least_zero("y semi-axis of the ellipsoid", semi_axes.y(), " m")?;
        error::at_least_zero("z semi-axis of the ellipsoid", semi_axes.z(), " m")?;
        Ok(ellipsoid(mass, semi_axes))
    }

    /// Box with these edges (m): moment `m (b² + c²)/12` about the first, and so on. Mass in kg.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or an edge is negative or not finite.
    pub fn cuboid<V: Vector<R>>(mass: R, edges: V) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        finite_mass(mass)?;
        error::at_least_zero("x edge of the cuboid", edges.x(), " m")?;
        error::at_least_zero("y edge of the cuboid", edges.y(), " m")?;
        error::at_least_zero("z edge of the cuboid", edges.z(), " m")?;
        Ok(cuboid(mass, edges))
    }

    /// Cylinder along z: moments `m r²/2` about its axis, `m (3 r² + h²)/12` across. Mass in kg,
    /// radius and height in m.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or a size is negative or not finite.
    pub fn cylinder(mass: R, radius: R, height: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        error::at_least_zero("radius of the cylinder", radius, " m")?;
        error::at_least_zero("height of the cylinder", height, " m")?;
        Ok(cylinder(mass, radius, height))
    }

    /// Cylinder along z between two hemispheres whose centres are `length` apart. Mass in kg,
    /// radius and length in m.
    ///
    /// The cylinder has the fraction `c = l/(l + 4r/3)` of the mass, and the hemispheres have
    /// `b = 1 - c`. The moment is `m (c r²/2 + 2 b r²/5)` about the axis. Across the axis it is `m
    /// (c (r²/4 + l²/12) + b (2r²/5 + l²/4 + 3 l r/8))`, because the centre of mass of a hemisphere
    /// is 3r/8 from its flat side.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, if the radius is not above 0 or not
    /// finite, or if the length is negative or not finite.
    pub fn capsule(mass: R, radius: R, length: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        // Without a radius and a length, the fraction c would be 0/0.
        error::above_zero("radius of the capsule", radius, " m")?;
        error::at_least_zero("length of the capsule", length, " m")?;
        Ok(capsule(mass, radius, length))
    }

    /// Cone along z with its base at z = 0 and its tip at z = `height`. Mass in kg, radius and
    /// height in m.
    ///
    /// The centre of mass is a quarter of the height above the base. Moments: `3 m r²/10` about the
    /// axis, `3 m (4 r² + h²)/80` across.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not finite, or a size is negative or not finite. For a
    /// tip that points down, use [`rotated`](Self::rotated).
    pub fn cone(mass: R, radius: R, height: R) -> Result<Self, SceneError> {
        finite_mass(mass)?;
        error::at_least_zero("radius of the cone", radius, " m")?;
        error::at_least_zero("height of the cone", height, " m")?;
        Ok(cone(mass, radius, height))
    }
}

/// A negative mass is a hole.
pub(super) fn finite_mass<R: Real>(mass: R) -> Result<(), SceneError> {
    error::finite("mass of a part", mass, " kg")
}

pub(super) fn rod<R: Real>(mass: R, length: R) -> MassProperties<R> {
    let across = mass * length * length / R::from_f64(12.0);
    MassProperties::about_origin(mass, across, across, R::ZERO)
}

pub(super) fn ball<R: Real>(mass: R, radius: R) -> MassProperties<R> {
    let moment = mass * radius * radius * R::from_f64(0.4);
    MassProperties::about_origin(mass, moment, moment, moment)
}

pub(super) fn shell<R: Real>(mass: R, radius: R) -> MassProperties<R> {
    let moment = mass * radius * radius * R::TWO / R::from_f64(3.0);
    MassProperties::about_origin(mass, moment, moment, moment)
}

pub(super) fn ellipsoid<R: Real>(mass: R, semi_axes: R::Vec3) -> MassProperties<R> {
    by_squares(mass / R::from_f64(5.0), semi_axes, mass)
}

pub(super) fn cuboid<R: Real>(mass: R, edges: R::Vec3) -> MassProperties<R> {
    by_squares(mass / R::from_f64(12.0), edges, mass)
}

/// Moments `factor (b² + c²)`, `factor (c² + a²)`, `factor (a² + b²)`.
fn by_squares<R: Real>(factor: R, sides: R::Vec3, mass: R) -> MassProperties<R> {
    let square = |side: R| factor * side * side;
    let (a, b, c) = (square(sides.x()), square(sides.y()), square(sides.z()));
    MassProperties::about_origin(mass, b + c, c + a, a + b)
}

pub(super) fn cylinder<R: Real>(mass: R, radius: R, height: R) -> MassProperties<R> {
    let square = radius * radius;
    let across = mass * (square * R::from_f64(3.0) + height * height) / R::from_f64(12.0);
    MassProperties::about_origin(mass, across, across, mass * square * R::HALF)
}

pub(super) fn capsule<R: Real>(mass: R, radius: R, length: R) -> MassProperties<R> {
    let c = R::from_f64;
    let caps = radius * c(4.0) / c(3.0);
    let of_caps = mass * caps / (length + caps);
    let of_tube = mass - of_caps;
    let (rr, ll, lr) = (radius * radius, length * length, length * radius);
    let along = of_tube * rr * R::HALF + of_caps * rr * c(0.4);
    let across = of_tube * (rr * c(0.25) + ll / c(12.0))
        + of_caps * (rr * c(0.4) + ll * c(0.25) + lr * c(0.375));
    MassProperties::about_origin(mass, across, across, along)
}

pub(super) fn cone<R: Real>(mass: R, radius: R, height: R) -> MassProperties<R> {
    let c = R::from_f64;
    let (rr, hh) = (radius * radius, height * height);
    let across = mass * (rr * c(4.0) + hh) * c(3.0) / c(80.0);
    let cone = MassProperties::about_origin(mass, across, across, mass * rr * c(0.3));
    cone.at(R::Vec3::new(R::ZERO, R::ZERO, height * c(0.25)))
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::error::Rule;

    type Constructor<R> = fn(R, [R; 3]) -> Result<MassProperties<R>, SceneError>;

    const ALL: [(Constructor<f64>, usize); 8] = [
        (|mass, [a, ..]| MassProperties::rod(mass, a), 1),
        (|mass, [a, ..]| MassProperties::ball(mass, a), 1),
        (|mass, [a, ..]| MassProperties::shell(mass, a), 1),
        (|mass, [a, b, _]| MassProperties::cylinder(mass, a, b), 2),
        (|mass, [a, b, _]| MassProperties::capsule(mass, a, b), 2),
        (|mass, [a, b, _]| MassProperties::cone(mass, a, b), 2),
        (|mass, a| MassProperties::cuboid(mass, DVec3::from(a)), 3),
        (|mass, a| MassProperties::ellipsoid(mass, DVec3::from(a)), 3),
    ];

    /// A size is squared, so that the moments of a negative one look like those of a body.
    #[test]
    fn a_size_that_is_negative_or_not_finite_is_named_with_its_value() {
        for (of, count) in ALL {
            for at in 0..count {
                for (size, rule) in [
                    (-0.015, Rule::AtLeastZero),
                    (f64::NAN, Rule::Finite),
                    (f64::INFINITY, Rule::Finite),
                ] {
                    let mut sizes = [0.1; 3];
                    sizes[at] = size;
                    let error = of(0.2, sizes).unwrap_err();
                    assert!(error.quantity.contains(" of the "), "{error}");
                    assert!(error.value.total_cmp(&size).is_eq(), "{error}");
                    let is_rule = error.rule == rule || error.rule == Rule::AboveZero;
                    assert!(is_rule && error.unit == " m", "{error}");
                }
            }
        }
    }

    #[test]
    fn a_mass_that_is_not_finite_is_refused_and_a_negative_one_is_a_hole() {
        for (of, _) in ALL {
            for mass in [f64::NAN, f64::INFINITY] {
                let error = of(mass, [0.1; 3]).unwrap_err();
                assert_eq!((error.quantity, error.unit), ("mass of a part", " kg"));
            }
            let (part, hole) = (of(0.2, [0.1; 3]).unwrap(), of(-0.2, [0.1; 3]).unwrap());
            assert_eq!(hole.inertia, part.inertia * -1.0);
        }
    }

    #[test]
    fn sizes_of_zero_are_valid_where_the_moments_are_defined() {
        let flat = MassProperties::cuboid(1.0_f32, Vec3::new(0.1, 0.2, 0.0));
        assert!(flat.unwrap().check().is_ok());
        assert!(MassProperties::cylinder(1.0, 0.1, 0.0).is_ok());
        assert!(MassProperties::capsule(1.0, 0.1, 0.0).is_ok());
        let error = MassProperties::capsule(1.0, 0.0, 0.0).unwrap_err();
        assert_eq!(error.rule, Rule::AboveZero);
    }
}
