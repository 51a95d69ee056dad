//! Contacts that begin or cease to push within a step, or turn their slip round.
//!
//! The damper's force jumps where a contact touches down, and a contact that leaves so fast that
//! its spring cannot follow ceases to push with a kink. A Runge-Kutta step takes the force as
//! smooth; how wrong it is depends on where in the step that happens, and its own estimate may be
//! small by chance. So each contact is looked at by itself, at both ends of the step, with its gap
//! in between by cubic Hermite interpolation.

use super::{Attempt, Pair, Place};
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, Path, arm, push, slip};
use crate::real::{Real, Vector};
use crate::scene::{Contact, Dynamics, Load, Motion, size, visit_points};
use core::ops::{Add, Mul};

/// What contacts spoil in a step whose force has a kink in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kinks<R> {
    /// Bound of the error in the velocity of the farthest place, m/s.
    pub(super) velocity: R,
    /// Share of the step after which the first one that matters comes.
    pub(super) first: Option<R>,
}

impl<R: Real> Kinks<R> {
    /// None.
    pub(super) fn none() -> Self {
        Self {
            velocity: R::ZERO,
            first: None,
        }
    }
}

/// All kinks of a step with a `smooth` error; one that goes to a kink was taken with
/// [`load_before`].
#[inline]
pub(super) fn kinks<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    scene: &D,
    start: &Place<R>,
    attempt: &Attempt<R, STAGES>,
    seconds: R,
    to_kink: bool,
    [smooth, allowed]: [R; 2],
) -> Kinks<R> {
    let mut kinks = Kinks::none();
    let places = [start, &attempt.end];
    let step = Taken {
        pair,
        scene,
        motions: &attempt.motions,
        ends: places.map(|place| &place.motion),
        seconds,
        to_kink,
        allowed,
    };
    let contacts = scene.body().contacts();
    let margin = dip(scene, places, seconds);
    let [before, after] = places
        .map(|place| scene.contacts_within(margin, place.motion.position, &place.motion.axes));
    // A step that is too long anyhow, and long enough to have many contacts near the ground, is not
    // worth the look.
    if smooth > allowed && before.count.saturating_add(after.count) > MANY {
        return kinks;
    }
    for run in [before]
        .into_iter()
        .chain(after.without(before, contacts.len()))
    {
        for point in run.parts(contacts).into_iter().flatten() {
            step.look_at(point, &mut kinks);
        }
    }
    kinks
}

/// The load in a step up to a kink at its end: without the contacts that begin to push only there.
///
/// A stage at the end of the step may lie a little beyond the path, so that it would see the jump
/// of a force that the step just does not reach.
pub(super) fn load_before<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Motion<R>,
    motion: &Motion<R>,
    seconds: R,
) -> Load<R> {
    let mut load = Load::default();
    let mut add = |contact: &Contact<R>| {
        let laws = (scene.ground(), scene.friction());
        load.add(contact, contact.force(laws.0, laws.1));
        load.torque += contact.turning_torque(laws.0, laws.1, motion.angular_velocity);
    };
    let run = scene.contacts_within(R::ZERO, motion.position, &motion.axes);
    visit_points(scene, run, motion, &mut |contact| {
        if !comes_late(&ContactEnd::of(scene, start, &contact.point), seconds) {
            add(contact);
        }
    });
    // Places of a rim come one after the other, without a jump of its force.
    scene.visit_rims(motion, add);
    load
}

/// How deep a contact may dip between two ends above ground: `a h²/8`, with the accelerations of
/// the body's farthest place, m.
#[inline]
fn dip<R: Real, D: Dynamics<R>>(scene: &D, places: [&Place<R>; 2], seconds: R) -> R {
    let bounding_radius = scene.bounding_radius();
    let acceleration = places.map(|place| {
        let spin = place.motion.angular_velocity;
        let turn = scene
            .inertia_properties()
            .angular_velocity(&place.motion.axes, place.slope.angular_momentum);
        place.slope.linear_velocity.length()
            + (turn.length() + spin.length_squared()) * bounding_radius
    });
    let [first, last] = acceleration;
    first.at_least(last) * (seconds * seconds * R::from_f64(0.125))
}

/// Whether a contact is above ground now and, going on evenly, for the first half of a step.
#[inline]
fn comes_late<R: Real>(side: &ContactEnd<R>, seconds: R) -> bool {
    let halfway = side.depth + side.closing_speed * (seconds * R::HALF);
    side.depth <= R::ZERO && halfway <= R::ZERO
}

/// A step that has been tried.
pub(super) struct Taken<'a, R: Real, D, const STAGES: usize> {
    pair: &'a Pair<STAGES>,
    pub(super) scene: &'a D,
    motions: &'a [Motion<R>; STAGES],
    pub(super) ends: [&'a Motion<R>; 2],
    pub(super) seconds: R,
    to_kink: bool,
    allowed: R,
}

impl<R: Real, D: Dynamics<R>, const STAGES: usize> Taken<'_, R, D, STAGES> {
    #[inline]
    fn look_at(&self, point: &ContactPoint<R>, kinks: &mut Kinks<R>) {
        let [start, end] = self
            .ends
            .map(|motion| ContactEnd::of(self.scene, motion, point));
        if start.pushes() && end.pushes() {
            let wrong = self.wrong_of_slip(point, &[start, end]);
            kinks.velocity += wrong;
            return;
        }
        let path = Path::between(&start, &end, self.seconds);
        let last = if start.pushes() != end.pushes() {
            Some(R::ONE)
        } else if path.turns_under_ground() {
            Some(path.turn())
        } else if self.nears(&end) {
            None
        } else {
            return;
        };
        self.weigh(point, &path, &[start, end], last, kinks);
    }

    /// Whether a contact ends above ground, but would be under it so soon that a stage, ahead of
    /// the path, may have seen it touch.
    #[inline]
    fn nears(&self, end: &ContactEnd<R>) -> bool {
        let ahead = end.closing_speed * (self.seconds * R::from_f64(AHEAD));
        end.depth <= R::ZERO && end.depth + ahead > R::ZERO
    }

    /// One contact that begins or ceases to push before the share `last` of the step, or that comes
    /// near without doing so.
    #[inline(never)]
    fn weigh(
        &self,
        point: &ContactPoint<R>,
        path: &Path<R>,
        [start, end]: &[ContactEnd<R>; 2],
        last: Option<R>,
        kinks: &mut Kinks<R>,
    ) {
        let force = |share: R| {
            let (depth, slope) = path.at(share);
            push(self.scene, depth, slope / self.seconds)
        };
        let pushes = start.pushes();
        let share = last.map_or(R::ONE, |last| first_change(force, pushes, last));
        let truth = if pushes {
            mean(force, R::ZERO, share)
        } else {
            mean(force, share, R::ONE)
        };
        let taken = if self.to_kink && comes_late(start, self.seconds) {
            R::ZERO
        } else {
            self.mean_of_stages(point)
        };
        let motion = self.ends[usize::from(!pushes)];
        let mobility = mobility(self.scene, point, motion);
        let velocity = (truth - taken).abs() * (self.seconds * mobility) * R::from_f64(WEIGHT);
        kinks.velocity += velocity;
        if velocity * R::from_f64(4.0) > self.allowed {
            let change = force(share) + (start.normal_force - end.normal_force).abs();
            let there = self.just_beyond(share, mobility * change);
            kinks.first = Some(kinks.first.map_or(there, |first| first.at_most(there)));
        }
    }

    /// What the method has made of the contact's force, N.
    fn mean_of_stages(&self, point: &ContactPoint<R>) -> R {
        let mut sum = R::ZERO;
        for (motion, weight) in self.weighed_motions() {
            sum += ContactEnd::of(self.scene, motion, point).normal_force * weight;
        }
        sum
    }

    /// The stages whose slopes are in the result, with their weights.
    pub(super) fn weighed_motions(&self) -> impl Iterator<Item = (&Motion<R>, R)> {
        (self.motions.iter().zip(self.pair.weights()))
            .filter(|(_, weight)| **weight != 0.0)
            .map(|(motion, weight)| (motion, R::from_f64(*weight)))
    }

    /// A share of the step so little beyond a kink that a force with this acceleration (m/s²) does
    /// no harm until there.
    ///
    /// Not below a fiftieth: what is wrong near the start may be the path, which a shorter step
    /// shows.
    fn just_beyond(&self, share: R, acceleration: R) -> R {
        let harmless = self.allowed / (acceleration * self.seconds * R::from_f64(EXACTLY));
        let there = share + harmless.at_most(R::ONE - share);
        there.at_least(R::from_f64(0.02))
    }
}

/// The first share of a step at which a force begins to push or ceases to, up to `last`, where it
/// has; a little beyond it.
fn first_change<R: Real>(force: impl Fn(R) -> R, pushes: bool, last: R) -> R {
    let (mut low, mut high) = (R::ZERO, last);
    for _ in 0..HALVINGS {
        let middle = (low + high) * R::HALF;
        if (force(middle) > R::ZERO) == pushes {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The share of what is found of the kinks that counts. They err to either side, and contacts take
/// back most of what a wrong impulse of one of them has done: of the way that such an error of the
/// velocity would make in a second, 5 % is left in trial 3 of the report, where the coin sticks,
/// and 20 to 100 % in trial 8, where it slides and falls over.
const WEIGHT: f64 = 1.0 / 3.0;
/// A kink is found so much more exactly than its own share of the tolerance asks.
const EXACTLY: f64 = 2.0;
/// By how much of a step its stages may be ahead of the path: those of Dormand and Prince
/// extrapolate far.
const AHEAD: f64 = 0.5;
/// As many contacts at both ends of a step are more expensive to evaluate than another attempt.
const MANY: usize = 48;
/// Halvings of a step to find a kink: to a millionth of it.
const HALVINGS: u32 = 20;

/// The integral of a force over a part of the step, in steps, by Gauss's rule with three points.
pub(super) fn mean<R: Real, F>(force: impl Fn(R) -> F, from: R, to: R) -> F
where
    F: Add<Output = F> + Mul<R, Output = F>,
{
    let (middle, half) = ((from + to) * R::HALF, (to - from) * R::HALF);
    let out = half * R::from_f64(0.774_596_669_241_483_4);
    let [inner, outer] = [8.0 / 9.0, 5.0 / 9.0].map(R::from_f64);
    ((force(middle - out) + force(middle + out)) * outer + force(middle) * inner) * half
}

/// How fast the farthest place of the body moves for a normal impulse of 1 N s at a contact, with
/// its friction: 1/kg.
fn mobility<R: Real, D: Dynamics<R>>(scene: &D, point: &ContactPoint<R>, motion: &Motion<R>) -> R {
    let mass = scene.inertia_properties();
    let (arm, normal) = arm(scene, motion, point);
    let slip = slip(motion, (arm, normal));
    let force = normal + scene.friction().force(R::ONE, slip);
    let spin = mass.angular_velocity(&motion.axes, arm.cross(force));
    force.length() * mass.inverse_mass() + spin.length() * size(scene)
}
