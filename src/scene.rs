//! Body, ground, friction, gravity and applied force together, checked once.

mod diagnosed;
mod force_derivatives;
mod inspected;
mod limited;
mod on_surface;
#[cfg(feature = "serde")]
mod saved;
mod screened;
mod torque_free;

pub(crate) use diagnosed::{DiagnosedScene, Record};
pub(crate) use force_derivatives::ForceDerivatives;
pub(crate) use limited::{FrictionLimit, LimitedScene, Stiffest};
pub(crate) use on_surface::OnSurface;
pub(crate) use screened::{Alarm, ScreenedScene};
pub(crate) use torque_free::TorqueFree;

use crate::body::{InertiaProperties, RigidPointBody};
use crate::contact::{Contact, ContactModel, Extent, Load, LoopOverLanes, Motion};
use crate::error::{self, Rule, SceneError};
use crate::force::{Force, NoForce};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::{Axes, Rotation};
use crate::state::State;

/// Body on a ground under gravity and an applied force, as an integrator uses it.
///
/// *For authors of integrators:* [`motion`](Self::motion) converts a state into the quantities on
/// which forces depend. [`load`](Self::load) returns the force and torque of all contacts and of
/// the applied force there, and [`visit_contacts`](Self::visit_contacts) visits each contact.
/// Gravity is separate, because it needs no contact. The [`ContactModel`] has the functions for a
/// method that keeps the contact range of its last evaluation.
pub trait Dynamics<R: Real = f64> {
    /// Type of the body.
    type Body: RigidPointBody<R>;
    /// Type of the ground.
    type Ground: SpringDamperGround<R>;
    /// Type of the friction law.
    type Friction: SlidingFriction<R>;
    /// Type of the applied force.
    type Force: Force<R>;
    /// Type of the same scene without a test of the values that its laws return. A scene without
    /// such tests names itself.
    type Untested: Dynamics<R>;

    /// Body, ground and friction law, with the functions of contact.
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R>;
    /// Acceleration by gravity and by the [constant part](Force::constant_force) of the applied
    /// force, m/s², world axes.
    fn gravity(&self) -> R::Vec3;
    /// Applied force, in addition to gravity and contacts.
    fn force(&self) -> &Self::Force;
    /// Mass and inertia of the body.
    fn inertia_properties(&self) -> &InertiaProperties<R>;

    /// Body.
    #[inline(always)]
    fn body(&self) -> &Self::Body {
        self.contact_model().body()
    }
    /// Ground.
    #[inline(always)]
    fn ground(&self) -> &Self::Ground {
        self.contact_model().ground()
    }
    /// Friction law.
    #[inline(always)]
    fn friction(&self) -> &Self::Friction {
        self.contact_model().friction()
    }
    /// Distance from the centre of mass to the farthest point of the body's surface, m.
    #[inline(always)]
    fn bounding_radius(&self) -> R {
        self.contact_model().extent().bounding_radius
    }

    /// Evaluates laws at a point that the motion does not pass. A value that breaks a contract
    /// there is not an error of the step.
    #[doc(hidden)]
    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        evaluate()
    }

    /// Evaluates the laws in a loop over lanes.
    #[doc(hidden)]
    #[inline(always)]
    fn evaluate_in_lanes(&self, work: impl LoopOverLanes<R>) {
        work.run((self.ground(), self.friction()));
    }

    /// Returns the same scene without a test of the values that its laws return. A scene without
    /// such tests returns itself.
    ///
    /// *For authors of integrators:* a method with several stages may take it for all stages but
    /// one. A force that is not a number still shows in the state.
    fn untested(&self) -> &Self::Untested;

    /// Pose and velocities of the body in a state.
    #[inline(always)]
    fn motion(&self, state: &State<R>) -> Motion<R> {
        self.motion_along(state, state.rotation().axes())
    }

    /// Pose and velocities of the body in a state whose `axes` the integrator has already computed.
    #[inline(always)]
    fn motion_along(&self, state: &State<R>, axes: Axes<R>) -> Motion<R> {
        Motion {
            position: state.position,
            axes,
            linear_velocity: state.linear_velocity,
            angular_velocity: self
                .inertia_properties()
                .angular_velocity(&axes, state.angular_momentum),
        }
    }

    /// Calls `visit` with each contact that touches, in the order of the contact range.
    #[inline(always)]
    fn visit_contacts(&self, motion: &Motion<R>, visit: impl FnMut(&Contact<R>)) {
        self.contact_model().visit(motion, visit);
    }

    /// Force and torque of all contacts and of the applied force, without gravity.
    #[inline(always)]
    fn load(&self, motion: &Motion<R>) -> Load<R> {
        self.with_applied_force(self.contact_model().load(motion), motion)
    }

    /// Load of the contacts together with the applied force. Its constant part belongs to
    /// [`gravity`](Self::gravity). A scene without an applied force costs nothing.
    #[inline(always)]
    fn with_applied_force(&self, contacts: Load<R>, motion: &Motion<R>) -> Load<R> {
        if !self.force().acts() {
            return contacts;
        }
        let applied = self.force().wrench(motion);
        Load {
            force: contacts.force + applied.force,
            torque: contacts.torque + applied.torque,
            ..contacts
        }
    }
}

/// Length that converts an angle into a displacement, m: the larger of the bounding radius and the
/// radius of gyration `√(largest moment/mass)`.
///
/// A body without contacts has no bounding radius of its own, but it has mass at the radius of
/// gyration or beyond.
#[inline]
pub(crate) fn size<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> R {
    scene
        .bounding_radius()
        .at_least(scene.inertia_properties().radius_of_gyration())
}

/// Returns the largest velocity of the farthest point of the body per impulse at any contact, 1/kg.
#[inline]
pub(crate) fn mobility<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> R {
    let (properties, arm) = (scene.inertia_properties(), size(scene));
    properties.inverse_mass() + properties.largest_inverse_moment() * (arm * arm)
}

/// Returns the orientation after `seconds` without torque, from `rotation` with these `axes`, as
/// [`InertiaProperties::turn_freely`]. Without the code for three different moments, if the type of
/// the body excludes them.
#[inline(always)]
pub(crate) fn turned_freely<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rotation: Rotation<R>,
    axes: &Axes<R>,
    angular_momentum: R::Vec3,
    seconds: R,
) -> Rotation<R> {
    let inertia = scene.inertia_properties();
    if scene.body().is_symmetric() {
        let turned = inertia.turn_symmetric(rotation, axes, angular_momentum, seconds);
        turned.normalised()
    } else {
        inertia.turn_freely(rotation, axes, angular_momentum, seconds)
    }
}

/// Returns true if the applied force or the motion of the ground can do work on the body.
#[inline]
pub(crate) fn is_driven<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> bool {
    let is_pushed = scene.force().acts() && !scene.force().is_passive();
    is_pushed || scene.ground().motion().is_some()
}

/// Returns true if all three moments of the body differ.
#[inline(always)]
pub(crate) fn is_asymmetric<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> bool {
    !scene.body().is_symmetric() && scene.inertia_properties().is_asymmetric()
}

/// Returns true if torque-free rotation amplifies the error of steps that add quaternions.
///
/// It does next to the middle one of three different moments. It also does where the moment about
/// the axis of symmetry is the smallest: a wrong axis has a wrong spin, by `L δ/I₃`, and the stages
/// of the next step rotate about it.
#[inline(always)]
pub(crate) fn amplifies_errors<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> bool {
    is_asymmetric(scene) || scene.inertia_properties().is_prolate()
}

/// Rates of change of a state, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<R: Real = f64> {
    /// Acceleration of the centre of mass, m/s².
    pub acceleration: R::Vec3,
    /// Torque about the centre of mass, N m: the rate of the angular momentum.
    pub torque: R::Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> Rates<R> {
    /// Rates for a motion of a scene under a load and gravity. [`Dynamics::load`] contains the
    /// contacts and the applied force.
    #[inline]
    #[must_use]
    pub fn under(load: &Load<R>, scene: &impl Dynamics<R>, motion: &Motion<R>) -> Self {
        Self {
            acceleration: load.force * scene.inertia_properties().inverse_mass() + scene.gravity(),
            torque: load.torque,
            angular_velocity: motion.angular_velocity,
        }
    }
}

/// Body, ground, friction, gravity and applied force, checked, with the computed mass properties of
/// the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene<B, G, F, A, R: Real = f64, E = NoForce> {
    body: B,
    ground: G,
    friction: F,
    gravity: A,
    force: E,
    inertia_properties: InertiaProperties<R>,
    // The extent of the body's surface. The `Debug` text of a scene is part of the hash that
    // identifies the results of an ensemble, so the two numbers are fields of the scene.
    bounding_radius: R,
    has_radii: bool,
}

impl<R, B, G, F, A> Scene<B, G, F, A, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
{
    /// Composes a scene without an applied force. [`with_force`](Self::with_force) adds one.
    ///
    /// # Errors
    /// Returns [`SceneError`] if body, ground, friction or gravity is invalid, or if the weight,
    /// the bounding radius, or the inverse of the mass or of a moment of inertia overflows. The
    /// error names the quantity, the rule and the value.
    pub fn new(body: B, ground: G, friction: F, gravity: A) -> Result<Self, SceneError> {
        let inertia_properties = crate::body::check_whole(&body)?;
        ground.check()?;
        if let Some(motion) = ground.motion() {
            motion.check()?;
        }
        friction.check()?;
        gravity.check()?;
        let Extent {
            bounding_radius,
            has_radii,
        } = ContactModel::new(&body, &ground, &friction).extent();
        let weight = inertia_properties.mass() * gravity.acceleration().length();
        error::finite("weight (mass times gravity)", weight, " N")?;
        check_numbers_of_surfaces(&ground, &friction)?;
        ground.bounds().check()?;
        Ok(Self {
            inertia_properties,
            bounding_radius,
            has_radii,
            body,
            ground,
            friction,
            gravity,
            force: NoForce,
        })
    }
}

/// Checks that there is one friction law for all surfaces, or one for each.
fn check_numbers_of_surfaces<R: Real>(
    ground: &impl SpringDamperGround<R>,
    friction: &impl SlidingFriction<R>,
) -> Result<(), SceneError> {
    let count = ground.surfaces().unwrap_or(1);
    match friction.surfaces() {
        Some(laws) if laws != count => Err(SceneError::new(
            "number of friction laws",
            Rule::Exactly(count),
            laws as f64,
            "",
        )),
        _ => Ok(()),
    }
}

impl<R, B, G, F, A, E> Scene<B, G, F, A, R, E>
where
    R: Real,
    A: Gravity<R>,
{
    /// Replaces the applied force.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter of the force is invalid, or if the acceleration by its
    /// constant part overflows. The error names the quantity, the rule and the value.
    pub fn with_force<E2: Force<R>>(
        self,
        force: E2,
    ) -> Result<Scene<B, G, F, A, R, E2>, SceneError> {
        force.check()?;
        let scene = Scene {
            body: self.body,
            ground: self.ground,
            friction: self.friction,
            gravity: self.gravity,
            force,
            inertia_properties: self.inertia_properties,
            bounding_radius: self.bounding_radius,
            has_radii: self.has_radii,
        };
        let weight = scene.acceleration().length() * scene.inertia_properties.mass();
        error::finite("weight and constant force", weight, " N")?;
        Ok(scene)
    }
}

impl<R, B, G, F, A, E> Scene<B, G, F, A, R, E>
where
    R: Real,
    A: Gravity<R>,
    E: Force<R>,
{
    /// Acceleration by gravity and by the constant part of the applied force, m/s².
    #[inline(always)]
    fn acceleration(&self) -> R::Vec3 {
        let gravity = self.gravity.acceleration();
        match self.force.constant_force() {
            Some(force) => gravity + force * self.inertia_properties.inverse_mass(),
            None => gravity,
        }
    }
}

impl<R: Real, B, G, F, A, E> Scene<B, G, F, A, R, E> {
    /// Returns the five parts.
    pub(crate) fn into_parts(self) -> (B, G, F, A, E) {
        (
            self.body,
            self.ground,
            self.friction,
            self.gravity,
            self.force,
        )
    }
}

impl<R, B, G, F, A, E> Scene<B, G, F, A, R, E>
where
    R: Real,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    E: Force<R>,
{
    /// Returns true if a step need not check the values that the laws return.
    #[inline(always)]
    pub(crate) fn is_trusted(&self) -> bool {
        self.ground.is_trusted() && self.friction.is_trusted() && self.force.is_trusted()
    }
}

impl<R, B, G, F, A, E> Dynamics<R> for Scene<B, G, F, A, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    E: Force<R>,
{
    type Body = B;
    type Ground = G;
    type Friction = F;
    type Force = E;
    type Untested = Self;

    #[inline(always)]
    fn untested(&self) -> &Self {
        self
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, B, G, F, R> {
        let extent = Extent {
            bounding_radius: self.bounding_radius,
            has_radii: self.has_radii,
        };
        ContactModel::composed(&self.body, &self.ground, &self.friction, extent)
    }
    #[inline]
    fn gravity(&self) -> R::Vec3 {
        self.acceleration()
    }
    #[inline(always)]
    fn force(&self) -> &E {
        &self.force
    }
    #[inline]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        &self.inertia_properties
    }
}
