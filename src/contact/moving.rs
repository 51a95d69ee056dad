//! The contact of a smooth body, which moves over its surface as the body rotates.

use core::marker::PhantomData;

use crate::body::{ContactPoint, RigidPointBody};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector, unit};
use crate::rotation::Axes;

/// Contact that moves over the surface of a smooth body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingContact<'a, B, R> {
    body: &'a B,
    numbers: PhantomData<R>,
}

impl<'a, B: RigidPointBody<R>, R: Real> MovingContact<'a, B, R> {
    /// Moving contact of a body, or `None` if its contacts are fixed in it.
    #[inline(always)]
    pub(super) fn of(body: &'a B) -> Option<Self> {
        let moving = Self {
            body,
            numbers: PhantomData,
        };
        body.is_smooth().then_some(moving)
    }

    /// Point of the body that faces the ground, as a bare contact for a pose of the body: the
    /// ground's normal at the point is opposite to the body's.
    ///
    /// There the gap has a derivative by the pose as on the tangent plane, because the point is the
    /// lowest one over that plane. So the force of the springs has a potential.
    ///
    /// The search begins with the normal under the contact that represents the body, and goes on to
    /// that at the point for the normal before. In a valley the difference of two normals is
    /// multiplied each time by the ratio of the radii of curvature of body and ground, on a hill by
    /// minus that ratio. So it is accelerated ([`Search`]). In a valley that is more curved than
    /// the body, such a point is not the deepest one. There, and where an edge of the ground
    /// prevents an end, the first point is taken.
    #[inline]
    pub(crate) fn above<G: SpringDamperGround<R>>(
        &self,
        ground: &G,
        position: R::Vec3,
        axes: &Axes<R>,
    ) -> ContactPoint<R> {
        let middle = self.body.contacts().first().copied().unwrap_or_default();
        let normal_at = |point: R::Vec3| ground.surface(position + axes.to_world(point)).normal;
        let facing = |normal: R::Vec3| self.body.support_point(axes.to_body(-normal));
        let mut normal = normal_at(middle.position);
        let first = facing(normal);
        let mut search = Search::<R>::NONE;
        let mut point = first;
        for _ in 0..SEARCHES {
            let change = normal_at(point) - normal;
            if search.is_over(change) {
                return ContactPoint::bare(point);
            }
            if search.leads_away(change) {
                break;
            }
            normal = search.next(normal, change);
            point = facing(normal);
        }
        ContactPoint::bare(first)
    }

    /// Vector from the centre of mass to the point of the surface that is farthest in a direction,
    /// m, world axes.
    #[inline]
    pub(super) fn towards(&self, direction: R::Vec3, axes: &Axes<R>) -> R::Vec3 {
        axes.to_world(self.body.support_point(axes.to_body(direction)))
    }

    /// Displacement of the contact point over the surface by a rotation ϑ of the body, on a plane
    /// with this normal: `moved` times `turn · ϑ`, for each of the two pairs, m.
    pub(crate) fn over_surface(&self, normal: R::Vec3, axes: &Axes<R>) -> [(R::Vec3, R::Vec3); 2] {
        let nudge = R::EPSILON.sqrt();
        let first = any_across::<R>(normal);
        let here = self.towards(-normal, axes);
        let pair = |along: R::Vec3| {
            let there = self.towards(along * nudge - normal, axes);
            ((there - here) * (R::ONE / nudge), normal.cross(along))
        };
        [pair(first), pair(normal.cross(first))]
    }
}

/// Most searches for the normal at a contact. Less than ten are enough on ground that is less
/// curved than the body, and on hills of three times its curvature.
const SEARCHES: u32 = 16;

/// Search for a normal `n` that a function returns unchanged, by Anderson's method with two
/// differences (Walker & Ni, SIAM J. Numer. Anal. 49, 1715, 2011).
///
/// The two differences of earlier changes span the tangent plane of the normals. What they explain
/// of a change is removed with the differences of the normals that belong to them, as by Newton's
/// method with differences for derivatives.
struct Search<R: Real> {
    /// Last normal, and its change by the function.
    last: Option<[R::Vec3; 2]>,
    /// Differences of the last normals, and of their changes.
    differences: [[R::Vec3; 2]; 2],
}

impl<R: Real> Search<R> {
    const NONE: Self = Self {
        last: None,
        differences: [[R::Vec3::ZERO; 2]; 2],
    };

    /// Returns true if a change is rounding, or small against the force.
    #[inline]
    fn is_over(&self, change: R::Vec3) -> bool {
        let square = change.length_squared();
        let stalls = |[_, last]: &[R::Vec3; 2]| square >= last.length_squared();
        square <= R::EPSILON * R::EPSILON.sqrt()
            || square <= R::EPSILON && self.last.as_ref().is_some_and(stalls)
    }

    /// Returns true if the first change repeats itself in its direction, as in a valley that is
    /// more curved than the body.
    #[inline]
    fn leads_away(&self, change: R::Vec3) -> bool {
        let is_second = self.differences[0][1] == R::Vec3::ZERO;
        is_second && (self.last).is_some_and(|[_, last]| change.dot(last) >= last.length_squared())
    }

    /// Returns the normal to try after one that has this change.
    fn next(&mut self, normal: R::Vec3, change: R::Vec3) -> R::Vec3 {
        if let Some([before, change_before]) = self.last {
            let newest = [normal - before, change - change_before];
            self.differences = [newest, self.differences[0]];
        }
        self.last = Some([normal, change]);
        let [one, two] = self.differences;
        let [share_of_one, share_of_two] = shares(change, one[1], two[1]);
        let mut step = change - (one[0] + one[1]) * share_of_one - (two[0] + two[1]) * share_of_two;
        let length = step.length();
        if length > R::HALF {
            step = step * (R::HALF / length);
        }
        unit::<R>(normal + step)
    }
}

/// Shares of two vectors whose sum is nearest to a third one. The second share is 0 if they are
/// parallel, and both are if there is none.
fn shares<R: Real>(of: R::Vec3, first: R::Vec3, second: R::Vec3) -> [R; 2] {
    let [a, b, c] = [
        first.length_squared(),
        first.dot(second),
        second.length_squared(),
    ];
    let [x, y] = [first.dot(of), second.dot(of)];
    let determinant = a * c - b * b;
    if determinant > a * c * R::EPSILON.sqrt() {
        [(x * c - y * b) / determinant, (a * y - b * x) / determinant]
    } else if a > R::ZERO {
        [x / a, R::ZERO]
    } else {
        [R::ZERO; 2]
    }
}

/// A unit vector at right angles to the given one.
pub(crate) fn any_across<R: Real>(normal: R::Vec3) -> R::Vec3 {
    let o = R::ZERO;
    let other = if normal.x().abs() < R::HALF {
        R::Vec3::new(R::ONE, o, o)
    } else {
        R::Vec3::new(o, R::ONE, o)
    };
    let across = normal.cross(other);
    let length = across.length();
    if length > R::ZERO {
        across * (R::ONE / length)
    } else {
        R::Vec3::ZERO
    }
}
