//! The scene that the page's parameters describe, and the states from which a run starts.

use tumble::f64::Rotation;
use tumble::glam::{DQuat, DVec3};
use tumble::{Coulomb, FlatGround, RigidPointBody, State, Stepper, Trial, UniformGravity};

use crate::bodies::{Body, Exhibit};
use crate::error::PageError;
use crate::memory::Block;
use crate::method::Method;

/// Scene of the page. The types of its parts are the same for all bodies and methods.
pub type PageStepper = Stepper<Body, FlatGround, Coulomb, UniformGravity, Method>;

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

    /// Reads the parameters from their block.
    #[must_use]
    pub fn read(block: &Block<{ Self::COUNT }>) -> Self {
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
        ] = core::array::from_fn(|index| block.get(index));
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

    /// Writes the parameters to their block.
    pub fn write(&self, block: &Block<{ Self::COUNT }>) {
        let placed = [self.start, self.lean, self.spin];
        let ground = [
            self.stiffness,
            self.damping,
            self.friction,
            self.slip_speed,
            self.gravity,
        ];
        block.set_all(0, &[self.body, self.method, self.step]);
        block.set_all(3, &ground);
        block.set_all(8, &placed);
    }

    /// Composes the scene with the method of the parameters.
    ///
    /// # Errors
    /// Returns [`PageError`] if a parameter is invalid.
    pub fn stepper(&self) -> Result<PageStepper, PageError> {
        self.stepper_with(Method::from_number(self.method, self.step)?)
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
        let (axis, drop) = match crate::whole(self.start) {
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

/// Count of the numbers of a state.
pub const STATE: usize = 13;

/// Reads a state from the first numbers of a block.
#[must_use]
pub fn read_state<const N: usize>(block: &Block<N>) -> State {
    let vector = |at| DVec3::new(block.get(at), block.get(at + 1), block.get(at + 2));
    let orientation = [6, 7, 8, 9].map(|at| block.get(at));
    State {
        position: vector(0),
        linear_velocity: vector(3),
        orientation: DQuat::from_array(orientation),
        angular_momentum: vector(10),
    }
}

/// Writes a state to the first numbers of a block.
pub fn write_state<const N: usize>(block: &Block<N>, state: &State) {
    block.set_all(0, &state.position.to_array());
    block.set_all(3, &state.linear_velocity.to_array());
    block.set_all(6, &state.orientation.to_array());
    block.set_all(10, &state.angular_momentum.to_array());
}
