//! Sine and cosine of single precision without double precision: `libm`'s own go through f64, which
//! a processor with single precision alone has to emulate.
//!
//! Integers reduce the angle, exactly for every f32; then `+ - *` in one order. Both results are
//! within a unit in the last place.

/// The bits of 1/2π, from 2³¹ down.
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

/// Sine and cosine of an angle in radians; NaN where it is not finite.
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

/// Quarter turns, 0 to 3, and what is left over, at most an eighth of a turn to either side, rad;
/// with what rounding has taken from it.
#[allow(clippy::cast_possible_wrap, reason = "above 2⁶³ it is a turn back")]
fn reduce(angle: f32) -> (u64, [f32; 2]) {
    if angle <= core::f32::consts::FRAC_PI_4 {
        return (0, [angle, 0.0]);
    }
    // angle = m 2^e. Of m 2^e/2π the whole turns do not matter, so m is multiplied by 96 bits of
    // 1/2π from 2^(-e-1) on: the error is below 2⁻⁷² turns, and no f32 is nearer than 2⁻³⁶ turns to
    // a quarter.
    let bits = angle.to_bits();
    let m = u64::from(bits & 0x007f_ffff | 0x0080_0000);
    let from = (bits >> 23) + 32 - 150;
    let [high, middle, low] = [0, 32, 64].map(|further| u64::from(window(from + further)));
    let turns = ((m * high) << 32)
        .wrapping_add(m * middle)
        .wrapping_add((m * low) >> 32); // 2⁻⁶⁴ turns
    let quarter = turns.wrapping_add(1 << 61) >> 62;
    let left_over = turns.wrapping_sub(quarter << 62) as i64;
    let rest = radians(left_over.unsigned_abs());
    let side = if left_over < 0 { -1.0 } else { 1.0 };
    (quarter, rest.map(|part| part * side))
}

/// 32 bits of [`TURNS_PER_RADIAN`] from this one on; 0 beyond its end.
#[allow(clippy::cast_possible_truncation, reason = "32 bits are taken")]
fn window(from: u32) -> u32 {
    let word = |further: u32| {
        let index = from / 32 + further;
        u64::from(*TURNS_PER_RADIAN.get(index as usize).unwrap_or(&0))
    };
    let both = word(0) << 32 | word(1);
    (both >> (32 - from % 32)) as u32
}

/// In radians, from 2⁻⁶⁴ turns, at least 1; and what rounding has taken.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "the upper half is taken, and rounded to f32"
)]
fn radians(turns: u64) -> [f32; 2] {
    const TAU: u64 = 0xc90f_daa2; // 2⁻²⁹
    let zeros = turns.leading_zeros();
    let unit = f32::from_bits((127 - 29 - zeros) << 23);
    let upper = (((turns << zeros) >> 32) * TAU) >> 32; // in that unit
    let rounded = upper as u32 as f32;
    let lost = (upper as i64 - rounded as i64) as i32;
    [rounded * unit, lost as f32 * unit]
}

/// Of `x + lost`, by Taylor's series for up to π/4, to terms below 2⁻²⁶ of the sum; of `lost`,
/// which is below a unit in the last place of `x`, by its first term.
fn sin_cos_to_an_eighth(x: f32, lost: f32) -> (f32, f32) {
    let s = x * x;
    let sin = (((1.0 / 362_880.0 * s - 1.0 / 5040.0) * s + 1.0 / 120.0) * s - 1.0 / 6.0) * s;
    let cos = ((-1.0 / 3_628_800.0 * s + 1.0 / 40320.0) * s - 1.0 / 720.0) * s + 1.0 / 24.0;
    // 1 - s/2 is rounded; what that takes is known exactly and put back.
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

    /// How far apart, in units in the last place of the truth.
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
        // A prime step through the bits of all finite numbers meets every exponent some ten
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
        // The f32 nearest to a multiple of π/2 (Kahan's nearpi), and multiples as they come.
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
