//! Parameters of a scene and of its start, and the scene that they describe.

use tumble::f64::Rotation;
use tumble::glam::DVec3;
use tumble::{
    Coulomb, FlatGround, RigidPointBody, Session, State, StepError, Stepper, Trial, UniformGravity,
};

use super::bodies::{Body, Exhibit};
use super::error::PageError;
use super::method::Method;

/// Scene of the page. The types of its parts are the same for all bodies and methods.
pub type PageStepper = Stepper<Body, FlatGround, Coulomb, UniformGravity, Method>;
/// A state of the page that is advanced.
pub type PageSession<'a> = Session<'a, Body, FlatGround, Coulomb, UniformGravity, Method>;

/// Advances a session by a step of the page.
///
/// For an adaptive integrator the session is new for each step, but at rest. So the size of its
/// first step does not depend on how a run is divided among calls.
///
/// # Errors
/// Returns [`StepError`] if a step fails.
pub fn take_step(session: &mut PageSession<'_>) -> Result<(), StepError> {
    let (stepper, before) = (session.stepper(), *session.state());
    let method = stepper.integrator();
    session.advance(method.time_step)?;
    if method.is_adaptive() && *session.state() != before {
        *session = stepper.session(*session.state());
    }
    Ok(())
}

/// Parameters of a scene and of its start, in the order of their block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Number of the body.
    pub body: f64,
    /// Number of the integrator.
    pub method: f64,
    /// Step size, s.
    pub step: f64,
    /// Stiffness of the ground for each contact, N/m.
    pub stiffness: f64,
    /// Damping of the ground for each contact, N s/m.
    pub damping: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Slip speed of the friction, m/s.
    pub slip_speed: f64,
    /// Gravity, m/s², down.
    pub gravity: f64,
    /// Number of the start: 0 spins, 1 rolls, 2 is dropped.
    pub start: f64,
    /// Angle from upright about world y, rad.
    pub lean: f64,
    /// Angular velocity at the start, rad/s.
    pub spin: f64,
}

impl Parameters {
    /// Count of the parameters.
    pub const COUNT: usize = 11;

    /// Ground, friction and gravity of the coin report, with steps of 1 ms by the default method.
    pub const REPORT: Self = Self {
        body: 0.0,
        method: 0.0,
        step: 1e-3,
        stiffness: Trial::<f64>::STIFFNESS,
        damping: Trial::<f64>::DAMPING,
        friction: 0.3,
        slip_speed: Coulomb::<f64>::REPORT_SLIP_SPEED,
        gravity: Trial::<f64>::GRAVITY,
        start: 0.0,
        lean: 0.0,
        spin: 0.0,
    };

    /// Parameters from numbers in the order of their block.
    #[must_use]
    pub fn from_numbers(numbers: [f64; Self::COUNT]) -> Self {
        let [
            body,
            method,
            step,
            stiffness,
            damping,
            friction,
            slip_speed,
            gravity,
            start,
            lean,
            spin,
        ] = numbers;
        Self {
            body,
            method,
            step,
            stiffness,
            damping,
            friction,
            slip_speed,
            gravity,
            start,
            lean,
            spin,
        }
    }

    /// Numbers in the order of their block.
    #[must_use]
    pub fn numbers(&self) -> [f64; Self::COUNT] {
        [
            self.body,
            self.method,
            self.step,
            self.stiffness,
            self.damping,
            self.friction,
            self.slip_speed,
            self.gravity,
            self.start,
            self.lean,
            self.spin,
        ]
    }

    /// Composes the scene with the method of the parameters.
    ///
    /// # Errors
    /// Returns [`PageError`] if a parameter is invalid.
    pub fn stepper(&self) -> Result<PageStepper, PageError> {
        let radius = Exhibit::from_number(self.body)?.body.bounding_radius();
        self.stepper_with(Method::from_number(self.method, self.step, radius)?)
    }

    /// Composes the scene with the library's default method.
    ///
    /// # Errors
    /// Returns [`PageError`] if a parameter is invalid.
    pub fn default_stepper(&self) -> Result<PageStepper, PageError> {
        self.stepper_with(Method::default_of(self.step))
    }

    fn stepper_with(&self, method: Method) -> Result<PageStepper, PageError> {
        let body = Exhibit::from_number(self.body)?.body;
        let friction = Coulomb {
            coefficient: self.friction,
            slip_speed: self.slip_speed,
        };
        Ok(Stepper::new(body)?
            .with_ground(FlatGround::level(self.stiffness, self.damping))?
            .with_friction(friction)?
            .with_gravity(UniformGravity::down(self.gravity))?
            .with_integrator(method)?)
    }

    /// Returns the state from which the body starts: with its lowest point on the ground, or higher
    /// by three bounding radii if it is dropped.
    ///
    /// # Errors
    /// Returns [`PageError`] if a parameter is invalid.
    pub fn start(&self) -> Result<State, PageError> {
        tumble::error::finite("lean at the start", self.lean, " rad")?;
        tumble::error::finite("spin at the start", self.spin, " rad/s")?;
        let stepper = self.default_stepper()?;
        let exhibit = Exhibit::from_number(self.body)?;
        let kind = "start";
        let (axis, drop) = match super::whole(self.start) {
            Some(0) => (exhibit.spin_axis, 0.0),
            Some(1) => (exhibit.roll_axis, 0.0),
            Some(2) => (exhibit.roll_axis, 3.0 * exhibit.body.bounding_radius()),
            _ => {
                return Err(PageError::Unknown {
                    kind,
                    value: self.start,
                });
            }
        };
        let raised = Rotation::from_rotation_vector(exhibit.upright);
        let rotation = Rotation::from_rotation_vector(DVec3::Y * self.lean).after(raised);
        let state = State::default().with_orientation(rotation.to_quat());
        let height = height_on_the_ground(&exhibit.body, &state) + drop;
        let state = State {
            position: DVec3::Z * height,
            ..state
        };
        Ok(stepper.with_angular_velocity(state, rotation.apply(axis) * self.spin))
    }
}

/// Height of the centre of mass at which the lowest point of the body is on the ground, m.
#[must_use]
pub fn height_on_the_ground(body: &Body, state: &State) -> f64 {
    body.support(state.rotation().inverse().apply(DVec3::NEG_Z))
}
