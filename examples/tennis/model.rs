//! Ball, air and court.
//!
//! *Sources:* figures of the Rules of Tennis, of the court pace rating and of the abstract of Cross
//! and Lindsey (2014) were read there. Those of the other papers were read as others quote them.

use std::f64::consts::PI;
use std::fmt;

use tumble::{
    AirDrag, Carried, Coulomb, EnergyMomentum, Ground, SceneError, Sphere, SpinDrag, SpinLift,
    SpringDamper, Stepper, UniformGravity,
};

/// Mass (kg) and radius (m) within the Rules of Tennis: 56.0 g to 59.4 g, 6.54 cm to 6.86 cm.
pub(crate) const MASS: f64 = 0.0577;
pub(crate) const RADIUS: f64 = 0.0335;
/// Moment of inertia of a thin shell over m r².
pub(crate) const BETA: f64 = 2.0 / 3.0;
pub(crate) const GRAVITY: f64 = 9.81; // m/s²
/// Contact time, s: about 5 ms (Brody; Follow the bouncing ball, Tennis Industry, April 2004).
pub(crate) const CONTACT_TIME: f64 = 5e-3;
/// Density of air at 20 °C, kg/m³.
const DENSITY: f64 = 1.2;
/// Drag coefficient in free flight, 0.507 ± 0.024 at 15 m/s to 30 m/s and up to 2500 revolutions a
/// minute, whatever the spin (Cross and Lindsey, Sports Eng. 17, 89, 2014). Wind tunnels give 0.55
/// to 0.7 (Goodwill, Chin and Haake, J. Wind Eng. Ind. Aerodyn. 92, 935, 2004).
const DRAG: f64 = 0.507;
/// Fraction of the spin that is lost in a metre: 2 % in 6.4 m (Cross and Lindsey).
const SPIN_LOST: f64 = 0.02 / 6.4;
/// Slip speed of the friction, m/s. At a slip of a thousandth of the speed the force is below
/// Coulomb's by 0.3 %.
const SLIP_SPEED: f64 = 1e-4;

/// A ball on a court, with or without air.
pub(crate) type Game = Stepper<
    Sphere,
    Ground<SpringDamper>,
    Coulomb,
    UniformGravity,
    EnergyMomentum,
    f64,
    (AirDrag, SpinLift, SpinDrag),
>;

/// Friction and restitution of a court.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Court {
    pub(crate) name: &'static str,
    /// Coefficient of sliding friction.
    pub(crate) friction: f64,
    /// Vertical speed after a bounce over that before it.
    pub(crate) restitution: f64,
}

impl Court {
    /// Court of medium pace: the restitution of an average court, and the friction that gives it
    /// the rating 37, the middle of the category of most acrylic courts (ITF CS 01/02; Rules of
    /// Tennis, appendix I).
    pub(crate) const HARD: Self = Self {
        name: "hard",
        friction: 0.63,
        restitution: 0.81,
    };
    /// Cross, Measurements of the horizontal and vertical speeds of tennis courts, Sports Eng. 6,
    /// 93 (2003).
    pub(crate) const CLAY: Self = Self {
        name: "clay",
        friction: 0.80,
        restitution: 0.90,
    };
    /// Cross, Measurement of the speed and bounce of tennis courts, Sports Technol., 112 (2010):
    /// friction measured at 30 m/s and 17°.
    pub(crate) const GRASS: Self = Self {
        name: "grass",
        friction: 0.53,
        restitution: 0.75,
    };
    pub(crate) const ALL: [Self; 3] = [Self::HARD, Self::CLAY, Self::GRASS];

    /// Returns the court with a name.
    pub(crate) fn named(name: &str) -> Result<Self, UnknownCourt> {
        let found = Self::ALL.into_iter().find(|court| court.name == name);
        found.ok_or_else(|| UnknownCourt(name.to_owned()))
    }
}

/// A name that is not the name of a court.
#[derive(Debug)]
pub(crate) struct UnknownCourt(String);

impl fmt::Display for UnknownCourt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "court must be hard, clay or grass, got {}", self.0)
    }
}

impl std::error::Error for UnknownCourt {}

/// Forces of the air on the ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Air {
    drag: AirDrag,
    lift: SpinLift,
    spin: SpinDrag,
}

impl Air {
    /// Still air for a ball with this launch speed, m/s.
    ///
    /// The spin decays in proportion to the distance. [`SpinDrag`] decays in proportion to time,
    /// so it is exact at the launch speed, and too strong by the ratio of the speeds later.
    pub(crate) fn of_speed(speed: f64) -> Self {
        let inertia = BETA * MASS * RADIUS * RADIUS;
        Self {
            drag: AirDrag::quadratic(DRAG, PI * RADIUS * RADIUS, DENSITY),
            lift: SpinLift::tennis_ball(RADIUS, DENSITY),
            spin: SpinDrag::linear(inertia * SPIN_LOST * speed),
        }
    }

    /// No air.
    pub(crate) fn none() -> Self {
        Self {
            drag: AirDrag::default(),
            lift: SpinLift::tennis_ball(RADIUS, 0.0),
            spin: SpinDrag::default(),
        }
    }

    /// Drag over mass and square of the speed, 1/m.
    pub(crate) fn drag_per_mass(&self) -> f64 {
        self.drag.quadratic / MASS
    }

    /// Rate at which the spin decays, 1/s.
    pub(crate) fn spin_decay(&self) -> f64 {
        self.spin.linear / (BETA * MASS * RADIUS * RADIUS)
    }
}

/// Composes the scene of a ball on a court.
pub(crate) fn stepper(court: &Court, air: &Air, time_step: f64) -> Result<Game, SceneError> {
    let carried = Carried {
        mass: MASS,
        contacts: 1,
    };
    let law = SpringDamper::from_bounce(carried, court.restitution, CONTACT_TIME)?;
    Stepper::builder(Sphere::shell(MASS, RADIUS))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(Ground::level(law))
        .friction(Coulomb {
            coefficient: court.friction,
            slip_speed: SLIP_SPEED,
        })
        .force((air.drag, air.lift, air.spin))
        .integrator(EnergyMomentum { time_step })
        .build()
}
