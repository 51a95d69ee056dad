//! Forces on several states of one body, computed in lanes: one lane of the processor's vectors for
//! each state.
//!
//! A stage is a loop over the lanes around the function that a single state uses, with numbers that
//! are stored axis by axis. The compiler vectorises it. So the operations on a state and their
//! order are those of a single state, and so are its bits.
//!
//! *Branches.* A lane whose contact is separated adds a force of 0. A sum that starts at 0 is never
//! -0, so 0 changes none of its bits. The laws are then evaluated at some positive depth, and the
//! result is dropped.
//!
//! *Divergence.* The contacts of a lane are added in the order of its contact range, row by row.
//! All lanes take as many rows as the lane with the most contacts. The ends of a range show in
//! lanes that it has not changed. Otherwise the search is that of a single state. A lane with more
//! than [`ROWS`] contacts is computed as a single state, which adds many contacts in another order.
//! So are all lanes of a scene that is not bare points on a level plane.
//!
//! *Gain:* the table of [`guide::modelling`](crate::guide::modelling), written by `.ci/lanes.sh`.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index of several arrays"
)]

use super::level::{self, Level};
use super::load::Load;
use super::model::ContactModel;
use crate::body::{ContactRange, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Number of states that are stepped together: two vectors of four `f64`. Four states are slower in
/// almost all rows of `.ci/lanes.sh` that were measured. Sixteen are faster in some and slower in
/// others, and more of them wait for the lane with the most contacts.
pub(crate) const LANES: usize = 8;

/// Largest number of contacts of a lane that are added row by row. A single state adds more
/// contacts in blocks, in another order.
const ROWS: usize = level::BLOCK_LEN - 1;

/// One number for each lane.
pub(crate) type Numbers<R> = [R; LANES];

/// One vector for each lane, stored axis by axis.
///
/// It is aligned like the vectors of the processor. Without AVX, only then can the instruction that
/// computes also load.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Vectors<R>([Numbers<R>; 3]);

impl<R: Real> Vectors<R> {
    pub(crate) const ZERO: Self = Self([[R::ZERO; LANES]; 3]);

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> R::Vec3 {
        let [x, y, z] = &self.0;
        R::Vec3::new(x[i], y[i], z[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, vector: R::Vec3) {
        let [x, y, z] = &mut self.0;
        x[i] = vector.x();
        y[i] = vector.y();
        z[i] = vector.z();
    }
}

/// Body axes of each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxesInLanes<R> {
    pub(crate) x: Vectors<R>,
    pub(crate) y: Vectors<R>,
    pub(crate) z: Vectors<R>,
}

impl<R: Real> AxesInLanes<R> {
    pub(crate) const ZERO: Self = Self {
        x: Vectors::ZERO,
        y: Vectors::ZERO,
        z: Vectors::ZERO,
    };

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Axes<R> {
        Axes {
            x: self.x.get(i),
            y: self.y.get(i),
            z: self.z.get(i),
        }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, axes: &Axes<R>) {
        self.x.set(i, axes.x);
        self.y.set(i, axes.y);
        self.z.set(i, axes.z);
    }
}

/// Pose and velocities of each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motions<'a, R> {
    pub(crate) position: &'a Vectors<R>,
    pub(crate) axes: &'a AxesInLanes<R>,
    pub(crate) linear_velocity: &'a Vectors<R>,
    pub(crate) angular_velocity: &'a Vectors<R>,
}

impl<R: Real> Motions<'_, R> {
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Motion<R> {
        Motion {
            position: self.position.get(i),
            axes: self.axes.get(i),
            linear_velocity: self.linear_velocity.get(i),
            angular_velocity: self.angular_velocity.get(i),
        }
    }
}

/// Load of each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loads<R> {
    pub(crate) force: Vectors<R>,
    pub(crate) torque: Vectors<R>,
    /// Number of contacts that touch.
    pub(crate) touching: Numbers<R>,
}

impl<R: Real> Loads<R> {
    pub(crate) const ZERO: Self = Self {
        force: Vectors::ZERO,
        torque: Vectors::ZERO,
        touching: [R::ZERO; LANES],
    };

    /// Returns for each lane whether no contact touches.
    #[inline(always)]
    pub(crate) fn flies(&self) -> [bool; LANES] {
        self.touching.map(|count| count <= R::ZERO)
    }

    /// Adds a force (N) and a torque (N m) to a lane.
    #[inline(always)]
    pub(crate) fn add(&mut self, i: usize, force: R::Vec3, torque: R::Vec3) {
        self.force.set(i, self.force.get(i) + force);
        self.torque.set(i, self.torque.get(i) + torque);
    }

    #[inline(always)]
    fn set(&mut self, i: usize, load: &Load<R>) {
        self.force.set(i, load.force);
        self.torque.set(i, load.torque);
        self.touching[i] = R::from_usize(load.touching);
    }
}

/// Contact ranges of the lanes, with the positions of their contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranges<R> {
    ranges: [ContactRange; LANES],
    /// Contacts before each range, first and last in it, and after it.
    ends: [Vectors<R>; 4],
    /// Offset of the ground below which an empty range stays empty, m.
    empty_below: Numbers<R>,
    /// The contacts of each lane, one a row.
    rows: [Vectors<R>; ROWS],
    /// Number of contacts of each lane, 0 for a lane with more than [`ROWS`].
    counts: Numbers<R>,
    /// Number of rows with a contact.
    most: usize,
    /// Number of lanes with more than [`ROWS`] contacts.
    long: usize,
}

impl<R: Real> Ranges<R> {
    /// Empty ranges of which nothing is known.
    pub(crate) fn none() -> Self {
        // No search returns this range, so the first one is stored.
        let unknown = ContactRange {
            first: usize::MAX,
            count: 0,
        };
        Self {
            ranges: [unknown; LANES],
            ends: [Vectors::ZERO; 4],
            empty_below: [-R::MAX; LANES],
            rows: [Vectors::ZERO; ROWS],
            counts: [R::ZERO; LANES],
            most: 0,
            long: 0,
        }
    }

    /// Contact range of each lane.
    #[inline(always)]
    pub(crate) fn get(&self) -> &[ContactRange; LANES] {
        &self.ranges
    }

    /// Positions in the body of the contacts of each lane, one a row, and their numbers. A lane
    /// with too many of them has none in the rows.
    #[inline(always)]
    pub(crate) fn rows(&self) -> (&[Vectors<R>], &Numbers<R>) {
        let rows = self.rows.get(..self.most).unwrap_or(&self.rows);
        (rows, &self.counts)
    }

    /// Returns true if the rows of a lane have all its contacts.
    #[inline(always)]
    pub(crate) fn has_in_rows(&self, i: usize) -> bool {
        self.ranges[i].count <= ROWS
    }

    /// Finds the contact range of each lane, first near the one before.
    #[inline(always)]
    pub(crate) fn find<B, G, F>(
        &mut self,
        model: &ContactModel<'_, B, G, F, R>,
        position: &Vectors<R>,
        axes: &AxesInLanes<R>,
    ) where
        B: RigidPointBody<R>,
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let mut stay = [R::ZERO; LANES];
        let staying = match model.height_of_bound() {
            Some(height) => self.test(model, height, (position, axes), &mut stay),
            None => 0,
        };
        // A rolling body keeps its range for many steps.
        if staying < LANES {
            self.search(model, &stay, position, axes);
        }
    }

    /// Tests for each lane whether its range is still that of a level ground. Then the number is 1.
    /// Returns the number of these lanes.
    #[inline(never)]
    fn test<B, G, F>(
        &self,
        model: &ContactModel<'_, B, G, F, R>,
        height: R,
        (position, axes): (&Vectors<R>, &AxesInLanes<R>),
        stay: &mut Numbers<R>,
    ) -> usize
    where
        B: RigidPointBody<R>,
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let mut staying = 0;
        let [before, first, last, after] = &self.ends;
        for i in 0..LANES {
            let normal = axes.get(i).rise();
            let gap = position.get(i).z() - height;
            let offset = model.offset(R::ZERO, gap.abs() + height.abs(), gap);
            let is_below = |ends: &Vectors<R>| normal.dot(ends.get(i)) < offset;
            let stays = is_below(first) & is_below(last) & !is_below(before) & !is_below(after);
            let stays = stays | (offset < self.empty_below[i]);
            stay[i] = if stays { R::ONE } else { R::ZERO };
            staying += usize::from(stays);
        }
        staying
    }

    /// Searches for the ranges that may have changed.
    #[inline(never)]
    fn search<B, G, F>(
        &mut self,
        model: &ContactModel<'_, B, G, F, R>,
        stay: &Numbers<R>,
        position: &Vectors<R>,
        axes: &AxesInLanes<R>,
    ) where
        B: RigidPointBody<R>,
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        for i in 0..LANES {
            if stay[i] < R::ONE {
                let near = self.ranges[i];
                let range = model.range_near(near, position.get(i), &axes.get(i));
                if range != near {
                    self.ranges[i] = range;
                    self.store_contacts(i, model);
                }
            }
        }
        let counts = || self.ranges.iter().map(|range| range.count);
        self.most = counts().filter(|count| *count <= ROWS).fold(0, usize::max);
        self.long = counts().filter(|count| *count > ROWS).count();
    }

    /// Stores the positions of the contacts of a lane.
    #[inline(always)]
    fn store_contacts<B, G, F>(&mut self, i: usize, model: &ContactModel<'_, B, G, F, R>)
    where
        B: RigidPointBody<R>,
    {
        let range = self.ranges[i];
        let ends = model.body.range_ends(range);
        // Equal ends are not on different sides of a plane.
        for (store, end) in self.ends.iter_mut().zip(ends.unwrap_or([R::Vec3::ZERO; 4])) {
            store.set(i, end);
        }
        let is_empty = range.count == 0;
        self.empty_below[i] = if is_empty {
            -model.extent.bounding_radius
        } else {
            -R::MAX
        };
        self.counts[i] = R::ZERO;
        if range.count <= ROWS {
            let [head, tail] = range.parts(model.body.contacts());
            for (row, contact) in self.rows.iter_mut().zip(head.iter().chain(tail)) {
                row.set(i, contact.position);
            }
            self.counts[i] = R::from_usize(head.len() + tail.len());
        }
    }
}

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Height of the ground, if the contacts of a lane are added row by row.
    pub(crate) fn height_in_lanes(&self) -> Option<R> {
        let is_plain = self.body.rims().is_empty()
            && !self.ground_moves()
            && self.friction.rolling_resistance(R::ZERO).is_none();
        self.height_under_bare_points().filter(|_| is_plain)
    }

    /// Load of each lane, as [`load_on`](Self::load_on) returns it.
    ///
    /// `evaluate` calls its argument with the laws.
    #[inline(always)]
    pub(crate) fn loads_in_lanes(
        &self,
        ranges: &Ranges<R>,
        motions: &Motions<'_, R>,
        evaluate: &impl Fn(AddRow<'_, R>),
        loads: &mut Loads<R>,
    ) {
        *loads = Loads::ZERO;
        let Some(height) = self.height_in_lanes() else {
            for i in 0..LANES {
                loads.set(i, &self.load_on(ranges.ranges[i], &motions.get(i)));
            }
            return;
        };
        let (rows, counts) = ranges.rows();
        for (row, points) in rows.iter().enumerate() {
            let row = (R::from_usize(row), points);
            add_row(evaluate, height, row, counts, motions, loads);
        }
        if ranges.long > 0 {
            self.add_long(ranges, motions, loads);
        }
    }

    /// Computes the load of the lanes with many contacts.
    #[cold]
    #[inline(never)]
    fn add_long(&self, ranges: &Ranges<R>, motions: &Motions<'_, R>, loads: &mut Loads<R>) {
        for (i, range) in ranges.ranges.iter().enumerate() {
            if range.count > ROWS {
                loads.set(i, &self.load_on(*range, &motions.get(i)));
            }
        }
    }
}

/// Loop over lanes that evaluates laws.
///
/// A scene gives it the laws. If the scene tests their values, it notes in a variable of the loop
/// that a test has failed. A flag in memory would keep the compiler from finding lanes.
pub trait LoopOverLanes<R: Real> {
    /// Runs the loop.
    fn run<G: SpringDamperGround<R>, F: SlidingFriction<R>>(self, laws: (&G, &F));
}

/// Adds one contact of each lane that has one in this row.
#[inline(never)]
fn add_row<R: Real>(
    evaluate: &impl Fn(AddRow<'_, R>),
    height: R,
    (row, points): (R, &Vectors<R>),
    counts: &Numbers<R>,
    motions: &Motions<'_, R>,
    loads: &mut Loads<R>,
) {
    evaluate(AddRow {
        height,
        row,
        points,
        counts,
        motions,
        loads,
    });
}

/// Contacts of one row.
pub(crate) struct AddRow<'a, R: Real> {
    height: R,
    row: R,
    points: &'a Vectors<R>,
    counts: &'a Numbers<R>,
    motions: &'a Motions<'a, R>,
    loads: &'a mut Loads<R>,
}

impl<R: Real> LoopOverLanes<R> for AddRow<'_, R> {
    #[inline(always)]
    fn run<G: SpringDamperGround<R>, F: SlidingFriction<R>>(self, laws: (&G, &F)) {
        for i in 0..LANES {
            let motion = &self.motions.get(i);
            let level = Level::under(self.height, motion);
            let arm = motion.axes.to_world(self.points.get(i));
            let depth = level.depth(arm);
            // The plane is far below a lane that has no contact in this row.
            let depth = if self.row < self.counts[i] {
                depth
            } else {
                -R::ONE
            };
            let touches = depth > R::ZERO;
            let force = level.force(laws, arm, if touches { depth } else { R::EPSILON });
            let only = |number: R| if touches { number } else { R::ZERO };
            let force = R::Vec3::new(only(force.x()), only(force.y()), only(force.z()));
            self.loads.add(i, force, arm.cross(force));
            self.loads.touching[i] += only(R::ONE);
        }
    }
}
