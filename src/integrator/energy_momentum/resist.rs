//! Impulses that only ever take energy: friction and dampers acting on a body whose place stands still.
//!
//! ```text
//! (M + Σ Jᵢᵀ kᵢ Jᵢ) y' = M y        y = (v, ω),   kᵢ >= 0
//! ```
//!
//! Each contact answers its new velocity `uᵢ' = Jᵢ y'` with the impulse `-kᵢ uᵢ'`: backward Euler, all contacts at once. Whatever the resistances `kᵢ >= 0` are, the kinetic energy falls:
//! with `K = Σ Jᵢᵀ kᵢ Jᵢ` it is `yᵀ M y - y'ᵀ M y' = 2 y'ᵀ K y' + (K y')ᵀ M⁻¹ (K y') >= 0`. So they may be fitted to limits of the impulses in a few passes, and the order of the contacts
//! does not matter.

use super::linear::{Block, SixBySix};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Motion};
use crate::state::State;

/// Passes that fit the resistances to their limits. Each keeps the energy from rising; more of them only share an impulse better.
const PASSES: u32 = 4;

/// A contact that resists, with the largest impulses that it may give.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resisting<R: Real> {
    /// From the centre of mass to where the impulse acts, m, world axes.
    pub(super) place: R::Vec3,
    /// Normal of the ground, unit vector.
    pub(super) normal: R::Vec3,
    /// Along the ground, N s.
    pub(super) along: R,
    /// Along the normal, N s.
    pub(super) across: R,
}

/// The state after the contacts that `visit` hands on have resisted its velocities. `visit` is called once a pass with the motion before.
pub(super) fn resisted<R: Real, D: Dynamics<R>>(
    scene: &D,
    reach: R,
    state: &State<R>,
    mut visit: impl FnMut(&Motion<R>, &mut dyn FnMut(&Resisting<R>)),
) -> State<R> {
    let motion = scene.motion(state);
    let mut known = motion;
    let mut settled = *state;
    for _ in 0..PASSES {
        let mut sum = Resistance::of_body(scene, &motion, state.angular_momentum);
        visit(&motion, &mut |contact| sum.add(contact, &motion, &known));
        if !sum.active {
            break;
        }
        let mut next = sum.apply(state, reach);
        next.angular_momentum = scene
            .mass_properties()
            .without_dead_spin(state.rotation(), next.angular_momentum);
        if next.not_finite().is_some() {
            break;
        }
        settled = next;
        known = scene.motion(&settled);
    }
    settled
}

/// The equations of a pass.
struct Resistance<R: Real> {
    equations: SixBySix<R>,
    inertia: Block<R>,
    impulse: R::Vec3,
    turning: R::Vec3,
    active: bool,
}

impl<R: Real> Resistance<R> {
    fn of_body<D: Dynamics<R>>(scene: &D, motion: &Motion<R>, angular_momentum: R::Vec3) -> Self {
        let properties = scene.mass_properties();
        let ([x, y, z], _) = properties.inertia_for_solving(&motion.axes, angular_momentum);
        let inertia = Block { x, y, z };
        Self {
            equations: SixBySix::of_body(properties.mass(), &inertia),
            inertia,
            impulse: R::Vec3::ZERO,
            turning: R::Vec3::ZERO,
            active: false,
        }
    }

    fn add(&mut self, contact: &Resisting<R>, motion: &Motion<R>, known: &Motion<R>) {
        let (place, n) = (contact.place, contact.normal);
        let (before, after) = (motion.velocity_at(place), known.velocity_at(place));
        let (closing, closing_after) = (before.dot(n), after.dot(n));
        let along = resistance(
            contact.along,
            (before - n * closing).length(),
            (after - n * closing_after).length(),
        );
        let across = resistance(contact.across, closing.abs(), closing_after.abs());
        if along <= R::ZERO && across <= R::ZERO {
            return;
        }
        self.active = true;
        let block = Block::diagonal(along).plus(&Block::outer(n * (across - along), n));
        let resisted = block.times(before);
        self.impulse += resisted;
        self.turning += place.cross(resisted);
        self.equations.add_at(&block, place, place);
    }

    /// Solved for the change of the velocities, so that what no contact resists stays as it is to the last place.
    fn apply(&self, state: &State<R>, reach: R) -> State<R> {
        let (change, turn) = self.equations.solve(-self.impulse, -self.turning, reach);
        State {
            linear_velocity: state.linear_velocity + change,
            angular_momentum: state.angular_momentum + self.inertia.times(turn),
            ..*state
        }
    }
}

/// Resistance (kg) whose impulse at the speed `after` is `limit`; 0 where nothing moves or nothing may be given.
fn resistance<R: Real>(limit: R, before: R, after: R) -> R {
    if limit > R::ZERO && before > R::ZERO {
        // One that has stopped the contact keeps what holds it to a millionth of its speed.
        limit / after.at_least(before * R::from_f64(1e-6))
    } else {
        R::ZERO
    }
}
