//! Panels of the rims that touch in an implicit step, whose points are placed anew for each trial.

use super::dual::Dual;
use super::problem::{Problem, TrialStep};
use super::reversal::Reversal;
use super::touch::Touch;
use crate::body::{BESIDE_RIMS, MOST_RIMS};
use crate::body::{Panel, RigidPointBody, Rim};
use crate::contact::RimStep;
use crate::real::Real;
use crate::scene::Dynamics;

/// Largest number of panels of all rims that are known for their reversals of friction.
const MOST_PANELS: usize = 24;

/// Smallest number of stored contacts with which all panels of a body with rims have their points:
/// [`MOST_PANELS`] of four.
pub(super) const FOR_RIMS: u32 = 96;
const _: () = assert!(FOR_RIMS as usize == 4 * MOST_PANELS);
// A body promises no more rims and contacts than the default storage has room for.
const _: () = assert!(FOR_RIMS as usize == 12 * MOST_RIMS);
const _: () = assert!(FOR_RIMS as usize + BESIDE_RIMS == 128);

/// Largest fraction of the length below ground at which a panel needs no more than four points.
/// Most such panels are below the ground at the start or at the end of the step only.
///
/// Let κ be the chord of the arc and c that of the panel. The depth on the panel is a polynomial of
/// degree 2 in the chord, except for terms of order c², and its square is integrated exactly. The
/// rest is less than `c⁹/κ³` of the springs' energy: `κ⁶/16⁹`, less than 1e-13.
const SLIVER: f64 = 1.0 / 16.0;

/// Panel of a rim whose points are among the contacts of a step.
#[derive(Clone, Copy, Debug)]
struct PlacedPanel {
    /// Number of the rim.
    rim: u16,
    /// End of the panel's points among the contacts.
    end: u16,
}

impl PlacedPanel {
    fn of(rim: usize, end: usize) -> Self {
        // Both are far smaller, so that nothing is cut off.
        let [rim, end] = [rim, end].map(|number| u16::try_from(number).unwrap_or(u16::MAX));
        Self { rim, end }
    }
}

/// Panels of all rims, in the order of their points among the contacts.
#[derive(Clone, Debug)]
pub(super) struct Panels {
    placed: [PlacedPanel; MOST_PANELS],
    count: usize,
}

impl Panels {
    pub(super) const NONE: Self = Self {
        placed: [PlacedPanel { rim: 0, end: 0 }; MOST_PANELS],
        count: 0,
    };

    /// Panels of a step that no test takes.
    #[cfg(test)]
    pub(super) const LEFT_OVER: Self = Self {
        placed: [PlacedPanel { rim: 1, end: 8 }; MOST_PANELS],
        count: 7,
    };

    /// Places the points of the rims over a trial step. They cover the parts of each rim below the
    /// ground at the start or at the end of the step. The panels are divided at the ends of both
    /// arcs.
    ///
    /// The points are material points of the body, fixed over the step, with the same weights at
    /// its start and at its end. The energy that springs return and the energy that is dissipated
    /// are therefore those of such points. No end of an arc lies within a panel. The sums at start
    /// and end are therefore the energies there, apart from a quadrature error of at most 2e-10.
    ///
    /// The points follow the first `fixed` contacts of the storage. Those beyond `remembered` are
    /// new. Returns the number of all contacts.
    #[inline(never)]
    pub(super) fn place_points<R: Real, D: Dynamics<R>>(
        &mut self,
        (problem, trial): (&Problem<'_, R, D>, &TrialStep<R>),
        touches: &mut [Touch<R>],
        [fixed, remembered]: [usize; 2],
    ) -> usize {
        let end = problem.place_at_end(trial);
        let mut count = fixed;
        self.count = 0;
        // Each surface has the same share of the storage, and so have the rims that touch it. Where
        // a share does not suffice for all panels, each of them has fewer points.
        let surfaces = problem.surfaces();
        let room = touches.len() - count.min(touches.len());
        let share = room / (surfaces as usize).max(1);
        let rims = problem.scene.body().rims();
        for surface in 0..surfaces {
            let laws = (&problem.ground(surface), &problem.law(surface));
            let step = RimStep {
                laws,
                plane: problem.plane_of(surface),
                poses: [(problem.motion.position, problem.motion.axes), end],
                velocities: [trial.velocity, problem.ground_velocity_at_centre()],
                turning: |arm| {
                    let turned = trial.rotation_change.times(arm) * problem.per_second;
                    turned - problem.ground_rotation_velocity(arm)
                },
            };
            let mut room = share;
            for (number, rim) in rims.iter().enumerate() {
                let others = rims.get(number + 1..).unwrap_or_default();
                let sharing = 1 + step.touching(others);
                let panels = step.panels(rim);
                let most = room / sharing / panels.count().max(1);
                let (first, short) = (count, panels.total_chord() * R::from_f64(SLIVER));
                for panel in panels.iter() {
                    let is_sliver = panel.chord() <= short;
                    let most = if is_sliver { most.min(4) } else { most };
                    let nodes = (rim, panel, most);
                    place_points_of((problem, surface), nodes, touches, (remembered, &mut count));
                    self.note(number, count);
                }
                room -= (count - first).min(room);
            }
        }
        count
    }

    /// Notes a panel of the rim with this number whose points end at this contact.
    fn note(&mut self, rim: usize, end: usize) {
        if let Some(placed) = self.placed.get_mut(self.count) {
            *placed = PlacedPanel::of(rim, end);
            self.count += 1;
        }
    }

    /// Calls `visit` with each point at which friction reverses between two panels of a rim.
    #[inline(never)]
    pub(super) fn visit_reversals<R: Real, D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        touches: &[Touch<R>],
        mut visit: impl FnMut(&Reversal<R>),
    ) {
        let rims = problem.scene.body().rims();
        let placed = self.placed.get(..self.count).unwrap_or_default();
        let touch = |index: Option<usize>| touches.get(index?);
        for (left, right) in placed.iter().zip(placed.iter().skip(1)) {
            let rim = rims.get(usize::from(left.rim));
            let Some(rim) = rim.filter(|_| left.rim == right.rim) else {
                continue;
            };
            // The points of a panel come in pairs, the outermost pair last. Of each pair, the point
            // farther along the rim comes first.
            let [left, right] = [left.end, right.end].map(usize::from);
            let places = [(left, 4), (left, 2), (right, 1), (right, 3)];
            let points = places.map(|(end, before)| touch(end.checked_sub(before)));
            if let [Some(a), Some(b), Some(c), Some(d)] = points {
                let per_metre = rim.points() / (rim.radius() * R::from_f64(core::f64::consts::TAU));
                if let Some(reversal) = Reversal::between(problem, [a, b, c, d], per_metre) {
                    visit(&reversal);
                }
            }
        }
    }
}

/// Places the points of one panel of a rim, at most `most`, after the first `count` contacts.
fn place_points_of<R: Real, D: Dynamics<R>>(
    (problem, surface): (&Problem<'_, R, D>, u32),
    (rim, panel, most): (&Rim<R>, Panel<R>, usize),
    touches: &mut [Touch<R>],
    (remembered, count): (usize, &mut usize),
) {
    rim.visit_nodes(panel, most, |place, weight| {
        let Some(touch) = touches.get_mut(*count) else {
            return;
        };
        touch.become_rim_point(problem, surface, place, weight);
        if *count >= remembered {
            touch.dual = Dual::Unknown;
        }
        *count += 1;
    });
}
