//! Energy by kind, and the power at which contacts and the applied force change it.

use crate::contact::{Contact, Load, Onset};
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Rates};
use crate::state::{Motion, State};

/// Energy of a body on its ground by kind, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Energy<R = f64> {
    /// Kinetic energy of translation, `m v²/2`.
    pub translation: R,
    /// Kinetic energy of rotation, `L · ω/2`; never negative.
    pub rotation: R,
    /// Potential energy of gravity and of a constant force, `-(m g + F) · x`. Zero with the centre
    /// of mass at the origin.
    pub gravity: R,
    /// Elastic energy of the springs under every contact below the surface of the ground. It
    /// includes contacts that separate so fast that the normal force is limited to 0.
    pub springs: R,
}

impl<R: Real> Energy<R> {
    /// Energy of a state of a scene.
    #[inline]
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        Self::with_touching(scene, state).0
    }

    /// Energy of a state of a scene, and the number of contacts that touch.
    #[inline]
    pub(crate) fn with_touching(scene: &impl Dynamics<R>, state: &State<R>) -> (Self, usize) {
        let motion = scene.motion(state);
        let (springs, touching) = scene.contact_model().spring_energy(&motion);
        (Self::moving(scene, state, &motion, springs), touching)
    }

    /// Energy of a state without that of the springs.
    #[inline]
    pub(crate) fn without_springs(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        Self::moving(scene, state, &scene.motion(state), R::ZERO)
    }

    /// Energy of a state with the given motion and spring energy.
    #[inline]
    fn moving(scene: &impl Dynamics<R>, state: &State<R>, motion: &Motion<R>, springs: R) -> Self {
        let mass = scene.inertia_properties().mass();
        Self {
            translation: mass * state.linear_velocity.length_squared() * R::HALF,
            rotation: scene
                .inertia_properties()
                .rotational_energy(&motion.axes, state.angular_momentum),
            gravity: -(mass * scene.gravity().dot(state.position)),
            springs,
        }
    }

    /// Sum of the energies of motion, `translation + rotation`.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{PointMass, State, Stepper};
    ///
    /// let stepper = Stepper::new(PointMass::new(2.0))?; // kg
    /// let state = State::default().with_linear_velocity(DVec3::X * 3.0); // m/s
    /// assert_eq!(stepper.energy(&state).kinetic(), 9.0); // J
    /// # Ok::<(), tumble::SceneError>(())
    /// ```
    #[inline]
    #[must_use]
    pub fn kinetic(&self) -> R {
        self.translation + self.rotation
    }

    /// Sum over all kinds.
    #[inline]
    #[must_use]
    pub fn total(&self) -> R {
        self.kinetic() + self.gravity + self.springs
    }
}

/// Formats the energy as one line with units. `{:.3}` sets the digits of each number.
///
/// ```
/// use tumble::{Coin, State, Stepper, UniformGravity, glam::DVec3};
///
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_gravity(UniformGravity::down(9.8))?;
/// let text = format!("{:.1}", stepper.energy(&State::at(DVec3::Z)));
/// assert_eq!(text, "9.8 J: translation 0.0 J, rotation 0.0 J, gravity 9.8 J, springs 0.0 J");
/// # Ok::<(), tumble::SceneError>(())
/// ```
impl<R: Real> core::fmt::Display for Energy<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(&self.total(), f)?;
        let kinds = [
            (" J: translation ", self.translation),
            (" J, rotation ", self.rotation),
            (" J, gravity ", self.gravity),
            (" J, springs ", self.springs),
        ];
        for (name, joules) in kinds {
            f.write_str(name)?;
            core::fmt::Display::fmt(&joules, f)?;
        }
        f.write_str(" J")
    }
}

/// Power by cause, W, of the contacts and of the applied force on the body. It excludes the power
/// that the springs store. Each term but the drive is at most 0 if the laws keep their contracts.
///
/// [`Ledger::work`](crate::Ledger::work) returns the time integrals in the same fields: works in J.
///
/// The energy changes at the rate of their sum:
/// `dE/dt = friction + damper + clamp + drag + drive`. Let `N` be the normal force, `S` its spring
/// part, and `c` the closing speed, which is positive while the depth increases. The *clamp* is the
/// rule that the ground never pulls: `N` is limited to at least 0. One contact contributes:
///
/// | term | power |
/// |---|---|
/// | friction | `force · slip`, plus `torque · ω` if the friction law has a torque |
/// | damper | `(S - N) c`; 0 if the clamp limits the force to 0 (`N = 0`) |
/// | clamp | `S c` if the clamp limits the force to 0 (`N = 0`); otherwise 0 |
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dissipation<R = f64> {
    /// Power of friction, W.
    pub friction: R,
    /// Power of the dampers, W.
    pub damper: R,
    /// Power that springs lose, W, where a contact separates faster than they expand: the normal
    /// force is then limited to 0.
    pub clamp: R,
    /// Power of the passive part of the applied force, W: air drag.
    pub drag: R,
    /// Power of the drives of the scene, W, of either sign: wind, and ground that moves.
    pub drive: R,
}

impl<R: Real> Dissipation<R> {
    /// Power at a state of a scene, W.
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        let motion = scene.motion(state);
        let mut power = Self::of_applied_force(scene, &motion);
        let turning = scene.contact_model().seen(&motion).angular_velocity;
        scene.visit_contacts(&motion, |contact| {
            power = power.plus(&force_and_power(scene, contact, turning).1, R::ONE);
        });
        if scene.ground().motion().is_some() {
            let load = scene.contact_model().load(&motion);
            power.drive += power_of_ground(scene, &motion, &load);
        }
        power
    }

    /// Power of the applied force alone, W.
    #[inline]
    fn of_applied_force(scene: &impl Dynamics<R>, motion: &Motion<R>) -> Self {
        if !scene.force().acts() {
            return Self::default();
        }
        let power = scene.force().power(motion);
        Self {
            drag: power.drag,
            drive: power.drive,
            ..Self::default()
        }
    }

    /// Sum over all causes.
    #[inline]
    #[must_use]
    pub fn total(&self) -> R {
        self.friction + self.damper + self.clamp + self.drag + self.drive
    }

    /// Returns `self + other * factor` for each cause.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self, factor: R) -> Self {
        Self {
            friction: self.friction + other.friction * factor,
            damper: self.damper + other.damper * factor,
            clamp: self.clamp + other.clamp * factor,
            drag: self.drag + other.drag * factor,
            drive: self.drive + other.drive * factor,
        }
    }
}

/// Power of a moving ground on a body, by the load of all contacts, W.
#[inline]
fn power_of_ground<R: Real>(scene: &impl Dynamics<R>, motion: &Motion<R>, load: &Load<R>) -> R {
    match scene.ground().motion() {
        Some(ground) => ground.power(motion.position, [load.force, load.torque]),
        None => R::ZERO,
    }
}

/// Force on the body at a contact, N, and its power excluding what the springs store, W.
#[inline]
fn force_and_power<R: Real>(
    scene: &impl Dynamics<R>,
    contact: &Contact<R>,
    angular_velocity: R::Vec3,
) -> (R::Vec3, Dissipation<R>) {
    let (ground, friction) = contact.laws(scene.ground(), scene.friction());
    let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
    let rub = friction.force_at(contact.position, normal_force, contact.slip_velocity);
    let friction = rub * contact.weight;
    let lost = (ground.spring_force(contact.depth) - normal_force) * contact.closing_speed;
    let (damper, clamp) = if normal_force > R::ZERO {
        (lost, R::ZERO)
    } else {
        (R::ZERO, lost)
    };
    let mut rubbed = friction.dot(contact.slip_velocity);
    if let Some(torque) = torque_on(scene, contact, angular_velocity) {
        rubbed += torque.dot(angular_velocity);
    }
    let power = Dissipation {
        friction: rubbed,
        damper: damper * contact.weight,
        clamp: clamp * contact.weight,
        ..Dissipation::default()
    };
    (
        contact.normal * (normal_force * contact.weight) + friction,
        power,
    )
}

/// Torque on the body at a contact, N m, in addition to that of the contact force. `None` if the
/// friction law does not resist rotation.
#[inline]
fn torque_on<R: Real>(
    scene: &impl Dynamics<R>,
    contact: &Contact<R>,
    angular_velocity: R::Vec3,
) -> Option<R::Vec3> {
    let (ground, friction) = (scene.ground(), scene.friction());
    friction.rolling_resistance(R::ZERO)?;
    Some(contact.turning_torque(ground, friction, angular_velocity))
}

/// Energy, dissipation and rates of a state, computed in one pass over its contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyRates<R: Real = f64> {
    /// Energy by kind, J.
    pub energy: Energy<R>,
    /// Power on the body by cause, W: negative where it dissipates.
    pub dissipation: Dissipation<R>,
    /// Rates of change of the state.
    pub rates: Rates<R>,
    /// Checksum of the contacts that touch and of those that push.
    pub(crate) contacts: u64,
}

impl<R: Real> EnergyRates<R> {
    /// Energy, dissipation and rates of a state of a scene.
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Self {
        let motion = scene.motion(state);
        let mut load = Load::default();
        let mut dissipation = Dissipation::of_applied_force(scene, &motion);
        let turning = scene.contact_model().seen(&motion).angular_velocity;
        let model = scene.contact_model();
        let (mut contacts, mut springs) = (0_u64, R::ZERO);
        model.visit_with_onsets(&motion, &mut |contact, onset| {
            let (force, power) = force_and_power(scene, contact, turning);
            // A contact that touches counts once. A contact that pushes counts a second time.
            let pushes = force.dot(contact.normal) > R::ZERO;
            if onset == Onset::Sudden {
                let identity = model.identity_of(contact);
                contacts = contacts.wrapping_add(identity << u32::from(pushes));
                let (ground, _) = contact.laws(scene.ground(), scene.friction());
                springs += ground.spring_energy(contact.depth);
            }
            load.add(contact, force);
            if let Some(torque) = torque_on(scene, contact, turning) {
                load.torque += torque;
            }
            dissipation = dissipation.plus(&power, R::ONE);
        });
        let (of_rims, _) = model.rims_energy(&motion);
        dissipation.drive += power_of_ground(scene, &motion, &load);
        let load = scene.with_applied_force(load, &motion);
        Self {
            energy: Energy::moving(scene, state, &motion, springs + of_rims),
            dissipation,
            rates: Rates::under(&load, scene, &motion),
            contacts,
        }
    }
}
