//! Last fallback: a step downhill, which always exists.
//!
//! Without contacts, a body would shift by `h v + h² g` and rotate by `h ω` in the time h. The
//! motion `z` of backward Euler (a shift and a rotation) differs from that motion, `z₀`, because of
//! the potential `U` of gravity and springs. With the mass matrix `M`, it minimises
//!
//! ```text
//! Φ(z) = (z - h y)ᵀ M (z - h y)/(2 h²) + U(z)          y = (v, ω)
//! ```
//!
//! `Φ(0)` is the energy of the start. Wherever Φ is lower than that, `U` is lower too. The body may
//! then be there with a velocity along `z`, scaled as the energy allows.
//!
//! Springs far stiffer than `m/h²` deflect the motion along the ground. An explicit method would
//! throw the body out of the ground. Dampers and friction only add to the resistance.
//!
//! For a body without velocity, the forces at the start bound what the search can gain. Let `f` be
//! the force of gravity and springs there, and `z₁ = h² M⁻¹ f` the motion that it would cause
//! alone. Springs push back more on the way, so that `U(0) - U(z) <= f·z`. With `Φ(z) <= Φ(0)` it
//! follows that `zᵀ M z <= 2 h² f·z = 2 zᵀ M z₁`, so z is at most twice as long as `z₁` in the
//! metric of M. Therefore `U(0) - U(z) <= 4 T`, with the kinetic energy `T = z₁ᵀ M z₁/(2 h²)` of
//! that motion. Contacts that carry the weight leave T within rounding, and the search is left out.
//! On a ridge the bound on `U` does not hold, and a body that is balanced there stays.

use super::shared::{motion_of, visit_contacts};
use crate::contact::Contact;
use crate::energy::Energy;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::integrator::linear::SixBySix;
use crate::integrator::matrix3::Matrix3;
use crate::integrator::{Step, energy_limit};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;

/// Number of lengths that are tried, each a sixteenth of the one before: down to 2⁻¹²⁰ of the step.
const LENGTHS: u32 = 31;
/// Number of Newton steps on Φ for each length.
const NEWTON: u32 = 4;
/// Largest resistance of a contact along the ground or across it, in terms of the mass, over the
/// reciprocal of the precision. The part of a larger one in the other direction, which is 0, would
/// be computed on inclined ground with a rounding error above the mass. The body could then not
/// leave the ground, or not slide on it.
const STUCK: f64 = 1.0 / 1024.0;

/// Searches for a backward Euler motion over `seconds`, a sixteenth of them, and so on, from a
/// state with its energy to an end whose energy is at most `ceiling`. The rest of the time passes
/// without motion: such a step is stable, but not accurate. If the ground allows no such motion,
/// the body stops at its position.
///
/// Returns `None` if the body has stopped already, if its forces balance to within the energy that
/// the end must lose, or if it is not in contact and only rounding increases the energy.
pub(super) fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, energy): (&State<R>, &Energy<R>),
    ceiling: R,
    seconds: R,
    step: &mut Step<R>,
) -> Option<(State<R>, Energy<R>)> {
    let is_plane = scene.contact_model().plane().is_some();
    let kinds = [Kind::ByNormals, Kind::WithoutTurn, Kind::ByDifferences];
    if Descent::new(scene, (start, *energy), seconds, Kind::ByNormals).is_balanced(ceiling) {
        return None;
    }
    let mut blocked = false;
    for kind in kinds.into_iter().take(if is_plane { 2 } else { 3 }) {
        let mut length = seconds;
        for _ in 0..LENGTHS {
            let descent = Descent::new(scene, (start, *energy), length, kind);
            match descent.end_below(ceiling, step) {
                Found::End(end, energy) => return Some((end, energy)),
                Found::Nothing { touching } => blocked |= touching > 0,
                Found::NoMotion => {
                    blocked |= descent.is_held();
                    break;
                }
            }
            length *= R::from_f64(1.0 / 16.0);
        }
    }
    let (stopped, energy) = energy_limit::stopped((start, energy));
    if blocked && stopped != *start {
        return (energy.total() <= ceiling).then_some((stopped, energy));
    }
    None
}

/// A step may be rejected if its free motion exceeds this number of body sizes. Rounding hides the
/// body much earlier, from 4.5e15 sizes in f64 and 1e7 in f32. Up to this limit such steps still
/// end at a lower energy, as `tests/limits/extremes.rs` shows.
const FARTHEST: f64 = 1e25;

/// Returns true if the displacement of free motion in this time is so large that rounding hides its
/// end.
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
    // An overflow is not resolved.
    !is_resolved
}

/// Returns true if a downhill search has left a body in the air, although free motion would have
/// moved it much farther. The actual displacement is then below the rounding of the free one.
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

/// Displacement of the body without contacts, by an Euler step, m.
fn free_shift<R: Real, D: Dynamics<R>>(scene: &D, start: &State<R>, seconds: R) -> R::Vec3 {
    (start.linear_velocity + scene.gravity() * seconds) * seconds
}

/// Method by which a search determines its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Direction along the forces.
    ByNormals,
    /// Direction of a shift with constant orientation, because the rounding of a rotation may
    /// change the energy by more than a small shift does.
    WithoutTurn,
    /// Direction along the gradient of the spring energy. Away from the surface of a curved ground,
    /// the normal need not be the gradient of the gap.
    ByDifferences,
}

/// Result of the search over one length.
enum Found<R: Real> {
    End(State<R>, Energy<R>),
    /// Every end has too high an energy; `touching` is the number of contacts that touched at the
    /// last one.
    Nothing {
        touching: usize,
    },
    /// The motion is below the resolution of the numbers.
    NoMotion,
}

/// The search for the motion of backward Euler over one length of time.
struct Descent<'a, R: Real, D> {
    scene: &'a D,
    start: &'a State<R>,
    /// Energy at the start.
    energy: Energy<R>,
    seconds: R,
    mass: R,
    /// Largest resistance of a contact times h, kg.
    stuck: R,
    inertia: Matrix3<R>,
    bounding_radius: R,
    /// Motion without contacts: `h v + h² g` and `h ω`.
    free: Way<R>,
    kind: Kind,
}

/// A shift (m) and a rotation (rad), world axes.
#[derive(Clone, Copy, Debug)]
struct Way<R: Real> {
    shift: R::Vec3,
    turn: R::Vec3,
}

impl<R: Real> Way<R> {
    const NONE: Self = Self {
        shift: R::Vec3::ZERO,
        turn: R::Vec3::ZERO,
    };
}

/// Equations of a Newton step: the matrix, and the force (kg m) and torque (kg m²) times h².
struct Equations<R: Real> {
    matrix: SixBySix<R>,
    force: R::Vec3,
    torque: R::Vec3,
}

impl<'a, R: Real, D: Dynamics<R>> Descent<'a, R, D> {
    fn new(
        scene: &'a D,
        (start, energy): (&'a State<R>, Energy<R>),
        seconds: R,
        kind: Kind,
    ) -> Self {
        let properties = scene.inertia_properties();
        let motion = motion_of(scene, start);
        let ([x, y, z], _) = properties.inertia_for_solving(&motion.axes, start.angular_momentum);
        let bounding_radius = scene.bounding_radius();
        Self {
            scene,
            start,
            energy,
            seconds,
            mass: properties.mass(),
            stuck: properties.mass() * (R::from_f64(STUCK) / R::EPSILON),
            inertia: Matrix3 { x, y, z },
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

    /// Returns true if the kinetic energy that the forces at the start would give to the body shows
    /// that no motion ends at an energy of at most the ceiling.
    fn is_balanced(&self, ceiling: R) -> bool {
        let Equations { force, torque, .. } = self.equations(self.start, &Way::NONE);
        let properties = self.scene.inertia_properties();
        let axes = self.start.rotation().axes();
        let momentum = force * (R::ONE / self.seconds);
        let angular_momentum = torque * (R::ONE / self.seconds);
        let kinetic = momentum.length_squared() * (properties.inverse_mass() * R::HALF)
            + properties.rotational_energy(&axes, angular_momentum);
        kinetic * R::from_f64(4.0) < self.energy.total() - ceiling
    }

    /// Returns true if the body would move without its contacts, by more than the resolution of the
    /// numbers. If it does not move with them, they stop it.
    fn is_held(&self) -> bool {
        let rotation = Rotation::from_rotation_vector(self.free.turn).after(self.start.rotation());
        let free = self.end_of(&self.free, rotation);
        let moves =
            free.position != self.start.position || free.orientation != self.start.orientation;
        moves && self.energy.springs > R::ZERO
    }

    /// Returns the first end on Newton's path to the minimum of Φ whose energy is at most the
    /// ceiling.
    fn end_below(&self, ceiling: R, step: &mut Step<R>) -> Found<R> {
        let mut end = *self.start;
        let mut way = Way::NONE;
        let mut touching = 0;
        for iteration in 0..NEWTON {
            step.evaluations += 1;
            let Equations {
                matrix,
                force,
                torque,
            } = self.equations(&end, &way);
            let (shift, turn) = matrix.solve(force, torque, self.bounding_radius);
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
            if energy_limit::is_no_solution([&self.energy, &energy], R::ZERO) {
                continue;
            }
            if let Some((end, energy)) = energy_limit::lowered(self.scene, ceiling, &end, energy) {
                return Found::End(end, energy);
            }
        }
        Found::Nothing { touching }
    }

    /// State at the end of a displacement, with this rotation.
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

    /// Equations of the Newton step from the end of a displacement, with all terms multiplied by
    /// h²: `(M + h² K + h C) Δz = M (z₀ - z) + h² f - h C z`.
    #[inline(never)]
    fn equations(&self, end: &State<R>, way: &Way<R>) -> Equations<R> {
        let h = self.seconds;
        let mut matrix = SixBySix::of_body(self.mass, &self.inertia);
        let mut force = (self.free.shift - way.shift) * self.mass;
        let mut torque = self.inertia.times(self.free.turn - way.turn);
        let motion = motion_of(self.scene, end);
        visit_contacts(self.scene, &motion, &mut |contact| {
            let (ground, friction) = contact.laws(self.scene.ground(), self.scene.friction());
            let mean = ground.mean_force(contact.depth, contact.depth, h);
            // The depth of the contact decreases as its centre moves along this direction.
            let (slope, centre) = self.slope(contact);
            let weight = contact.weight;
            let springs = slope * (mean.force * h * h * weight);
            force += springs;
            torque += centre.cross(springs);
            // The force over a uniform path depends on the end of the path by half of the spring
            // stiffness.
            let stiffness = mean.stiffness * R::TWO * h * h * weight;
            matrix.add_at(&Matrix3::outer(slope * stiffness, slope), centre, centre);

            let n = contact.normal;
            let along = friction
                .jacobian_at(contact.position, mean.force, contact.slip_velocity)
                .coefficient
                * (h * weight);
            let along = along.at_most(self.stuck);
            let across = (mean.damping * h * weight).at_most(self.stuck);
            let across = n * (across - along);
            let resistance = Matrix3::diagonal(along).plus(&Matrix3::outer(across, n));
            let resisted = resistance.times(way.shift + way.turn.cross(contact.arm));
            force += -resisted;
            torque += -contact.arm.cross(resisted);
            matrix.add_at(&resistance, contact.arm, contact.arm);
        });
        if self.kind == Kind::WithoutTurn {
            matrix = matrix.uncoupled();
            torque = R::Vec3::ZERO;
        }
        Equations {
            matrix,
            force,
            torque,
        }
    }

    /// Gradient of the gap at the centre of a contact, and the position of that centre relative to
    /// the centre of mass.
    fn slope(&self, contact: &Contact<R>) -> (R::Vec3, R::Vec3) {
        let centre = contact.arm + contact.normal * contact.point.radius;
        if self.kind != Kind::ByDifferences {
            return (contact.normal, centre);
        }
        let place = contact.position + contact.normal * contact.point.radius;
        let nudge = R::EPSILON.sqrt() * (self.bounding_radius + place.length() * R::EPSILON.sqrt());
        let (ground, _) = contact.laws(self.scene.ground(), self.scene.friction());
        let gap = |x: R, y: R, z: R| ground.surface(place + R::Vec3::new(x, y, z)).gap;
        let o = R::ZERO;
        let difference = R::Vec3::new(
            gap(nudge, o, o) - gap(-nudge, o, o),
            gap(o, nudge, o) - gap(o, -nudge, o),
            gap(o, o, nudge) - gap(o, o, -nudge),
        );
        (difference * (R::HALF / nudge), centre)
    }
}
