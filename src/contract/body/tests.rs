//! The value and the bound that a fault of known size is reported with.

use core::cell::Cell;

use super::*;
use glam::{DMat3, DVec3};

const RADIUS: f64 = 2.0;

/// A body of which each test gives the parts.
struct Given<'a> {
    contacts: &'a [ContactPoint],
    /// Contacts from this call on, if there are others.
    later: Option<(u32, &'a [ContactPoint])>,
    rims: &'a [Rim],
    support: f64,
    below: fn(f64) -> ContactRange,
    /// Support point of a smooth body.
    farthest: Option<fn(DVec3) -> DVec3>,
    calls: Cell<u32>,
}

impl Given<'_> {
    fn none() -> Self {
        Self {
            contacts: &[],
            later: None,
            rims: &[],
            support: RADIUS,
            below: |_| ContactRange::NONE,
            farthest: None,
            calls: Cell::new(0),
        }
    }
}

impl RigidPointBody for Given<'_> {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY
    }
    fn contacts(&self) -> &[ContactPoint] {
        let before = self.calls.replace(self.calls.get() + 1);
        match self.later {
            Some((call, contacts)) if before >= call => contacts,
            _ => self.contacts,
        }
    }
    fn rims(&self) -> &[Rim] {
        self.rims
    }
    fn bounding_radius(&self) -> f64 {
        RADIUS
    }
    fn contacts_below(&self, _: DVec3, offset: f64) -> ContactRange {
        (self.below)(offset)
    }
    fn support(&self, _: DVec3) -> f64 {
        self.support
    }
    fn is_smooth(&self) -> bool {
        self.farthest.is_some()
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        self.farthest.map_or(towards, |farthest| farthest(towards))
    }
}

fn point(x: f64, y: f64, z: f64, radius: f64) -> ContactPoint {
    ContactPoint {
        position: DVec3::new(x, y, z),
        radius,
    }
}

fn assert_found(found: Result<(), Violation>, requirement: Requirement, [value, bound]: [f64; 2]) {
    let violation = found.expect_err("a fault");
    assert_eq!(violation.requirement, requirement);
    for (found, expected) in [(violation.value, value), (violation.bound, bound)] {
        let off = (found - expected).abs();
        assert!(
            off <= 2.0 * f64::EPSILON * expected.abs(),
            "{found:e}, not {expected:e}"
        );
    }
}

/// A length with some units in the last place of the bounding radius.
fn with_rounding(length: f64, units: f64) -> f64 {
    length + RADIUS * (units * f64::EPSILON)
}

#[test]
fn a_contact_beyond_the_bounding_radius_or_the_support_is_told_with_the_rounding() {
    let contacts = [point(0.0, 0.0, 1.5, 0.75)];
    let body = Given {
        contacts: &contacts,
        ..Given::none()
    };
    let bound = with_rounding(RADIUS, 8.0);
    assert_found(check_reach(&body), Requirement::Reach, [2.25, bound]);
    let body = Given {
        support: 2.125,
        ..body
    };
    let bound = with_rounding(2.125, 8.0);
    let found = check_support(&body, DVec3::Z);
    assert_found(found, Requirement::Reach, [2.25, bound]);
    assert_eq!(check_support(&body, -DVec3::Z), Ok(()));
}

#[test]
fn a_rim_beyond_the_bounding_radius_or_the_support_is_told_with_the_rounding() {
    let long = [Rim::new(DVec3::ZERO, DVec3::Z, 3.0, 12)];
    let body = Given {
        rims: &long,
        support: 10.0,
        ..Given::none()
    };
    let found = check_support(&body, DVec3::X);
    assert_found(found, Requirement::Reach, [3.0, with_rounding(RADIUS, 8.0)]);
    let wide = [Rim::new(DVec3::ZERO, DVec3::Z, 1.5, 12)];
    let body = Given {
        rims: &wide,
        support: 1.25,
        ..Given::none()
    };
    let found = check_support(&body, DVec3::X);
    assert_found(found, Requirement::Reach, [1.5, with_rounding(1.25, 8.0)]);
    let body = Given {
        support: 1.5,
        ..body
    };
    assert_eq!(check_support(&body, DVec3::X), Ok(()));
}

#[test]
fn a_support_point_that_is_too_far_or_not_the_farthest_is_told_with_the_rounding() {
    let contacts = [point(0.0, 0.0, 0.0, 1.0)];
    let far = Given {
        contacts: &contacts,
        farthest: Some(|towards| towards * 3.0),
        ..Given::none()
    };
    let plan = CheckPlan::default();
    let found = check_support_point(&far, &mut plan.draw(), 1);
    assert_found(
        found,
        Requirement::Support,
        [3.0, with_rounding(RADIUS, 16.0)],
    );
    // The first direction is that to the lowest corner of the cube, and the point before it is
    // that of z.
    let inside = Given {
        farthest: Some(|towards| {
            if towards == DVec3::Z {
                -DVec3::ONE
            } else {
                towards * 0.5
            }
        }),
        ..far
    };
    let found = check_support_point(&inside, &mut plan.draw(), 1);
    let [height, most] = [3.0_f64.sqrt(), 0.5];
    assert_found(
        found,
        Requirement::Support,
        [height, with_rounding(most, 16.0)],
    );
    let ball = Given {
        farthest: Some(|towards| towards),
        ..inside
    };
    assert_eq!(check_support_point(&ball, &mut plan.draw(), 40), Ok(()));
}

#[test]
fn a_contact_that_is_left_out_is_told_by_the_height_of_its_surface() {
    let contacts = [point(0.0, 0.0, 0.25, 0.5)];
    let body = Given {
        contacts: &contacts,
        ..Given::none()
    };
    let first = Portrait::of(&body);
    let below = |offset| check_below(&body, &first, DVec3::Z, offset);
    assert_found(below(0.5), Requirement::ContactsBelow, [-0.25, 0.5]);
    // Closer to the plane than the rounding of its terms it may be in the range or not.
    let rounding = (0.25 + RADIUS) * (8.0 * f64::EPSILON);
    assert_eq!(below(-0.25 + 0.9 * rounding), Ok(()));
    let found = below(-0.25 + 1.1 * rounding).expect_err("a contact is left out");
    assert_eq!(found.requirement, Requirement::ContactsBelow);
}

#[test]
fn a_contact_that_moves_is_told_as_a_body_that_changes() {
    let [before, after] = [[point(0.0, 0.0, 1.0, 0.0)], [point(0.0, 0.0, -1.0, 0.0)]];
    let body = Given {
        contacts: &before,
        ..Given::none()
    };
    let first = Portrait::of(&body);
    let body = Given {
        later: Some((0, &after)),
        ..body
    };
    let found = check_below(&body, &first, DVec3::Z, 0.0).expect_err("a change");
    assert_eq!(found.requirement, Requirement::Rigid);
    // In no range, and below no plane.
    assert_eq!(check_below(&body, &first, DVec3::Z, -2.0), Ok(()));
}

/// A body whose mass is a function of the number of calls, with the inertia of that mass.
struct Weighs(fn(u32) -> f64, Cell<u32>, [ContactPoint; 1]);

impl RigidPointBody for Weighs {
    fn mass(&self) -> f64 {
        (self.0)(self.1.replace(self.1.get() + 1))
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY * self.mass()
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.2
    }
}

#[test]
fn a_mass_that_changes_from_call_to_call_is_told() {
    let check = |mass| {
        let body = Weighs(mass, Cell::new(0), [point(0.0, 0.0, 0.0, 1.0)]);
        check_body(&body, CheckPlan::default())
    };
    assert_eq!(check(|_| 1.0), Ok(()));
    // One that changes at each call, at every third, at the second, and late.
    let masses: [fn(u32) -> f64; 4] = [
        |call| 1.0 + f64::from(call % 2),
        |call| 1.0 + f64::from(u8::from(call % 3 == 0)),
        |call| 1.0 + f64::from(u8::from(call > 0)),
        |call| 1.0 + f64::from(u8::from(call > 100)),
    ];
    for mass in masses {
        let found = check(mass).expect_err("a change");
        assert_eq!(found.requirement, Requirement::Rigid, "{found}");
        assert!((found.value - found.bound).abs() >= 1.0, "{found}");
    }
}

#[test]
fn the_hash_of_contacts_follows_each_bit_of_each_number() {
    let contacts = [point(1.0, 0.0, -3.0, 0.5), point(0.0, 0.25, 7.0, 0.0)];
    let hash = hash_of(&contacts);
    for index in 0..2 {
        for bit in [0, 1, 17, 40, 52, 60, 63] {
            let flipped = |number: f64| f64::from_bits(number.to_bits() ^ (1 << bit));
            let changes: [fn(&mut ContactPoint, &dyn Fn(f64) -> f64); 4] = [
                |contact, flip| contact.position.x = flip(contact.position.x),
                |contact, flip| contact.position.y = flip(contact.position.y),
                |contact, flip| contact.position.z = flip(contact.position.z),
                |contact, flip| contact.radius = flip(contact.radius),
            ];
            for change in changes {
                let mut other = contacts;
                change(&mut other[index], &flipped);
                assert_ne!(hash_of(&other), hash, "bit {bit} of contact {index}");
            }
        }
    }
    assert_ne!(hash_of(&[contacts[1], contacts[0]]), hash);
    assert_eq!(hash_of(&contacts.clone()), hash);
}

#[test]
fn ranges_of_no_contact_are_the_same_wherever_they_begin_and_others_are_not() {
    let contacts = [point(0.0, 0.0, 1.0, 0.0); 3];
    let range = |first, count| ContactRange { first, count };
    let near = |asked: ContactRange, found: fn(f64) -> ContactRange| {
        let body = Given {
            contacts: &contacts,
            below: found,
            ..Given::none()
        };
        let below = Below {
            normal: DVec3::Z,
            offset: 0.0,
            range: asked,
        };
        check_near(&body, &below, ContactRange::NONE, found(0.0))
    };
    let none: fn(f64) -> ContactRange = |_| ContactRange { first: 2, count: 0 };
    let two: fn(f64) -> ContactRange = |_| ContactRange { first: 0, count: 2 };
    assert_eq!(near(range(1, 0), none), Ok(()));
    assert_eq!(near(range(0, 2), two), Ok(()));
    let requirement = Requirement::ContactsBelow;
    assert_found(near(range(0, 2), none), requirement, [0.0, 2.0]);
    assert_found(near(range(0, 0), two), requirement, [2.0, 0.0]);
    assert_found(near(range(1, 2), two), requirement, [2.0, 2.0]);
}

#[test]
fn the_known_ranges_end_next_to_the_ends_of_the_range() {
    let range = |first, count| ContactRange { first, count };
    let expected = [
        range(3, 4),
        range(3, 5),
        range(2, 4),
        range(4, 3),
        ContactRange::NONE,
        range(0, 9),
    ];
    assert_eq!(known_ranges(range(3, 4), 9), expected);
}

/// A ball whose results are functions of the number of calls of that method.
struct Fickle {
    is_symmetric: fn(u32) -> bool,
    is_smooth: fn(u32) -> bool,
    /// Addition to the support, m.
    support: fn(u32) -> f64,
    /// Factor of the support point.
    point: fn(u32) -> f64,
    ends: fn(u32) -> Option<[DVec3; 4]>,
    calls: [Cell<u32>; 5],
    contacts: [ContactPoint; 1],
}

impl Fickle {
    fn steady() -> Self {
        Self {
            is_symmetric: |_| false,
            is_smooth: |_| false,
            support: |_| 0.0,
            point: |_| 1.0,
            ends: |_| None,
            calls: Default::default(),
            contacts: [point(0.0, 0.0, 0.0, 1.0)],
        }
    }

    fn before(&self, method: usize) -> u32 {
        self.calls[method].replace(self.calls[method].get() + 1)
    }
}

impl RigidPointBody for Fickle {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
    fn bounding_radius(&self) -> f64 {
        1.0
    }
    fn contacts_below(&self, _: DVec3, _: f64) -> ContactRange {
        ContactRange::all(1)
    }
    fn is_symmetric(&self) -> bool {
        (self.is_symmetric)(self.before(0))
    }
    fn is_smooth(&self) -> bool {
        (self.is_smooth)(self.before(1))
    }
    fn support(&self, _: DVec3) -> f64 {
        1.0 + (self.support)(self.before(2))
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        towards * (self.point)(self.before(3))
    }
    fn range_ends(&self, _: ContactRange) -> Option<[DVec3; 4]> {
        (self.ends)(self.before(4))
    }
}

fn told(body: &Fickle) -> Result<(), Requirement> {
    check_body(body, CheckPlan::default()).map_err(|violation| violation.requirement)
}

const CHANGED: Result<(), Requirement> = Err(Requirement::Rigid);

/// Each value changes at every call, at every third, or late. So do those of the next tests.
#[test]
fn flags_that_change_from_call_to_call_are_told() {
    assert_eq!(told(&Fickle::steady()), Ok(()));
    let flags: [fn(u32) -> bool; 3] = [
        |call| call % 2 == 0,
        |call| call % 3 == 0,
        |call| call > 500,
    ];
    for flag in flags {
        let body = Fickle {
            is_symmetric: flag,
            ..Fickle::steady()
        };
        assert_eq!(told(&body), CHANGED);
        let body = Fickle {
            is_smooth: flag,
            ..Fickle::steady()
        };
        assert_eq!(told(&body), CHANGED);
    }
}

#[test]
fn supports_that_change_from_call_to_call_are_told() {
    // Greater than it must be, which a support function may be.
    let supports: [fn(u32) -> f64; 3] = [
        |call| f64::from(call % 2),
        |call| f64::from(u8::from(call % 3 == 0)),
        |call| f64::from(u8::from(call > 100)),
    ];
    for support in supports {
        let body = Fickle {
            support,
            ..Fickle::steady()
        };
        assert_eq!(told(&body), CHANGED);
    }
    let smooth = || Fickle {
        is_smooth: |_| true,
        ..Fickle::steady()
    };
    assert_eq!(told(&smooth()), Ok(()));
    // So little that it is the farthest point still, to the rounding that is allowed.
    let points: [fn(u32) -> f64; 3] = [
        |call| 1.0 - f64::EPSILON * f64::from(call % 2),
        |call| 1.0 - f64::EPSILON * f64::from(u8::from(call % 3 == 0)),
        |call| 1.0 - f64::EPSILON * f64::from(u8::from(call > 500)),
    ];
    for point in points {
        let body = Fickle { point, ..smooth() };
        assert_eq!(told(&body), CHANGED);
    }
}

#[test]
fn ends_of_ranges_that_change_from_call_to_call_are_told() {
    // Positions that belong to no plane, so that no contact is omitted.
    let ends: [fn(u32) -> Option<[DVec3; 4]>; 2] = [
        |call| Some([DVec3::Z * f64::from(call % 2); 4]),
        |call| (call % 3 == 0).then_some([DVec3::Z; 4]),
    ];
    for ends in ends {
        let body = Fickle {
            ends,
            ..Fickle::steady()
        };
        assert_eq!(told(&body), CHANGED);
    }
    // Positions that are not finite may be the same at every call, too.
    let body = Fickle {
        ends: |_| Some([DVec3::NAN; 4]),
        ..Fickle::steady()
    };
    assert_eq!(told(&body), Ok(()));
}

/// No random input: the fixed ones alone must show a fault in one direction of a cube.
#[test]
fn a_plan_without_cases_tries_all_directions_of_a_cube() {
    let none = CheckPlan { seed: 0, cases: 0 };
    let contacts = [point(0.0, 0.0, -1.5, 0.0)];
    let body = Given {
        contacts: &contacts,
        below: |_| ContactRange::all(1),
        ..Given::none()
    };
    assert_eq!(check_body(&body, none), Ok(()));
    let low = Given {
        support: 1.25,
        ..body
    };
    let bound = with_rounding(1.25, 8.0);
    assert_found(check_body(&low, none), Requirement::Reach, [1.5, bound]);

    let middle = [point(0.0, 0.0, 0.0, 0.0)];
    let ball = Given {
        contacts: &middle,
        farthest: Some(|towards| towards * RADIUS),
        ..Given::none()
    };
    let check = |body| check_support_point(body, &mut none.draw(), none.cases);
    assert_eq!(check(&ball), Ok(()));
    // Half as far in the last of these directions, that of the corner (1, 1, 1).
    let dented = Given {
        farthest: Some(|towards| {
            let is_corner = towards.min_element() > 0.57735;
            towards * if is_corner { 1.0 } else { RADIUS }
        }),
        contacts: &middle,
        ..Given::none()
    };
    let found = check(&dented).expect_err("a fault");
    assert_eq!(found.requirement, Requirement::Support);
    let towards = DVec3::ONE.normalize();
    assert!(
        matches!(found.input, Input::Below { normal, .. } if (normal - towards).length() < 1e-15),
        "{found}"
    );
}
