//! Ready-made height fields: [`Bowl`], [`Ramp`] and [`Waves`].

use super::{Elevation, HeightField};
use crate::error::{self, SceneError};
use crate::real::Real;

/// Height field of a bowl, a trough, a hill or a saddle: `z = (c₁ x² + c₂ y²)/2`, m.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bowl<R = f64> {
    /// Curvatures c₁ and c₂ at the origin, along x and y, 1/m.
    ///
    /// Both are above 0 in a bowl and below 0 on a hill. One of them is 0 in a trough. The radii of
    /// curvature at the origin are their inverses.
    pub curvatures: [R; 2],
}

impl<R: Real> HeightField<R> for Bowl<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn elevation(&self, x: R, y: R) -> Elevation<R> {
        let [along_x, along_y] = self.curvatures;
        let slope = [along_x * x, along_y * y];
        let height = (slope[0] * x + slope[1] * y) * R::HALF;
        Elevation::new(height, slope).with_hessian([along_x, R::ZERO, along_y])
    }

    #[inline]
    fn highest(&self) -> Option<R> {
        let is_hill = self.curvatures.iter().all(|&c| c <= R::ZERO);
        is_hill.then_some(R::ZERO)
    }

    fn check(&self) -> Result<(), SceneError> {
        let [along_x, along_y] = self.curvatures;
        error::finite("curvature of the bowl along x", along_x, " 1/m")?;
        error::finite("curvature of the bowl along y", along_y, " 1/m")
    }
}

/// Height field of a level ground that becomes a slope along x: `z = slope (x + √(x² + width²))/2`,
/// m.
///
/// On the side of negative x the ground is level to within `slope width²/(4 |x|)`. On the side of
/// positive x it is as near to the plane `z = slope · x`. The largest second
/// derivative, at x = 0, is `slope/(2 width)`, and no curvature is larger.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ramp<R = f64> {
    /// Tangent of the slope angle; below 0 if the ground descends along x.
    pub slope: R,
    /// Half the length of the bend, m, above 0.
    pub width: R,
}

impl<R: Real> HeightField<R> for Ramp<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn elevation(&self, x: R, _y: R) -> Elevation<R> {
        let half = self.slope * R::HALF;
        // The squares of tiny numbers may underflow. The root is therefore limited from below by
        // both numbers.
        let root = (x * x + self.width * self.width)
            .sqrt()
            .at_least(self.width)
            .at_least(x.abs());
        let share = x / root;
        let bend = half * ((R::ONE - share) * (R::ONE + share)) / root;
        let o = R::ZERO;
        Elevation::new(half * (x + root), [half * (R::ONE + share), o]).with_hessian([bend, o, o])
    }

    #[inline]
    fn highest(&self) -> Option<R> {
        (self.slope <= R::ZERO).then_some(R::ZERO)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::finite("slope of the ramp", self.slope, "")?;
        error::above_zero("width of the ramp", self.width, " m")
    }
}

/// Height field of waves along x: `z = amplitude sin(2π x/length)`, m.
///
/// The radius of curvature of crests and troughs is `(length/2π)²/amplitude`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Waves<R = f64> {
    /// Height of a crest above the mean level, m.
    pub amplitude: R,
    /// Wavelength, from crest to crest, m, above 0. The inverse of its square must be finite.
    pub length: R,
}

impl<R: Real> HeightField<R> for Waves<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn elevation(&self, x: R, _y: R) -> Elevation<R> {
        let per_metre = R::from_f64(core::f64::consts::TAU) / self.length;
        let (sin, cos) = (x * per_metre).sin_cos();
        let (height, slope) = (self.amplitude * sin, self.amplitude * per_metre * cos);
        let o = R::ZERO;
        Elevation::new(height, [slope, o]).with_hessian([-(height * per_metre * per_metre), o, o])
    }

    #[inline]
    fn highest(&self) -> Option<R> {
        Some(self.amplitude.abs())
    }

    fn check(&self) -> Result<(), SceneError> {
        error::finite("amplitude of the waves", self.amplitude, " m")?;
        error::above_zero("length of the waves", self.length, " m")?;
        // The curvature is proportional to the inverse of the square.
        let square = self.length * self.length;
        error::finite_inverse("square of the length of the waves", square, " m²")
    }
}
