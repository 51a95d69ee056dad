//! The last resort: a step that always exists, downhill.
//!
//! A body that nothing turns aside would shift by `h v + h² g` and turn by `h ω` in the time h.
//! Backward Euler's motion `z` (a shift and a turn) departs from that one, `z₀`, as far as the
//! potential `U` of gravity and springs asks: it makes
//!
//! ```text
//! Φ(z) = (z - h y)ᵀ M (z - h y)/(2 h²) + U(z)          y = (v, ω)
//! ```
//!
//! smallest. `Φ(0)` is the energy of the start. So wherever Φ is lower than there, so is `U`, and
//! the body may be there with a velocity along `z`, scaled as the energy allows. Springs far
//! stiffer than `m/h²` turn the motion along the ground, where an explicit one would be thrown out
//! of it. Dampers and friction only add to what resists.

use super::block::Block;
use super::linear::SixBySix;
use super::{motion_of, visit_contacts};
use crate::energy::Energy;
use crate::friction::SlidingFriction;
use crate::ground::{GroundBounds, SpringDamperGround};
use crate::integrator::{Step, energy_limit};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Contact, Dynamics};
use crate::state::State;

/// Lengths that are tried, each a sixteenth of the one before: down to 2⁻¹²⁰ of the step.
const LENGTHS: u32 = 31;
/// Newton's steps on Φ for each of them.
const NEWTON: u32 = 4;

/// A motion of backward Euler's over `seconds`, a sixteenth of them, ... whose end has an energy of
/// at most `ceiling`. What is left of the time passes all the same: such a step is stable, not
/// accurate. A body that the ground leaves no such motion stops where it is.
///
/// `None` where it has stopped already, or where no ground is in the way and only rounding lifts
/// the energy.
pub(super) fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    ceiling: R,
    seconds: R,
    step: &mut Step<R>,
) -> Option<(State<R>, Energy<R>)> {
    let is_plane = matches!(scene.ground().bounds(), GroundBounds::Plane(_));
    let kinds = [Kind::ByNormals, Kind::WithoutTurn, Kind::ByDifferences];
    let mut blocked = false;
    for kind in kinds.into_iter().take(if is_plane { 2 } else { 3 }) {
        let mut length = seconds;
        for _ in 0..LENGTHS {
            let descent = Descent::new(scene, start, length, kind);
            match descent.end_below(ceiling, step) {
                Found::End(end, energy) => return Some((end, energy)),
                Found::Nothing { touching } => blocked |= touching > 0,
                Found::NoMotion => break,
            }
            length *= R::from_f64(1.0 / 16.0);
        }
    }
    let stopped = energy_limit::stopped(start);
    if blocked && stopped != *start {
        let energy = Energy::of(scene, &stopped);
        return (energy.total() <= ceiling).then_some((stopped, energy));
    }
    None
}

/// A step whose free motion goes beyond so many sizes of the body may be refused. Rounding hides
/// the body long before, from 4.5e15 sizes on in f64 and 1e7 in f32. Up to here such steps still
/// end where the energy is lower, as `tests/extremes.rs` shows.
const FARTHEST: f64 = 1e25;

/// Whether free motion for so long goes so far that rounding hides where it ends.
#[cold]
pub(super) fn is_unresolved<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
) -> bool {
    let bounding_radius = scene.bounding_radius();
    let size = if bounding_radius > R::ZERO {
        bounding_radius
    } else {
        R::ONE
    };
    let shift = free_shift(scene, start, seconds).length();
    let is_resolved = shift <= size * R::from_f64(FARTHEST);
    // What overflows is not resolved.
    !is_resolved
}

/// Whether a search downhill has left a body in mid-air that free motion would have taken so far
/// that rounding is more than it has moved.
#[cold]
pub(super) fn is_left_in_the_air<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    seconds: R,
) -> bool {
    let shift = free_shift(scene, start, seconds).length();
    let moved = (end.position - start.position).length();
    shift > scene.bounding_radius()
        && moved < shift * R::EPSILON
        && Energy::with_touching(scene, end).1 == 0
}

/// How far a body shifts that nothing turns aside, by an Euler step, m.
fn free_shift<R: Real, D: Dynamics<R>>(scene: &D, start: &State<R>, seconds: R) -> R::Vec3 {
    (start.linear_velocity + scene.gravity() * seconds) * seconds
}

/// How a search finds its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Along the forces.
    ByNormals,
    /// As it is turned: the rounding of a turn may be worth more energy than a small shift is.
    WithoutTurn,
    /// Along the slope of the springs' energy. Off the surface of a curved ground the normal need
    /// not be the gap's gradient.
    ByDifferences,
}

/// What the search over one length has found.
enum Found<R: Real> {
    End(State<R>, Energy<R>),
    /// Every end is too high; so many contacts touched at the last.
    Nothing {
        touching: usize,
    },
    /// The motion is less than numbers can hold.
    NoMotion,
}

/// The search for backward Euler's motion over one length of time.
struct Descent<'a, R: Real, D> {
    scene: &'a D,
    start: &'a State<R>,
    seconds: R,
    mass: R,
    inertia: Block<R>,
    bounding_radius: R,
    /// The motion that nothing turns aside: `h v + h² g` and `h ω`.
    free: Way<R>,
    kind: Kind,
}

/// A shift (m) and a turn (rad), world axes.
#[derive(Clone, Copy, Debug)]
struct Way<R: Real> {
    shift: R::Vec3,
    turn: R::Vec3,
}

impl<'a, R: Real, D: Dynamics<R>> Descent<'a, R, D> {
    fn new(scene: &'a D, start: &'a State<R>, seconds: R, kind: Kind) -> Self {
        let properties = scene.inertia_properties();
        let motion = motion_of(scene, start);
        let ([x, y, z], _) = properties.inertia_for_solving(&motion.axes, start.angular_momentum);
        let bounding_radius = scene.bounding_radius();
        Self {
            scene,
            start,
            seconds,
            mass: properties.mass(),
            inertia: Block { x, y, z },
            bounding_radius: if bounding_radius > R::ZERO {
                bounding_radius
            } else {
                R::ONE
            },
            free: Way {
                shift: free_shift(scene, start, seconds),
                turn: motion.angular_velocity * seconds,
            },
            kind,
        }
    }

    /// The first end on Newton's way to the lowest Φ whose energy is at most the ceiling.
    fn end_below(&self, ceiling: R, step: &mut Step<R>) -> Found<R> {
        let mut end = *self.start;
        let mut way = Way {
            shift: R::Vec3::ZERO,
            turn: R::Vec3::ZERO,
        };
        let mut touching = 0;
        for iteration in 0..NEWTON {
            step.evaluations += 1;
            let (shift, turn) = self.newton(&end, &way);
            way = Way {
                shift: way.shift + shift,
                turn: way.turn + turn,
            };
            end = self.end_of(
                &way,
                Rotation::from_rotation_vector(turn).after(end.rotation()),
            );
            if end.position == self.start.position && end.orientation == self.start.orientation {
                return if iteration == 0 {
                    Found::NoMotion
                } else {
                    Found::Nothing { touching }
                };
            }
            if end.not_finite().is_some() {
                break;
            }
            let (energy, now_touching) = Energy::with_touching(self.scene, &end);
            touching = now_touching;
            if let Some((end, energy)) = energy_limit::lowered(self.scene, ceiling, &end, energy) {
                return Found::End(end, energy);
            }
        }
        Found::Nothing { touching }
    }

    /// The state at the end of a way, turned so.
    fn end_of(&self, way: &Way<R>, rotation: Rotation<R>) -> State<R> {
        let per_second = R::ONE / self.seconds;
        let rotation = rotation.normalised();
        State {
            position: self.start.position + way.shift,
            linear_velocity: way.shift * per_second,
            orientation: rotation.to_quat(),
            angular_momentum: (self.scene.inertia_properties())
                .without_dead_spin(rotation, self.inertia.times(way.turn * per_second)),
        }
    }

    /// Newton's step from the end of a way, with everything times h²:
    /// `(M + h² K + h C) Δz = M (z₀ - z) + h² f - h C z`.
    fn newton(&self, end: &State<R>, way: &Way<R>) -> (R::Vec3, R::Vec3) {
        let h = self.seconds;
        let mut equations = SixBySix::of_body(self.mass, &self.inertia);
        let mut force = (self.free.shift - way.shift) * self.mass;
        let mut torque = self.inertia.times(self.free.turn - way.turn);
        let motion = motion_of(self.scene, end);
        visit_contacts(self.scene, &motion, &mut |contact| {
            let (ground, friction) = (self.scene.ground(), self.scene.friction());
            let mean = ground.mean_force(contact.depth, contact.depth, h);
            // The contact's depth falls as its centre moves along this.
            let (slope, centre) = self.slope(contact);
            let weight = contact.weight;
            let springs = slope * (mean.force * h * h * weight);
            force += springs;
            torque += centre.cross(springs);
            // The force over an even path answers to its end by half of the springs' stiffness.
            let stiffness = mean.stiffness * R::TWO * h * h * weight;
            equations.add_at(&Block::outer(slope * stiffness, slope), centre, centre);

            let n = contact.normal;
            let along = friction.jacobian(mean.force, contact.slip).coefficient * (h * weight);
            let across = n * (mean.damping * h * weight - along);
            let resistance = Block::diagonal(along).plus(&Block::outer(across, n));
            let resisted = resistance.times(way.shift + way.turn.cross(contact.arm));
            force += -resisted;
            torque += -contact.arm.cross(resisted);
            equations.add_at(&resistance, contact.arm, contact.arm);
        });
        if self.kind == Kind::WithoutTurn {
            equations = equations.uncoupled();
            torque = R::Vec3::ZERO;
        }
        equations.solve(force, torque, self.bounding_radius)
    }

    /// The gradient of the gap at a contact's centre, and where that centre is, from the centre of
    /// mass.
    fn slope(&self, contact: &Contact<R>) -> (R::Vec3, R::Vec3) {
        let centre = contact.arm + contact.normal * contact.point.radius;
        if self.kind != Kind::ByDifferences {
            return (contact.normal, centre);
        }
        let place = self.start.position + centre;
        let nudge = R::EPSILON.sqrt() * (self.bounding_radius + place.length() * R::EPSILON.sqrt());
        let gap = |x: R, y: R, z: R| {
            self.scene
                .ground()
                .surface(place + R::Vec3::new(x, y, z))
                .gap
        };
        let o = R::ZERO;
        let difference = R::Vec3::new(
            gap(nudge, o, o) - gap(-nudge, o, o),
            gap(o, nudge, o) - gap(o, -nudge, o),
            gap(o, o, nudge) - gap(o, o, -nudge),
        );
        (difference * (R::HALF / nudge), centre)
    }
}
