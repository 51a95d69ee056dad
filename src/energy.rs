//! Energy by kind, and the rate at which contacts take it away.

use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Energy of a body on its ground, by kind, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Energy<R = f64> {
    /// `m v²/2`.
    pub translation: R,
    /// `L · ω/2`.
    pub rotation: R,
    /// `-m g · x`: 0 with the centre of mass at the origin.
    pub gravity: R,
    /// In the springs under every contact below the ground, also under one whose force the clamp cuts to 0.
    pub springs: R,
}

impl<R: Real> Energy<R> {
    /// The energy of a state of a scene.
    #[inline]
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        Self::with_touching(scene, state).0
    }

    /// The energy of a state of a scene, and how many contacts touch.
    #[inline]
    pub(crate) fn with_touching(scene: &impl Dynamics<R>, state: &State<R>) -> (Self, usize) {
        let motion = scene.motion(state);
        let mass = scene.mass_properties().mass();
        let (mut springs, mut touching) = (R::ZERO, 0);
        scene.visit_contacts(&motion, |contact| {
            springs += scene.ground().spring_energy(contact.depth);
            touching += 1;
        });
        let energy = Self {
            translation: mass * state.linear_velocity.length_squared() * R::HALF,
            rotation: state.angular_momentum.dot(motion.angular_velocity) * R::HALF,
            gravity: -(mass * scene.gravity().dot(state.position)),
            springs,
        };
        (energy, touching)
    }

    /// The sum of all kinds.
    #[inline]
    #[must_use]
    pub fn total(&self) -> R {
        self.translation + self.rotation + self.gravity + self.springs
    }
}

/// Power of the contacts on the body beyond what the springs store, by cause, W. Each is at most 0 for a ground and a friction that keep their contracts.
///
/// The energy falls at their sum: `dE/dt = friction + damper + clamp`. With `N` the normal force, `S` the spring's share of it, and `c` the closing speed, a
/// contact gives `force · slip` to friction, and `(S - N) c` to the damper; where the clamp has cut the whole force (`N = 0`), `S c` goes to the clamp instead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dissipation<R = f64> {
    /// Of friction.
    pub friction: R,
    /// Of the dampers.
    pub damper: R,
    /// Of the clamp: springs that expand under a contact which leaves faster than they do.
    pub clamp: R,
}

impl<R: Real> Dissipation<R> {
    /// The power at a state of a scene, W.
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        let (ground, friction) = (scene.ground(), scene.friction());
        let mut power = Self::default();
        scene.visit_contacts(&scene.motion(state), |contact| {
            let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
            let spring_force = ground.spring_force(contact.depth);
            let lost = (spring_force - normal_force) * contact.closing_speed;
            if normal_force > R::ZERO {
                power.damper += lost;
                power.friction += friction.force(normal_force, contact.slip).dot(contact.slip);
            } else {
                power.clamp += lost;
            }
        });
        power
    }

    /// The sum of all causes.
    #[inline]
    #[must_use]
    pub fn total(&self) -> R {
        self.friction + self.damper + self.clamp
    }

    /// Each cause's `self + other * factor`.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self, factor: R) -> Self {
        Self {
            friction: self.friction + other.friction * factor,
            damper: self.damper + other.damper * factor,
            clamp: self.clamp + other.clamp * factor,
        }
    }
}
