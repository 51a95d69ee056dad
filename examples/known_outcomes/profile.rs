//! Coins by their profile: a coin that rotates in a plane, and a coin with bevelled rims.

use core::f64::consts::{PI, TAU};

use tumble::glam::{DMat3, DVec3};
use tumble::{Basin, CoinFace, ContactPoint, Faces, RigidPointBody, SolidCoin};

/// Mass and size of a coin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    /// kg.
    pub(crate) mass: f64,
    /// m.
    pub(crate) radius: f64,
    /// m.
    pub(crate) thickness: f64,
}

impl Measures {
    /// Inertia tensor of a homogeneous cylinder with its axis along x, kg m².
    pub(crate) fn inertia(&self) -> DMat3 {
        SolidCoin::new(self.mass, self.radius, self.thickness).inertia()
    }
}

/// Coin with its normal along body x. Its edge is a flat strip between two corners of its profile.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    mass: f64,
    inertia: DMat3,
    contacts: Vec<ContactPoint>,
    /// Half of the width of the strip, m.
    half: f64,
    radius: f64,
    /// Smallest distance of the strip from the axis, m: below the radius for rims of points.
    inscribed: f64,
}

impl Profile {
    /// A coin that rotates about body y only, which is world y.
    ///
    /// The motion takes place in a plane, where the coin is a rectangle with four corners. All
    /// components out of the plane stay exactly 0.
    pub(crate) fn planar(measures: Measures) -> Self {
        Self::rectangle(measures, measures.inertia())
    }

    /// A rectangle with the sides `thickness` and `2 radius`, and any inertia tensor.
    pub(crate) fn rectangle(measures: Measures, inertia: DMat3) -> Self {
        let Measures {
            mass,
            radius,
            thickness,
        } = measures;
        let half = 0.5 * thickness;
        let corner = |x, z| ContactPoint::bare(DVec3::new(x, 0.0, z));
        Self {
            mass,
            inertia,
            contacts: vec![
                corner(-half, -radius),
                corner(half, -radius),
                corner(-half, radius),
                corner(half, radius),
            ],
            half,
            radius,
            inscribed: radius,
        }
    }

    /// A coin whose rims are cut by 45°, with `points` points on each of its four circles.
    ///
    /// The mass distribution is that of the coin without bevel.
    pub(crate) fn bevelled(measures: Measures, bevel: f64, points: u32) -> Self {
        let Measures {
            mass,
            radius,
            thickness,
        } = measures;
        let half = 0.5 * thickness;
        let circles = [
            (half - bevel, radius),
            (bevel - half, radius),
            (half, radius - bevel),
            (-half, radius - bevel),
        ];
        Self {
            mass,
            inertia: measures.inertia(),
            contacts: on_circles(circles, points),
            half: half - bevel,
            radius,
            inscribed: radius * (PI / f64::from(points)).cos(),
        }
    }
}

/// Points on circles about body x, each with its x and its radius.
fn on_circles(circles: [(f64, f64); 4], count: u32) -> Vec<ContactPoint> {
    let angles = (0..count).map(|number| TAU * f64::from(number) / f64::from(count));
    let points = angles.flat_map(|angle| {
        let (sin, cos) = angle.sin_cos();
        circles.map(|(x, radius)| ContactPoint::bare(DVec3::new(x, radius * cos, radius * sin)))
    });
    points.collect()
}

impl RigidPointBody for Profile {
    fn mass(&self) -> f64 {
        self.mass
    }
    fn inertia(&self) -> DMat3 {
        self.inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
}

/// Heads, tails and edge. Between edge and face the centre of mass is above a corner of the
/// profile, at a height of at least `(a² + r i)/√(a² + r²)`, with the half width a of the strip and
/// the inscribed radius i. The other corner of a bevel is nearer to the centre of mass.
impl Faces for Profile {
    type Face = CoinFace;

    fn basin(&self, down: DVec3) -> Option<Basin<CoinFace>> {
        let level = down.y.hypot(down.z);
        let face = if self.radius * down.x.abs() < self.half * level {
            CoinFace::Edge
        } else if down.x < 0.0 {
            CoinFace::Heads
        } else {
            CoinFace::Tails
        };
        let corner = self.half.hypot(self.radius);
        let height = (self.half * self.half + self.radius * self.inscribed) / corner;
        Some(Basin { face, height })
    }
}
