//! What holds where one stage of `contact` passes values to the next; asserted in builds with debug
//! assertions, and absent from others.
//!
//! Only the arithmetic of this module is asserted. A law is the user's, and a law that breaks its
//! contract is an error of the step, not a panic. So each condition also holds for a normal that is
//! no unit vector, for numbers that have overflowed, and for NaN.

use super::load::Load;
use super::point::Contact;
use crate::real::{Real, Vector};

/// Units in the last place by which the slip may leave the surface. The slip is `v - n (v·n)`, and
/// its component along the normal is `(v·n)(1 - n²)`, with `n²` within 128 units of 1, and a few
/// roundings of `v`.
const SLIP: f64 = 160.0;
/// Units in the last place by which the square of a unit vector's length may differ from 1.
const UNIT: f64 = 128.0;

/// A contact is below the surface, represents a part of the body, and slips along the surface.
pub(super) fn touches<R: Real>(contact: &Contact<R>, surfaces: usize) -> bool {
    let is_invalid = contact.weight < R::ZERO || contact.surface >= surfaces;
    contact.depth > R::ZERO
        && !is_invalid
        && slips_along(contact.slip_velocity, contact.normal, contact.closing_speed)
}

/// A slip is perpendicular to the normal of the surface, up to rounding of the velocity, whose
/// component along the normal is the `rising` speed.
pub(super) fn slips_along<R: Real>(slip: R::Vec3, normal: R::Vec3, rising: R) -> bool {
    let is_unit = (normal.length_squared() - R::ONE).abs() <= R::EPSILON * R::from_f64(UNIT);
    let speed = slip.x().abs() + slip.y().abs() + slip.z().abs() + rising.abs();
    // Products below the smallest normal number lose their digits.
    let rounding = speed * R::EPSILON * R::from_f64(SLIP) + R::ZERO.power_of_two();
    let leaves = slip.dot(normal).abs() > rounding;
    !(is_unit && speed.is_finite() && leaves)
}

/// No contact is counted twice, and a load without a contact is exactly zero.
pub(super) fn is_sum_of<R: Real>(load: &Load<R>, contacts: usize) -> bool {
    load.touching <= contacts && (load.touching > 0 || *load == Load::default())
}

/// Numbers are in ascending order; NaN has any place.
pub(super) fn ascend<R: Real>(mut numbers: impl Iterator<Item = R>) -> bool {
    let Some(mut last) = numbers.next() else {
        return true;
    };
    numbers.all(|next| {
        let falls = next < last;
        last = next;
        !falls
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ContactPoint;
    use glam::DVec3;

    const TILTED: DVec3 = DVec3::new(0.0, 0.6, 0.8);

    fn contact() -> Contact {
        Contact {
            point: ContactPoint::bare(DVec3::ZERO),
            surface: 1,
            position: DVec3::ZERO,
            arm: DVec3::ZERO,
            normal: TILTED,
            depth: 1e-3,
            closing_speed: 0.2,
            slip_velocity: DVec3::new(0.5, 0.4, -0.3),
            weight: 1.0,
        }
    }

    #[test]
    fn a_contact_that_is_not_below_the_surface_does_not_touch() {
        assert!(touches(&contact(), 2));
        let broken: [fn(&mut Contact); 5] = [
            |contact| contact.depth = 0.0,
            |contact| contact.depth = f64::NAN,
            |contact| contact.weight = -0.1,
            |contact| contact.surface = 2,
            |contact| contact.slip_velocity.z += 1e-12,
        ];
        for change in broken {
            let mut contact = contact();
            change(&mut contact);
            assert!(!touches(&contact, 2), "{contact:?}");
        }
    }

    #[test]
    fn what_a_law_or_an_overflow_has_spoilt_is_not_asserted() {
        let upward = DVec3::new(0.0, 0.0, 1.0);
        assert!(!slips_along(upward, upward, 0.0));
        assert!(slips_along(upward, upward * 2.0, 0.0));
        assert!(slips_along(upward, DVec3::NAN, 0.0));
        assert!(slips_along(DVec3::INFINITY, upward, 0.0));
        assert!(slips_along(upward * 1e-310, upward, 0.0));
        // Rounding of a fast approach.
        assert!(slips_along(upward * 1e-14, upward, 1.0));
    }

    #[test]
    fn a_load_has_the_contacts_that_were_added() {
        let mut load = Load::<f64>::default();
        assert!(is_sum_of(&load, 0));
        load.torque.x = 1e-300;
        assert!(!is_sum_of(&load, 1));
        load.touching = 1;
        assert!(is_sum_of(&load, 1) && !is_sum_of(&load, 0));
    }

    #[test]
    fn places_along_an_arc_are_in_order() {
        assert!(ascend([-1.0, 0.5, 0.5, f64::NAN].into_iter()));
        assert!(ascend(core::iter::empty::<f64>()));
        assert!(!ascend([0.5, 0.4].into_iter()));
    }
}
