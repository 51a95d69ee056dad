//! Bodies to draw: convex meshes of coloured faces, with marks on the faces.

use core::f64::consts::TAU;

use serde_json::{Value, json};
use tumble::glam::{DVec2, DVec3};

use super::film::whole;

pub type Colour = [u8; 3];

const GOLD: Colour = [222, 170, 60];
const GOLD_RELIEF: Colour = [176, 124, 28];
const SILVER: Colour = [188, 198, 210];
const SILVER_RELIEF: Colour = [128, 140, 156];
pub const RED: Colour = [208, 52, 44];
pub const IVORY: Colour = [240, 234, 220];
pub const ORANGE: Colour = [224, 140, 40];
pub const GREEN: Colour = [40, 150, 110];
pub const BLUE: Colour = [60, 110, 180];
pub const SAND: Colour = [206, 190, 160];
pub const INK: Colour = [40, 44, 56];

/// Faces with their corners counter-clockwise, seen from outside; m, body axes.
#[derive(Clone, Debug, Default)]
pub struct Mesh(Vec<(Colour, Vec<DVec3>)>, Role);

/// Role of a mesh in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Role {
    /// A body with its shadow, and with the track of its lowest point.
    #[default]
    Body,
    /// The ground, drawn below the bodies and in place of the level floor.
    Ground,
}

impl Mesh {
    /// A ground that is drawn in place of the level floor, with its surface as a grid of points:
    /// rows along x, each with its points along y, both in increasing order.
    ///
    /// Its pose is that of a body that stays at the origin. The mesh is one of the film's bodies.
    pub fn ground(rows: &[Vec<DVec3>], [first, second]: [Colour; 2]) -> Self {
        let mut mesh = Self(Vec::new(), Role::Ground);
        for (i, pair) in rows.windows(2).enumerate() {
            let columns = pair[0].windows(2).zip(pair[1].windows(2));
            for (k, (here, next)) in columns.enumerate() {
                let colour = if (i + k) % 2 == 0 { first } else { second };
                mesh.0
                    .push((colour, vec![here[0], next[0], next[1], here[1]]));
            }
        }
        mesh
    }

    pub(crate) fn is_ground(&self) -> bool {
        self.1 == Role::Ground
    }

    /// Returns the faces in whole units of length: the number of the colour, then the coordinates.
    pub(crate) fn faces(&self, unit: f64, colours: &mut Vec<Colour>) -> Value {
        let face = |(colour, points): &(Colour, Vec<DVec3>)| {
            let place = colours.iter().position(|known| known == colour);
            let number = place.unwrap_or_else(|| {
                colours.push(*colour);
                colours.len() - 1
            });
            let mut numbers = vec![whole(number as f64)];
            let flat = points.iter().flat_map(|point| point.to_array());
            numbers.extend(flat.map(|x| whole(x / unit)));
            json!(numbers)
        };
        self.0.iter().map(face).collect()
    }

    /// A coin about its x axis with a rim of `corners` corners.
    ///
    /// One face is gold with a star, the other silver with rings. Both have a red mark at the rim,
    /// towards y.
    pub fn coin(radius: f64, corners: usize) -> Self {
        // The coin is drawn slightly thick, so that the edge is visible.
        let half = 0.032 * radius;
        let on =
            |side: f64, place: DVec2| DVec3::new(side * half, radius * place.x, radius * place.y);
        let mut mesh = Self::default();
        let rim = ring(1.0, corners);
        for k in 0..corners {
            let (a, b) = (rim[k], rim[(k + 1) % corners]);
            let rib = if k % 2 == 0 {
                [176, 132, 44]
            } else {
                [204, 158, 64]
            };
            mesh.0
                .push((rib, vec![on(1.0, a), on(-1.0, a), on(-1.0, b), on(1.0, b)]));
        }
        let mut paint = |side: f64, colour: Colour, mut figure: Vec<DVec2>| {
            if side < 0.0 {
                figure.reverse();
            }
            mesh.0
                .push((colour, figure.into_iter().map(|p| on(side, p)).collect()));
        };
        let wedge = || {
            [(0.70, 0.0), (0.985, -0.075), (0.995, 0.0), (0.985, 0.075)]
                .map(|(r, angle)| r * DVec2::from_angle(angle))
                .to_vec()
        };
        for (side, base, height_field) in [(1.0, GOLD, GOLD_RELIEF), (-1.0, SILVER, SILVER_RELIEF)]
        {
            paint(side, base, rim.clone());
            paint(side, height_field, ring(0.87, corners));
            paint(side, base, ring(0.85, corners));
            if side > 0.0 {
                let star = (0..10).map(|k| if k % 2 == 0 { 0.58 } else { 0.225 } * DVec2::from_angle(TAU * f64::from(k) / 20.0 * 2.0));
                paint(side, height_field, star.collect());
            } else {
                paint(side, height_field, ring(0.64, corners));
                paint(side, base, ring(0.42, corners));
                paint(side, height_field, ring(0.2, corners));
            }
            paint(side, RED, wedge());
        }
        mesh
    }

    /// A ball or an egg around a middle, with these semi-axes. It has sectors of two colours about
    /// z, and caps of a third around its poles.
    pub fn ellipsoid(
        middle: DVec3,
        half: DVec3,
        [first, second]: [Colour; 2],
        [top, bottom]: [Colour; 2],
    ) -> Self {
        const AROUND: i32 = 24;
        const DOWN: i32 = 16;
        let at = |i: i32, k: i32| {
            let (fall, turn) = (
                0.5 * TAU * f64::from(i) / f64::from(DOWN),
                TAU * f64::from(k) / f64::from(AROUND),
            );
            middle + half * DVec3::new(fall.sin() * turn.cos(), fall.sin() * turn.sin(), fall.cos())
        };
        let mut mesh = Self::default();
        for i in 0..DOWN {
            for k in 0..AROUND {
                let colour = match i {
                    0..3 => top,
                    13.. => bottom,
                    _ if k / 3 % 2 == 0 => first,
                    _ => second,
                };
                let mut corners = vec![at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
                // Triangles at the poles.
                if i == 0 {
                    corners.remove(3);
                } else if i == DOWN - 1 {
                    corners.remove(2);
                }
                mesh.0.push((colour, corners));
            }
        }
        mesh
    }

    /// A block around its middle, with these lengths along the axes (m).
    pub fn block(lengths: DVec3, colour: Colour) -> Self {
        let mut mesh = Self::default();
        for axis in 0..3 {
            for side in [1.0, -1.0] {
                let out = DVec3::AXES[axis] * side;
                let right = DVec3::AXES[(axis + 1) % 3];
                let up = out.cross(right);
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
                let on = |(x, y): (f64, f64)| 0.5 * lengths * (out + right * x + up * y);
                mesh.0.push((colour, corners.map(on).to_vec()));
            }
        }
        mesh
    }

    /// A die around a middle: 1 at x, 2 at y, 3 at z, and a sum of 7 on opposite sides.
    pub fn die(middle: DVec3, edge: f64, base: Colour, pip: Colour) -> Self {
        let mut mesh = Self::default();
        for (axis, number) in [(0, 1), (1, 2), (2, 3), (2, 4), (1, 5), (0, 6)] {
            let out = DVec3::AXES[axis] * if number > 3 { -1.0 } else { 1.0 };
            let right = DVec3::AXES[(axis + 1) % 3];
            let up = out.cross(right);
            let on = |p: DVec2| middle + 0.5 * edge * (out + right * p.x + up * p.y);
            let figure = |figure: Vec<DVec2>, aside: DVec2| {
                figure
                    .into_iter()
                    .map(|p| on(p + aside))
                    .collect::<Vec<_>>()
            };
            let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(DVec2::from)
                .to_vec();
            mesh.0.push((base, figure(square, DVec2::ZERO)));
            for place in pips(number) {
                mesh.0.push((pip, figure(ring(0.17, 16), place)));
            }
        }
        mesh
    }
}

/// Corners of a regular polygon, counter-clockwise.
fn ring(radius: f64, corners: usize) -> Vec<DVec2> {
    (0..corners)
        .map(|k| radius * DVec2::from_angle(TAU * k as f64 / corners as f64))
        .collect()
}

fn pips(number: u8) -> Vec<DVec2> {
    let mut places = Vec::new();
    if number % 2 == 1 {
        places.push(DVec2::ZERO);
    }
    for (least, place) in [(2, (0.52, 0.52)), (4, (0.52, -0.52)), (6, (0.52, 0.0))] {
        if number >= least {
            places.extend([DVec2::from(place), -DVec2::from(place)]);
        }
    }
    places
}
