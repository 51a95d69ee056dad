//! Requirements of a body.

use super::plan::{CheckPlan, Draw, cube_directions, unit};
use super::{
    Input, Requirement, Violation, cannot_be, demand, demand_at_least, demand_at_most,
    demand_finite, ulps, wide,
};
use crate::body::{
    ContactPoint, ContactRange, MOST_RIMS, RigidPointBody, Rim, check_contacts, check_rims,
    inertia_of,
};
use crate::error::{Rule, SceneError};
use crate::real::{Matrix, Real, Vector};

/// Checks a body.
///
/// The requirements are:
///
/// - The mass is above 0. The inertia is symmetric and that of a solid. A body that
///   [is symmetric](crate::RigidPointBody::is_symmetric) has two equal moments.
/// - Contacts are finite, with radii of at least 0.
/// - Neither contacts nor rims lie beyond the bounding radius, nor beyond `support` in any
///   direction.
/// - `contacts_below` omits no contact, and `contacts_below_near` returns the same range. A known
///   range with the right [`range_ends`](crate::RigidPointBody::range_ends) omits none either.
/// - `support_point` of a smooth body is the farthest point in its direction.
/// - All results are the same at every call with the same arguments.
///
/// The planes of `contacts_below` have directions to a cube's faces, edges and corners, to
/// contacts, and random ones. Their offsets are at contacts, at the bounding radius, and far away.
///
/// A contact may be inside or outside of the range if it is closer to the plane than 8 units in the
/// last place of the bounding radius.
///
/// ```
/// use tumble::contract::{CheckPlan, check_body};
/// check_body(&tumble::Coin::ring(1.0, 0.5), CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// Returns the first [`Violation`], with the requirement that is broken and the input that breaks
/// it.
pub fn check_body<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    plan: CheckPlan,
) -> Result<(), Violation> {
    body.check().map_err(cannot_be)?;
    let first = Portrait::of(body);
    check_contacts(body.contacts()).map_err(cannot_be)?;
    check_rims(body).map_err(cannot_be)?;
    inertia_of(body).map_err(|error| cannot_have(body, error))?;
    check_reach(body)?;

    first.check(body)?;
    check_support_point(body, &mut plan.draw(), plan.cases)?;
    for normal in cube_directions::<R>() {
        check_support(body, normal)?;
        check_offsets(body, &first, normal)?;
    }
    let mut draw = plan.draw();
    for _ in 0..plan.cases {
        let direction = any_direction(body, &mut draw);
        check_support(body, direction)?;
        check_offsets(body, &first, direction)?;
        let offset = body.bounding_radius() * draw.either() * R::from_f64(1.1);
        check_below(body, &first, draw.direction::<R>(), offset)?;
        first.check(body)?;
    }
    Ok(())
}

/// Violation for an invalid mass or inertia. A moment's bound is the sum of the other two: the
/// trace minus that moment.
fn cannot_have<R: Real, B: RigidPointBody<R> + ?Sized>(body: &B, error: SceneError) -> Violation {
    let violation = cannot_be(error);
    if error.rule != Rule::TriangleInequality {
        return violation;
    }
    Violation {
        bound: trace::<R>(body.inertia()).to_f64() - error.value,
        ..violation
    }
}

fn check_reach<R: Real, B: RigidPointBody<R> + ?Sized>(body: &B) -> Result<(), Violation> {
    let bounding_radius = body.bounding_radius();
    demand_finite(bounding_radius, || Input::AsItIs)?;
    demand_at_least(bounding_radius, R::ZERO, Requirement::Reach, || {
        Input::AsItIs
    })?;
    for (index, contact) in body.contacts().iter().enumerate() {
        let place = contact.position.length() + contact.radius;
        let bound = bounding_radius + bounding_radius * ulps(8.0);
        demand_at_most(place, bound, Requirement::Reach, || Input::Contact {
            index,
        })?;
    }
    Ok(())
}

/// Checks that no contact, and no point of a smooth surface, is farther in a direction than the
/// body's support function.
fn check_support<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    direction: R::Vec3,
) -> Result<(), Violation> {
    let support = body.support(direction);
    demand_finite(support, || Input::AsItIs)?;
    let again = body.support(direction);
    demand(again == support, Requirement::Rigid, again, support, || {
        Input::AsItIs
    })?;
    let bound = support + body.bounding_radius() * ulps(8.0);
    for rim in body.rims() {
        let place = rim.support_point(direction);
        let most = body.bounding_radius() + body.bounding_radius() * ulps(8.0);
        demand_at_most(place.length(), most, Requirement::Reach, || Input::AsItIs)?;
        let height = direction.dot(place);
        demand_at_most(height, bound, Requirement::Reach, || Input::AsItIs)?;
    }
    if body.is_smooth() {
        // The two may be computed by different formulas.
        let bound = support + body.bounding_radius() * ulps(256.0);
        let height = direction.dot(body.support_point(direction));
        demand_at_most(height, bound, Requirement::Reach, || Input::AsItIs)?;
    }
    for (index, contact) in body.contacts().iter().enumerate() {
        let place = direction.dot(contact.position) + contact.radius;
        demand_at_most(place, bound, Requirement::Reach, || Input::Contact {
            index,
        })?;
    }
    Ok(())
}

/// Checks that a smooth body has one contact, and that its support point is the farthest of the
/// returned points in each direction.
fn check_support_point<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    draw: &mut Draw,
    cases: u32,
) -> Result<(), Violation> {
    if !body.is_smooth() {
        return Ok(());
    }
    let count = R::from_usize(body.contacts().len());
    let alone = body.contacts().len() == 1;
    demand(alone, Requirement::Support, count, R::ONE, || Input::AsItIs)?;
    let bounding_radius = body.bounding_radius();
    let rounding = bounding_radius * ulps(16.0);
    let mut other = R::Vec3::new(R::ZERO, R::ZERO, R::ONE);
    let random = (0..cases).map(|_| None);
    for fixed in cube_directions::<R>().map(Some).chain(random) {
        let towards = fixed.unwrap_or_else(|| draw.direction::<R>());
        let place = body.support_point(towards);
        let input = || Input::Below {
            normal: wide::<R>(towards),
            offset: towards.dot(place).to_f64(),
            index: 0,
        };
        demand_finite(place.length(), input)?;
        let off = (body.support_point(towards) - place).length();
        demand_at_most(off, R::ZERO, Requirement::Rigid, input)?;
        demand_at_most(
            place.length(),
            bounding_radius + rounding,
            Requirement::Support,
            input,
        )?;
        // A place that is a little off is farther only in directions close by.
        let aside = draw.direction::<R>();
        let near = [0.3, 0.03, 3e-3].map(|share| unit::<R>(towards + aside * R::from_f64(share)));
        let elsewhere = [other, -towards, aside].into_iter().chain(near);
        for elsewhere in elsewhere {
            let height = towards.dot(body.support_point(elsewhere));
            let most = towards.dot(place) + rounding;
            demand_at_most(height, most, Requirement::Support, input)?;
        }
        other = towards;
    }
    Ok(())
}

/// Random direction, or the direction of a contact or its opposite.
fn any_direction<R: Real, B: RigidPointBody<R> + ?Sized>(body: &B, draw: &mut Draw) -> R::Vec3 {
    let count = u32::try_from(body.contacts().len()).unwrap_or(u32::MAX);
    let index = draw.pick(count) as usize;
    let random = draw.direction::<R>();
    match (draw.pick(3), body.contacts().get(index)) {
        (0, Some(contact)) => unit::<R>(contact.position),
        (1, Some(contact)) => unit::<R>(-contact.position),
        _ => random,
    }
}

/// Checks the contacts below planes of one direction, at the relevant offsets.
fn check_offsets<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    first: &Portrait<R>,
    normal: R::Vec3,
) -> Result<(), Violation> {
    let bounding_radius = body.bounding_radius();
    for share in [0.0, 1e-9, 0.3, 0.9, 0.999, 1.0, 1.001, 1e3] {
        check_below(body, first, normal, bounding_radius * R::from_f64(share))?;
        check_below(body, first, normal, -(bounding_radius * R::from_f64(share)))?;
    }
    // Just above some contacts: the lowest of them and its neighbours.
    let contacts = body.contacts();
    let every = (contacts.len() / 7).max(1);
    for contact in contacts.iter().step_by(every) {
        let height = normal.dot(contact.position) - contact.radius;
        check_below(body, first, normal, height + bounding_radius * ulps(16.0))?;
    }
    Ok(())
}

/// Plane below which contacts are asked for, and the range that the body returned.
struct Below<R: Real> {
    normal: R::Vec3,
    offset: R,
    range: ContactRange,
}

impl<R: Real> Below<R> {
    fn input(&self, index: usize) -> Input {
        Input::Below {
            normal: wide::<R>(self.normal),
            offset: self.offset.to_f64(),
            index,
        }
    }
}

/// Checks the contacts below one plane, also from known ranges of similar and of other planes. No
/// contact may be omitted, and all results must be equal.
fn check_below<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    first: &Portrait<R>,
    normal: R::Vec3,
    offset: R,
) -> Result<(), Violation> {
    let below = Below {
        normal,
        offset,
        range: body.contacts_below(normal, offset),
    };
    let again = body.contacts_below(normal, offset);
    let is_same = below.range == again;
    demand(is_same, Requirement::Rigid, R::ONE, R::ZERO, || {
        below.input(again.first)
    })?;
    let known = known_ranges(below.range, body.contacts().len());
    check_ends(body, &below, &known)?;
    let near = known.map(|known| body.contacts_below_near(normal, offset, known));
    check_none_is_omitted(body, first, &below, &known, &near)?;
    known
        .into_iter()
        .zip(near)
        .try_for_each(|(known, near)| check_near(body, &below, known, near))
}

/// Checks that the ends of each known range are the same at two calls.
fn check_ends<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    below: &Below<R>,
    known: &[ContactRange],
) -> Result<(), Violation> {
    for range in known {
        let [ends, again] = [(); 2].map(|()| hash_of_ends::<R>(body.range_ends(*range)));
        demand(ends == again, Requirement::Rigid, R::ONE, R::ZERO, || {
            below.input(range.first)
        })?;
    }
    Ok(())
}

/// Checks that each contact below the plane is in the body's range, in those found `near` known
/// ones, and in the known ones whose ends say that they belong to this plane.
fn check_none_is_omitted<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    first: &Portrait<R>,
    below: &Below<R>,
    known: &[ContactRange],
    near: &[ContactRange],
) -> Result<(), Violation> {
    let contacts = body.contacts();
    let (normal, offset) = (below.normal, below.offset);
    let belongs_to_plane = |known: &&ContactRange| {
        let is_below = |end: R::Vec3| normal.dot(end) < offset;
        let ends = body.range_ends(**known).map(|ends| ends.map(is_below));
        ends == Some([false, true, true, false])
    };
    let all = [&below.range]
        .into_iter()
        .chain(near)
        .chain(known.iter().filter(belongs_to_plane));
    let sure = offset - (offset.abs() + body.bounding_radius()) * ulps(8.0);
    for (index, contact) in contacts.iter().enumerate() {
        let height = normal.dot(contact.position) - contact.radius;
        let mut all = all.clone();
        let found = height >= sure || all.all(|range| holds(*range, contacts, index));
        if !found {
            // Either the range was wrong, or the contacts have changed meanwhile.
            first.check(body)?;
        }
        demand(found, Requirement::ContactsBelow, height, offset, || {
            below.input(index)
        })?;
    }
    Ok(())
}

/// Checks that the range found `near` a known one is the range of the plane.
fn check_near<R: Real, B: RigidPointBody<R> + ?Sized>(
    body: &B,
    below: &Below<R>,
    known: ContactRange,
    near: ContactRange,
) -> Result<(), Violation> {
    if near == below.range || (near.count == 0 && below.range.count == 0) {
        return Ok(());
    }
    // Either the result depends on the known range, or it changes between calls.
    let again = body.contacts_below_near(below.normal, below.offset, known);
    let (requirement, value) = if near == again {
        (Requirement::ContactsBelow, near)
    } else {
        (Requirement::Rigid, again)
    };
    let contacts = body.contacts().len();
    let [count, asked] = [value, below.range].map(|range| R::from_usize(range.count.min(contacts)));
    demand(false, requirement, count, asked, || below.input(near.first))
}

/// Known ranges that a caller may pass: the range itself, ranges that end next to its ends, the
/// empty range, and all contacts.
fn known_ranges(range: ContactRange, contacts: usize) -> [ContactRange; 6] {
    let ContactRange { first, count } = range;
    [
        range,
        ContactRange {
            count: count.saturating_add(1),
            ..range
        },
        ContactRange {
            first: first.saturating_sub(1),
            ..range
        },
        ContactRange {
            first: first.saturating_add(1),
            count: count.saturating_sub(1),
        },
        ContactRange::NONE,
        ContactRange::all(contacts),
    ]
}

/// Returns true if a range contains a contact, according to its parts.
fn holds<T>(range: ContactRange, contacts: &[T], index: usize) -> bool {
    let [head, wrapped] = range.parts(contacts);
    index < wrapped.len() || (index >= range.first && index - range.first < head.len())
}

/// Summary of a body in a few numbers that change if the body changes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Portrait<R: Real> {
    mass: R,
    inertia: R::Mat3,
    bounding_radius: R,
    count: usize,
    contacts: u64,
    rims: [Option<Rim<R>>; MOST_RIMS],
    flags: Flags,
    /// Hash of the support in one direction. A drift shows that two calls in a row do not show.
    support: u64,
}

/// Properties of a body that are true or false.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Flags {
    is_symmetric: bool,
    is_smooth: bool,
}

impl Flags {
    fn of<R: Real, B: RigidPointBody<R> + ?Sized>(body: &B) -> Self {
        Self {
            is_symmetric: body.is_symmetric(),
            is_smooth: body.is_smooth(),
        }
    }
}

impl<R: Real> Portrait<R> {
    fn of<B: RigidPointBody<R> + ?Sized>(body: &B) -> Self {
        Self {
            mass: body.mass(),
            inertia: body.inertia(),
            bounding_radius: body.bounding_radius(),
            count: body.contacts().len(),
            contacts: hash_of(body.contacts()),
            rims: core::array::from_fn(|number| body.rims().get(number).copied()),
            flags: Flags::of(body),
            support: hash_of_support(body),
        }
    }

    /// Checks that the body is as before.
    fn check<B: RigidPointBody<R> + ?Sized>(&self, body: &B) -> Result<(), Violation> {
        let demand_same = |same: bool, [value, bound]: [R; 2]| {
            demand(same, Requirement::Rigid, value, bound, || Input::AsItIs)
        };
        // Three calls in a row: a mass that alternates may be the same at every other call.
        for mass in [(); 3].map(|()| body.mass()) {
            demand_same(mass == self.mass, [mass, self.mass])?;
        }
        for flags in [(); 3].map(|()| Flags::of(body)) {
            demand_same(flags == self.flags, [R::ONE, R::ZERO])?;
        }
        let other = Self::of(body);
        demand_same(other.mass == self.mass, [other.mass, self.mass])?;
        let traces = [&other, self].map(|portrait| trace::<R>(portrait.inertia));
        demand_same(other.inertia == self.inertia, traces)?;
        demand_same(other.support == self.support, [R::ONE, R::ZERO])?;
        demand_same(
            other == *self,
            [other.bounding_radius, self.bounding_radius],
        )
    }
}

fn trace<R: Real>(inertia: R::Mat3) -> R {
    let [x, y, z] = inertia.columns();
    x.x() + y.y() + z.z()
}

/// Hash of the contacts.
fn hash_of<R: Real>(contacts: &[ContactPoint<R>]) -> u64 {
    hash_of_numbers(contacts.iter().flat_map(|contact| {
        let p = contact.position;
        [p.x(), p.y(), p.z(), contact.radius]
    }))
}

/// Hash of the positions at the ends of a range. Unlike a NaN, the hash of it equals itself.
fn hash_of_ends<R: Real>(ends: Option<[R::Vec3; 4]>) -> u64 {
    let ends = ends.into_iter().flatten();
    hash_of_numbers(ends.flat_map(|end| [end.x(), end.y(), end.z()]))
}

/// Hash of the support function in one direction, which is not that of an axis or of a diagonal.
/// For a smooth body the support point is included.
fn hash_of_support<R: Real, B: RigidPointBody<R> + ?Sized>(body: &B) -> u64 {
    let direction = unit::<R>(R::Vec3::new(R::TWO, R::from_f64(-3.0), R::from_f64(6.0)));
    let point = if body.is_smooth() {
        body.support_point(direction)
    } else {
        R::Vec3::ZERO
    };
    hash_of_numbers([body.support(direction), point.x(), point.y(), point.z()])
}

/// Hash of the bits of numbers by FNV-1a.
fn hash_of_numbers<R: Real>(numbers: impl IntoIterator<Item = R>) -> u64 {
    numbers
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, number| {
            (hash ^ number.to_f64().to_bits()).wrapping_mul(0x0100_0000_01b3)
        })
}

#[cfg(test)]
mod tests;
