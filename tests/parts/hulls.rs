//! Convex hulls of points that are within facets, on edges, inside or repeated.

use core::f64::consts::{PI, TAU};

use crate::kit::{cases, directions, log_uniform, orientations};
use proptest::prelude::*;
use tumble::error::SceneError;
use tumble::f64::{MassProperties, Rotation};
use tumble::glam::{DMat3, DVec3};

/// Corners of a convex solid, corners of each of its facets in order, and its mass properties.
#[derive(Clone, Debug)]
struct Shape {
    corners: Vec<DVec3>,
    facets: Vec<Vec<usize>>,
    volume: f64,
    /// Of a mass of 1 kg.
    solid: MassProperties,
}

/// Prism about the z axis on a regular polygon with a radius of 1 m, and a box for four sides.
///
/// The moments are those of n triangles about the axis: `(1 - (2/3) sin²(π/n))/2` along it, and
/// half of that plus `h²/12` across.
fn prism(sides: usize, height: f64) -> Shape {
    let corners = (0..2 * sides).map(|k| {
        let angle = TAU * (k / 2) as f64 / sides as f64;
        let z = if k % 2 == 0 { -0.5 } else { 0.5 };
        DVec3::new(angle.cos(), angle.sin(), z * height)
    });
    let caps = (0..2).map(|end| (0..sides).map(|k| 2 * k + end).collect());
    let walls = (0..sides).map(|k| {
        let [a, b] = [2 * k, 2 * ((k + 1) % sides)];
        vec![a, b, b + 1, a + 1]
    });
    let along = (1.0 - 2.0 / 3.0 * (PI / sides as f64).sin().powi(2)) / 2.0;
    let across = along / 2.0 + height * height / 12.0;
    Shape {
        corners: corners.collect(),
        facets: caps.chain(walls).collect(),
        volume: sides as f64 / 2.0 * (TAU / sides as f64).sin() * height,
        solid: MassProperties {
            mass: 1.0,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::new(across, across, along)),
        },
    }
}

/// The second moments about the centre are a twentieth of those of the four corners.
fn tetrahedron(corners: [DVec3; 4]) -> Shape {
    let centre = corners.iter().sum::<DVec3>() / 4.0;
    let point = |corner: DVec3| {
        let way = corner - centre;
        let [x, y, z] = way.to_array().map(|part| way * part);
        DMat3::from_diagonal(DVec3::splat(way.length_squared())) - DMat3::from_cols(x, y, z)
    };
    let inertia = corners.into_iter().map(point).sum::<DMat3>() * (1.0 / 20.0);
    let [a, b, c, d] = corners;
    Shape {
        corners: corners.to_vec(),
        facets: (0..4)
            .map(|left| (0..4).filter(|&k| k != left).collect())
            .collect(),
        volume: (b - a).dot((c - a).cross(d - a)).abs() / 6.0,
        solid: MassProperties {
            mass: 1.0,
            centre_of_mass: centre,
            inertia,
        },
    }
}

fn shapes() -> impl Strategy<Value = Shape> {
    let point = || (directions(), 0.1..1.0).prop_map(|(way, length)| way * length);
    let prisms = (3_usize..9, log_uniform(1e-2, 2.0)).prop_map(|(n, height)| prism(n, height));
    let tetrahedra = [point(), point(), point(), point()].prop_map(tetrahedron);
    prop_oneof![3 => prisms, 1 => tetrahedra]
        .prop_filter("a solid has a volume", |shape| shape.volume > 1e-3)
}

/// Numbers that choose a point of a shape, and its position in the list.
type Choice = (u8, usize, usize, [f64; 3], u64);

/// Fractions also of a few units in the last place.
fn choices() -> impl Strategy<Value = Vec<Choice>> {
    let fraction = || prop_oneof![2 => 0.0..1.0, 1 => log_uniform(1e-17, 1.0), 1 => Just(0.0)];
    let fractions = [fraction(), fraction(), fraction()];
    let choice = (
        0..4_u8,
        any::<usize>(),
        any::<usize>(),
        fractions,
        any::<u64>(),
    );
    prop::collection::vec(choice, 0..8)
}

/// Point that changes nothing: a corner, or a point on an edge, within a facet or inside.
fn further(shape: &Shape, &(kind, facet, corner, parts, _): &Choice) -> DVec3 {
    let facet = &shape.facets[facet % shape.facets.len()];
    let [a, b, c] = [0, 1, 2].map(|k| shape.corners[facet[(corner + k) % facet.len()]]);
    let to = |from: DVec3, to: DVec3, part: f64| from + (to - from) * part;
    let on_edge = to(a, b, parts[0]);
    match kind {
        0 => a,
        1 => on_edge,
        2 => to(on_edge, c, parts[1]),
        _ => to(
            to(on_edge, c, parts[1]),
            shape.solid.centre_of_mass,
            parts[2],
        ),
    }
}

fn in_f32(points: &[DVec3]) -> Result<MassProperties, SceneError> {
    let points: Vec<_> = points.iter().map(|point| point.as_vec3()).collect();
    tumble::f32::MassProperties::hull(1.0, &points).map(|hull| MassProperties {
        mass: hull.mass.into(),
        centre_of_mass: hull.centre_of_mass.into(),
        inertia: hull.inertia.as_dmat3(),
    })
}

proptest! {
    #![proptest_config(cases(3000))]

    /// Points within facets and on edges are rounded to either side of them.
    #[test]
    fn points_of_a_solid_change_nothing(
        shape in shapes(),
        choices in choices(),
        order in prop::collection::vec(any::<u64>(), 16),
        turn in orientations(),
        offset in directions(),
    ) {
        let all = (shape.corners.iter().copied().zip(order))
            .chain(choices.iter().map(|choice| (further(&shape, choice), choice.4)));
        let mut all: Vec<_> = all.collect();
        all.sort_by_key(|&(_, order)| order);
        let points: Vec<_> = all.into_iter().map(|(point, _)| turn * point + offset).collect();
        let expected = shape.solid.rotated(Rotation::from_quat(turn)).at(offset);
        // Points are at most 3 m from the origin and from each other, so that each is rounded by
        // 2 ε. The volume then changes by 2 ε of the surface, which is below 20 m², and the sums
        // of some ten triangles by as much each. Centres and moments are below 1 m and 2 kg m².
        let tolerance = |epsilon: f64| 2.0 * 20.0 * 10.0 * epsilon / shape.volume;
        let both = [
            (MassProperties::hull(1.0, &points), f64::EPSILON),
            (in_f32(&points), f32::EPSILON.into()),
        ];
        for (hull, epsilon) in both {
            let hull = hull.map_err(|error| TestCaseError::fail(error.to_string()))?;
            let centre = (hull.centre_of_mass - expected.centre_of_mass).length();
            prop_assert!(centre <= tolerance(epsilon), "{centre:e} m");
            let inertia = (hull.inertia - expected.inertia).to_cols_array();
            let largest = inertia.into_iter().map(f64::abs).fold(0.0, f64::max);
            prop_assert!(largest <= tolerance(epsilon), "{largest:e} kg m²");
        }
    }

    /// Points on a line, points that coincide and points in a plane, up to the rounding of a
    /// rotation.
    #[test]
    fn points_in_a_plane_have_no_volume(
        points in prop::collection::vec((-1.0..1.0, prop_oneof![Just(0.0), -1.0..1.0]), 1..12),
        turn in orientations(),
        offset in directions(),
    ) {
        let place = |&(x, y): &(f64, f64)| turn * DVec3::new(x, y, 0.0) + offset * 0.1;
        let mut points: Vec<_> = points.iter().map(place).collect();
        points.push(points[0]);
        for error in [MassProperties::hull(1.0, &points), in_f32(&points)].map(Result::unwrap_err) {
            let message = "volume within the surface must be above 0, got 0 m³";
            prop_assert_eq!(error.to_string(), message);
        }
    }

    /// A power of two changes no digit. The volume and its moments underflow and overflow.
    #[test]
    fn hulls_of_any_size_have_the_same_digits(
        points in prop::collection::vec(directions(), 4..12), exponent in -400..400_i32,
    ) {
        let size = 2_f64.powi(exponent);
        let scaled: Vec<_> = points.iter().map(|&point| point * size).collect();
        match (MassProperties::hull(1.0, &points), MassProperties::hull(1.0, &scaled)) {
            (Ok(one), Ok(other)) => {
                prop_assert_eq!(one.centre_of_mass * size, other.centre_of_mass);
                prop_assert_eq!(one.inertia * size * size, other.inertia);
            }
            (one, other) => prop_assert_eq!(one, other),
        }
    }
}
