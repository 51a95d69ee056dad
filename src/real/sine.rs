//! Sine and cosine of single precision, computed without double precision.
//!
//! The functions of `libm` use f64, which a processor with single precision only has to emulate.
//! Here integer arithmetic reduces the angle exactly, for every f32. The series then uses `+ - *`
//! in one fixed order. Both results are accurate to one unit in the last place.

/// Bits of `1/(2π)`, from 2³¹ down.
const TURNS_PER_RADIAN: [u32; 8] = [
    0,
    0x28be_60db,
    0x9391_054a,
    0x7f09_d5f4,
    0x7d4d_3770,
    0x36d8_a566,
    0x4f10_e410,
    0x7f94_58ea,
];

/// Sine and cosine of an angle in radians. NaN if the angle is not finite.
pub(super) fn sin_cos(angle: f32) -> (f32, f32) {
    if !angle.is_finite() {
        return (f32::NAN, f32::NAN);
    }
    let (quarter, [rest, lost]) = reduce(angle.abs());
    let (sin, cos) = sin_cos_to_an_eighth(rest, lost);
    let (sin, cos) = match quarter {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    (if angle < 0.0 { -sin } else { sin }, cos)
}

/// Number of quarter revolutions, 0 to 3, and the remaining angle, rad.
///
/// The remaining angle is at most an eighth of a revolution, of either sign. Its second element is
/// the rounding error of the first.
#[allow(
    clippy::cast_possible_wrap,
    reason = "a value above 2⁶³ stands for a negative angle"
)]
fn reduce(angle: f32) -> (u64, [f32; 2]) {
    if angle <= core::f32::consts::FRAC_PI_4 {
        return (0, [angle, 0.0]);
    }
    // angle = m 2^e. Whole revolutions in m 2^e/(2π) have no effect. So m is multiplied by 96 bits
    // of 1/(2π), from 2^(-e-1) on. The error is below 2⁻⁷² revolutions, and no f32 is closer than
    // 2⁻³⁶ revolutions to a multiple of a quarter.
    let bits = angle.to_bits();
    let m = u64::from(bits & 0x007f_ffff | 0x0080_0000);
    let from = (bits >> 23) + 32 - 150;
    let [high, middle, low] = [0, 32, 64].map(|further| u64::from(window(from + further)));
    let turns = ((m * high) << 32)
        .wrapping_add(m * middle)
        .wrapping_add((m * low) >> 32); // in 2⁻⁶⁴ revolutions
    let quarter = turns.wrapping_add(1 << 61) >> 62;
    let left_over = turns.wrapping_sub(quarter << 62) as i64;
    let rest = radians(left_over.unsigned_abs());
    let side = if left_over < 0 { -1.0 } else { 1.0 };
    (quarter, rest.map(|part| part * side))
}

/// 32 bits of [`TURNS_PER_RADIAN`] that begin at bit `from`. Bits beyond its end are 0.
#[allow(
    clippy::cast_possible_truncation,
    reason = "the lower 32 bits are needed"
)]
fn window(from: u32) -> u32 {
    let word = |further: u32| {
        let index = from / 32 + further;
        u64::from(*TURNS_PER_RADIAN.get(index as usize).unwrap_or(&0))
    };
    let both = word(0) << 32 | word(1);
    (both >> (32 - from % 32)) as u32
}

/// Angle in radians for a number of 2⁻⁶⁴ revolutions, at least 1, and the rounding error of that
/// angle.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "the upper half is used, and rounded to f32"
)]
fn radians(turns: u64) -> [f32; 2] {
    const TAU: u64 = 0xc90f_daa2; // 2π in units of 2⁻²⁹
    let zeros = turns.leading_zeros();
    let unit = f32::from_bits((127 - 29 - zeros) << 23);
    let upper = (((turns << zeros) >> 32) * TAU) >> 32; // in units of `unit`
    let rounded = upper as u32 as f32;
    let lost = (upper as i64 - rounded as i64) as i32;
    [rounded * unit, lost as f32 * unit]
}

/// Sine and cosine of `x + lost` by Taylor's series, for angles up to π/4.
///
/// The first omitted term is below 2⁻²⁶ of the sum. `lost` is below one unit in the last place of
/// `x`, so its first term is sufficient.
fn sin_cos_to_an_eighth(x: f32, lost: f32) -> (f32, f32) {
    let s = x * x;
    let sin = (((1.0 / 362_880.0 * s - 1.0 / 5040.0) * s + 1.0 / 120.0) * s - 1.0 / 6.0) * s;
    let cos = ((-1.0 / 3_628_800.0 * s + 1.0 / 40320.0) * s - 1.0 / 720.0) * s + 1.0 / 24.0;
    // 1 - s/2 is rounded. Its rounding error is known exactly and added again.
    let half = s * 0.5;
    let near = 1.0 - half;
    (
        x + (x * sin + lost),
        near + ((1.0 - near - half) + (s * s * cos - x * lost)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Difference of two numbers in units in the last place of the second, which is exact.
    fn units_apart(ours: f32, truth: f64) -> f64 {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "the unit is that of the nearest f32"
        )]
        let nearest = (truth as f32).abs();
        let next = f32::from_bits(nearest.to_bits() + 1);
        let unit = f64::from(next) - f64::from(nearest);
        (f64::from(ours) - truth).abs() / unit
    }

    #[test]
    fn sine_and_cosine_are_within_a_unit_in_the_last_place_at_all_sizes() {
        // A prime step through the bits of all finite numbers visits every exponent about ten
        // thousand times.
        let mut worst: f64 = 0.0;
        for bits in (0..0x7f80_0000).step_by(9973) {
            let angle = f32::from_bits(bits);
            let (sin, cos) = sin_cos(angle);
            let (true_sin, true_cos) = libm::sincos(f64::from(angle));
            worst = worst.max(units_apart(sin, true_sin));
            worst = worst.max(units_apart(cos, true_cos));
            assert!(worst < 1.0, "{angle:e}: {sin} {true_sin}, {cos} {true_cos}");
            assert_eq!(sin_cos(-angle), (-sin, cos));
        }
    }

    #[test]
    fn next_to_a_quarter_turn_no_digit_is_lost() {
        // The f32 nearest to a multiple of π/2 (Kahan's nearpi), and ordinary multiples.
        for angle in [
            16_367_173.0 * 2.0_f32.powi(72),
            f32::MAX,
            core::f32::consts::PI,
            core::f32::consts::FRAC_PI_2,
            12.566_371,
        ] {
            let (sin, cos) = sin_cos(angle);
            let (true_sin, true_cos) = libm::sincos(f64::from(angle));
            assert!(
                units_apart(sin, true_sin) < 1.0,
                "{angle}: {sin} {true_sin}"
            );
            assert!(
                units_apart(cos, true_cos) < 1.0,
                "{angle}: {cos} {true_cos}"
            );
        }
    }

    #[test]
    fn what_is_not_finite_has_no_sine() {
        for angle in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sin, cos) = sin_cos(angle);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
