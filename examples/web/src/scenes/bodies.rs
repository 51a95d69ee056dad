//! Bodies of the page, with the scene in which each is shown first.
//!
//! Sizes and surfaces are those of the examples of the repository where there is one.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use tumble::glam::{DMat3, DVec3};
use tumble::{
    Basin, Coin, CoinFace, ContactPoint, ContactRange, Cuboid, Ellipsoid, Faces, MassProperties,
    RigidPointBody, Rim, SceneError, SolidCoin, Sphere,
};

use super::error::PageError;
use super::parameters::Parameters;

/// Body of the page: one type, so that each integrator is compiled once.
#[derive(Clone, Copy, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "the core has no allocator to box the large ones"
)]
pub enum Body {
    /// Ring of points, the coin of the coin report.
    Coin(Coin),
    /// Homogeneous cylinder, which can also come to rest on its edge.
    ThickCoin(SolidCoin),
    /// Ball with any mass distribution: a solid ball, a tippe top.
    Ball(Sphere),
    /// Cube with round corners.
    Die(Cuboid),
    /// Ellipsoid with any mass distribution: an egg, a rattleback.
    Smooth(Ellipsoid),
}

/// Number of faces that the page counts, at most.
pub const FACES: usize = 6;

/// A body with its first scene, and the axes by which it is placed.
#[derive(Clone, Copy, Debug)]
pub struct Exhibit {
    /// Body.
    pub body: Body,
    /// Rotation vector (rad) from body axes to the upright pose.
    pub upright: DVec3,
    /// Axis of the spin, body axes.
    pub spin_axis: DVec3,
    /// Axis of the rotation when the body starts to roll or is dropped, body axes.
    pub roll_axis: DVec3,
    /// Rotation vector (rad) from body axes to a pose of stable equilibrium.
    pub equilibrium: DVec3,
    /// Parameters of its first scene.
    pub parameters: Parameters,
}

impl Exhibit {
    /// Returns the body with a number of the page.
    ///
    /// # Errors
    /// Returns [`PageError::Unknown`] if no body has the number.
    pub fn from_number(number: f64) -> Result<Self, PageError> {
        let kind = "body";
        Ok(match super::whole(number) {
            Some(0) => coin(),
            Some(1) => thick_coin(),
            Some(2) => ball(),
            Some(3) => die(),
            Some(4) => tippe_top(),
            Some(5) => egg(),
            Some(6) => rattleback()?,
            _ => {
                return Err(PageError::Unknown {
                    kind,
                    value: number,
                });
            }
        })
    }
}

/// Upright along body z, with a spin about it.
fn upright(body: Body, parameters: Parameters) -> Exhibit {
    Exhibit {
        body,
        upright: DVec3::ZERO,
        spin_axis: DVec3::Z,
        roll_axis: DVec3::X,
        equilibrium: DVec3::ZERO,
        parameters,
    }
}

/// From body axes to a coin that lies on its face, rad.
const FLAT: DVec3 = DVec3::new(0.0, FRAC_PI_2, 0.0);

/// Coin, ground and friction of the coin report, whose trial 8 spins with a lean of 15 degrees.
fn coin() -> Exhibit {
    let parameters = Parameters {
        body: 0.0,
        lean: 15.0_f64.to_radians(),
        spin: 8.0,
        ..Parameters::REPORT
    };
    Exhibit {
        equilibrium: FLAT,
        ..upright(Body::Coin(Coin::ring(1.0, 0.5)), parameters)
    }
}

/// Steel, 24 mm wide and 8.5 mm thick: a third of all orientations have the edge below.
fn thick_coin() -> Exhibit {
    let (radius, thickness) = (0.012, 0.012 * FRAC_1_SQRT_2);
    let parameters = Parameters {
        body: 1.0,
        stiffness: 2000.0,
        damping: 0.6,
        slip_speed: 1e-3,
        gravity: 9.81,
        lean: 6.0_f64.to_radians(),
        spin: 120.0,
        ..Parameters::REPORT
    };
    let body = Body::ThickCoin(SolidCoin::new(0.03, radius, thickness));
    Exhibit {
        equilibrium: FLAT,
        ..upright(body, parameters)
    }
}

/// Billiard ball.
fn ball() -> Exhibit {
    let parameters = Parameters {
        body: 2.0,
        stiffness: 2e4,
        damping: 4.0,
        slip_speed: 1e-3,
        gravity: 9.81,
        start: 2.0,
        lean: 20.0_f64.to_radians(),
        spin: 60.0,
        ..Parameters::REPORT
    };
    upright(Body::Ball(Sphere::solid(0.17, 0.0286)), parameters)
}

/// Fair die of `examples/dice.rs`, on a corner.
fn die() -> Exhibit {
    let body = Cuboid::cube(0.0048, 0.016).rounded(0.0015);
    let parameters = Parameters {
        body: 3.0,
        stiffness: 4000.0,
        damping: 1.2,
        slip_speed: 1e-4,
        gravity: 9.81,
        lean: 3.0_f64.to_radians(),
        spin: 150.0,
        ..Parameters::REPORT
    };
    // From the body's diagonal to the vertical, about an axis that is normal to both.
    let diagonal = DVec3::ONE.normalize();
    let angle = DIAGONAL_ANGLE;
    Exhibit {
        body: Body::Die(body),
        upright: DVec3::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0) * angle,
        spin_axis: diagonal,
        roll_axis: DVec3::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0),
        equilibrium: DVec3::ZERO,
        parameters,
    }
}

/// Angle between a diagonal of a cube and its edges, rad: `acos(1/√3) = atan(√2)`.
const DIAGONAL_ANGLE: f64 = 0.955_316_618_124_509_3;

/// Top of `examples/tippe_top.rs`.
fn tippe_top() -> Exhibit {
    let (mass, radius) = (0.02, 0.02);
    let moment = mass * radius * radius;
    let distribution = MassProperties {
        mass,
        centre_of_mass: DVec3::NEG_Z * (0.3 * radius),
        inertia: DMat3::from_diagonal(DVec3::new(131.0 / 350.0, 131.0 / 350.0, 0.4) * moment),
    };
    let parameters = Parameters {
        body: 4.0,
        step: 2e-4,
        stiffness: 1e4,
        damping: 4.0,
        slip_speed: 1e-3,
        gravity: 9.82,
        lean: 6.0_f64.to_radians(),
        spin: 155.0,
        ..Parameters::REPORT
    };
    upright(Body::Ball(Sphere::loaded(radius, distribution)), parameters)
}

/// Egg of `examples/rising_egg.rs`, on its side.
fn egg() -> Exhibit {
    let body = Ellipsoid::solid(0.06, DVec3::new(0.02, 0.02, 0.03));
    let parameters = Parameters {
        body: 5.0,
        step: 2e-4,
        stiffness: 1e4,
        damping: 5.0,
        friction: 0.1,
        slip_speed: 1e-2,
        gravity: 9.81,
        lean: 3.0_f64.to_radians(),
        spin: 150.0,
        ..Parameters::REPORT
    };
    Exhibit {
        body: Body::Smooth(body),
        upright: DVec3::Y * FRAC_PI_2,
        spin_axis: DVec3::NEG_X,
        roll_axis: DVec3::Z,
        equilibrium: DVec3::Y * FRAC_PI_2,
        parameters,
    }
}

/// Stone of Garcia & Hubbard (Proc. R. Soc. Lond. A 418, 165, 1988): an ellipsoid whose mass is
/// rotated by 8 degrees relative to its shape.
fn rattleback() -> Result<Exhibit, SceneError> {
    let semi_axes = DVec3::new(0.2, 0.03, 0.02);
    let solid = MassProperties::ellipsoid(1.0, semi_axes)?;
    let askew = tumble::f64::Rotation::from_rotation_vector(DVec3::Z * 8.0_f64.to_radians());
    let body = Ellipsoid::loaded(semi_axes, solid.rotated(askew));
    let parameters = Parameters {
        body: 6.0,
        step: 5e-4,
        stiffness: 1e5,
        damping: 10.0,
        friction: 1.0,
        slip_speed: 1e-3,
        lean: 0.6_f64.to_radians(),
        spin: -4.0,
        ..Parameters::REPORT
    };
    Ok(upright(Body::Smooth(body), parameters))
}

/// Evaluates the same expression with the body of each variant.
macro_rules! each {
    ($any:expr, $body:ident => $result:expr) => {
        match $any {
            Body::Coin($body) => $result,
            Body::ThickCoin($body) => $result,
            Body::Ball($body) => $result,
            Body::Die($body) => $result,
            Body::Smooth($body) => $result,
        }
    };
}

impl RigidPointBody for Body {
    fn mass(&self) -> f64 {
        each!(self, body => body.mass())
    }

    fn inertia(&self) -> DMat3 {
        each!(self, body => body.inertia())
    }

    fn contacts(&self) -> &[ContactPoint] {
        each!(self, body => body.contacts())
    }

    fn rims(&self) -> &[Rim] {
        &[]
    }

    fn bounding_radius(&self) -> f64 {
        each!(self, body => body.bounding_radius())
    }

    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        each!(self, body => body.contacts_below(normal, offset))
    }

    fn contacts_below_near(&self, normal: DVec3, offset: f64, near: ContactRange) -> ContactRange {
        each!(self, body => body.contacts_below_near(normal, offset, near))
    }

    fn support(&self, direction: DVec3) -> f64 {
        each!(self, body => body.support(direction))
    }

    fn is_smooth(&self) -> bool {
        matches!(self, Self::Smooth(_))
    }

    fn support_point(&self, towards: DVec3) -> DVec3 {
        each!(self, body => body.support_point(towards))
    }

    fn check(&self) -> Result<(), SceneError> {
        each!(self, body => body.check())
    }
}

/// Faces by number: heads, tails, edge; or the pips of a die less one.
impl Faces for Body {
    type Face = usize;

    fn basin(&self, down: DVec3) -> Option<Basin<usize>> {
        match self {
            Self::Coin(body) => numbered(body.basin(down)?, coin_face),
            Self::ThickCoin(body) => numbered(body.basin(down)?, coin_face),
            Self::Die(body) => numbered(body.basin(down)?, |side| {
                usize::from(side.pips()).saturating_sub(1)
            }),
            Self::Ball(_) | Self::Smooth(_) => None,
        }
    }
}

fn numbered<F>(basin: Basin<F>, number: impl Fn(F) -> usize) -> Option<Basin<usize>> {
    Some(Basin {
        face: number(basin.face),
        height: basin.height,
    })
}

fn coin_face(face: CoinFace) -> usize {
    match face {
        CoinFace::Heads => 0,
        CoinFace::Tails => 1,
        CoinFace::Edge => 2,
    }
}

impl Body {
    /// Returns true if the body has faces that can be proven.
    #[must_use]
    pub fn has_faces(&self) -> bool {
        !matches!(self, Self::Ball(_) | Self::Smooth(_))
    }
}
