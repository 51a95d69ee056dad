//! Lanes in which a contact begins or ceases to push within a step.
//!
//! Few steps have such a contact. So the contacts of all lanes are compared at both ends of the
//! step first, row by row, with the operations of the correction itself. It would change nothing in
//! the other lanes.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index of several arrays"
)]

use crate::body::ContactRange;
use crate::contact::{LANES, LoopOverLanes, Motions, Numbers, Vectors};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::integrator::contact_path::AbovePlane;
use crate::integrator::lanes::Lanes;
use crate::real::Real;
use crate::scene::Dynamics;

/// Returns for each lane whether the correction may change its end, given the motions and the
/// contact ranges at the start of the step.
///
/// Computes axes and angular velocities of the ends.
#[inline(always)]
pub(super) fn found<R: Real, D: Dynamics<R>>(
    scene: &D,
    (first, ranges): (&Motions<'_, R>, &[ContactRange; LANES]),
    lanes: &mut Lanes<R>,
) -> [bool; LANES] {
    let model = scene.contact_model();
    let Some(height) = model.height_in_lanes() else {
        return [true; LANES];
    };
    lanes.set_axes_of_any_length();
    lanes.set_spins(scene);
    let mut views = [Views::ZERO; 2];
    set_views(height, [first, &lanes.motions()], &mut views);
    let (rows, counts) = lanes.ranges.rows();
    let mut changes = [R::ZERO; LANES];
    for (row, points) in rows.iter().enumerate() {
        let row = (R::from_usize(row), points);
        compare_row(scene, row, counts, &views, &mut changes);
    }
    // The rows have the contacts of the last stage. If the range is that of the start, there are no
    // others.
    let last = lanes.ranges.get();
    core::array::from_fn(|i| {
        let is_known = ranges[i] == last[i] && lanes.ranges.has_in_rows(i);
        !is_known || changes[i] > R::ZERO
    })
}

/// [`AbovePlane`] of each lane.
#[derive(Clone, Copy)]
struct Views<R: Real> {
    depth: Numbers<R>,
    closing_speed: Numbers<R>,
    rise: Vectors<R>,
    rising: Vectors<R>,
}

impl<R: Real> Views<R> {
    const ZERO: Self = Self {
        depth: [R::ZERO; LANES],
        closing_speed: [R::ZERO; LANES],
        rise: Vectors::ZERO,
        rising: Vectors::ZERO,
    };

    #[inline(always)]
    fn set(&mut self, i: usize, view: &AbovePlane<R>) {
        self.depth[i] = view.depth;
        self.closing_speed[i] = view.closing_speed;
        self.rise.set(i, view.rise);
        self.rising.set(i, view.rising);
    }

    #[inline(always)]
    fn get(&self, i: usize) -> AbovePlane<R> {
        AbovePlane {
            depth: self.depth[i],
            closing_speed: self.closing_speed[i],
            rise: self.rise.get(i),
            rising: self.rising.get(i),
        }
    }
}

/// Computes the views of both ends, in one loop: the compiler unrolls a shorter one, and finds no
/// lanes.
#[inline(never)]
fn set_views<R: Real>(height: R, motions: [&Motions<'_, R>; 2], views: &mut [Views<R>; 2]) {
    for i in 0..LANES {
        for (views, motions) in views.iter_mut().zip(motions) {
            views.set(i, &AbovePlane::of_level(height, &motions.get(i)));
        }
    }
}

/// Counts for each lane the contacts of this row that push at one end of the step only.
#[inline(never)]
fn compare_row<R: Real, D: Dynamics<R>>(
    scene: &D,
    (row, points): (R, &Vectors<R>),
    counts: &Numbers<R>,
    views: &[Views<R>; 2],
    changes: &mut Numbers<R>,
) {
    scene.evaluate_in_lanes(CompareRow {
        row,
        points,
        counts,
        views,
        changes,
    });
}

/// Contacts of one row.
struct CompareRow<'a, R: Real> {
    row: R,
    points: &'a Vectors<R>,
    counts: &'a Numbers<R>,
    views: &'a [Views<R>; 2],
    changes: &'a mut Numbers<R>,
}

impl<R: Real> LoopOverLanes<R> for CompareRow<'_, R> {
    #[inline(always)]
    fn run<G: SpringDamperGround<R>, F: SlidingFriction<R>>(self, (ground, _): (&G, &F)) {
        for i in 0..LANES {
            let pushes = |views: &Views<R>| {
                let [depth, closing_speed] = views.get(i).at(self.points.get(i));
                let penetrates = depth > R::ZERO;
                // The law is evaluated at some positive depth in lanes without this contact.
                let depth = if penetrates { depth } else { R::EPSILON };
                let force = ground.normal_force(depth, closing_speed);
                penetrates & (force > R::ZERO)
            };
            let [start, end] = self.views;
            let changed = (self.row < self.counts[i]) & (pushes(start) != pushes(end));
            self.changes[i] += if changed { R::ONE } else { R::ZERO };
        }
    }
}
