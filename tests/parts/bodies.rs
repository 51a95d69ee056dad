//! Mass properties by two methods that share no formula, and the queries of the built-in bodies.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::f64::consts::{PI, TAU};

use crate::kit::erased::Stepper;
use crate::kit::{cases, directions, log_uniform, orientations};
use proptest::prelude::*;
use tumble::contract::{CheckPlan, check_body};
use tumble::error::Rule;
use tumble::f64::{Capsule, Cone, MassProperties, Rotation};
use tumble::glam::{DMat3, DQuat, DVec3, Vec3};
use tumble::{
    AnyIntegrator, Coin, CoinFace, ContactPoint, Coulomb, Cuboid, CuboidFace, Disc, Ellipsoid,
    EnergyMomentum, FlatGround, InertiaProperties, Outcome, PointCloud, PointMass, RigidPointBody,
    Rim, Rk4, Rod, Solid, SolidCoin, Sphere, State, SymplecticEuler, ThickDisc, UniformGravity,
};

/// Both within so many units in the last place of the largest entry, centre of mass and size; a
/// dozen operations lie between them.
fn agree(a: &MassProperties, b: &MassProperties, size: f64) -> Result<(), String> {
    let near = |x: f64, y: f64, scale: f64| (x - y).abs() <= 64.0 * f64::EPSILON * scale;
    let moment = a.mass.abs().max(b.mass.abs()) * size * size;
    let inertia = (a.inertia - b.inertia).to_cols_array();
    let centre = a.centre_of_mass - b.centre_of_mass;
    let same = near(a.mass, b.mass, a.mass.abs())
        && near(centre.length(), 0.0, size)
        && inertia.into_iter().all(|entry| near(entry, 0.0, moment));
    same.then_some(()).ok_or_else(|| format!("{a:?}\n{b:?}"))
}

/// Points that have the moments of a homogeneous box: eight at `±edge/(2 √3)`.
fn eight_points(edges: DVec3) -> [DVec3; 8] {
    let at = edges / 12.0_f64.sqrt();
    core::array::from_fn(|i| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        at * DVec3::new(sign(1), sign(2), sign(4))
    })
}

fn corners(edges: DVec3) -> [DVec3; 8] {
    eight_points(edges).map(|place| place * 3.0_f64.sqrt())
}

fn edges() -> impl Strategy<Value = DVec3> {
    let edge = || log_uniform(0.1, 1.0);
    (edge(), edge(), edge()).prop_map(DVec3::from)
}

fn turned(distribution: MassProperties, q: DQuat) -> MassProperties {
    distribution.rotated(Rotation::from_quat(q))
}

#[test]
fn faces_and_outcomes_are_written_as_words() {
    let sides = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
        let die = Cuboid::cube(1.0, 0.1);
        let up = |axis| {
            let turn = DQuat::from_rotation_arc(axis, DVec3::Z);
            die.face_up(&State::default().with_orientation(turn))
                .unwrap()
        };
        format!("{} {}", up(axis), up(-axis))
    });
    assert_eq!(sides, ["+x -x", "+y -y", "+z -z"]);
    let faces = [CoinFace::Heads, CoinFace::Tails, CoinFace::Edge];
    assert_eq!(
        faces.map(|face| face.to_string()),
        ["heads", "tails", "edge"]
    );
    assert_eq!(
        format!("{:>6}|", Outcome::Decided(CoinFace::Heads)),
        " heads|"
    );
    let undecided = Outcome::<CuboidFace>::Undecided;
    assert_eq!(undecided.to_string(), "undecided");
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn a_box_is_eight_boxes_of_half_its_edges(mass in log_uniform(1e-3, 1e3), edges in edges()) {
        let whole = MassProperties::cuboid(mass, edges).unwrap();
        let eighth = MassProperties::cuboid(mass / 8.0, edges / 2.0).unwrap();
        let parts = corners(edges / 2.0).map(|place| eighth.at(place));
        let (first, rest) = parts.split_first().unwrap();
        let built = rest.iter().fold(*first, |body, part| body.with(part));
        agree(&whole, &built, 1.0).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn a_box_has_the_moments_of_eight_points_of_its_hull_and_of_its_triangles(
        mass in log_uniform(1e-3, 1e3), edges in edges(), turn in orientations(), way in directions(),
    ) {
        let whole = turned(MassProperties::cuboid(mass, edges).unwrap().at(way), turn);
        let place = |p: DVec3| turn * (p + way);
        let points = MassProperties::points(&eight_points(edges).map(place), &[mass / 8.0; 8]).unwrap();
        agree(&whole, &points, 2.0).map_err(TestCaseError::fail)?;
        // A thin box has the volume of a hundredth of its size cubed, which its sums of tetrahedra
        // are rounded by.
        let size = 2.0 * 10.0;
        let vertices = corners(edges).map(place);
        let hull = MassProperties::hull(mass, &vertices).unwrap();
        agree(&whole, &hull, size).map_err(TestCaseError::fail)?;
        let mesh = MassProperties::mesh(mass, &vertices, &BOX).unwrap();
        agree(&whole, &mesh, size).map_err(TestCaseError::fail)?;
    }

    /// File formats that count from 1 have such a vertex. It was the tip of all tetrahedra, and a
    /// small box far from it had moments up to 300 times too large in `f32`.
    #[test]
    fn a_vertex_that_no_triangle_names_has_no_effect(edges in edges(), way in directions()) {
        let at = |p: DVec3| (p + way * 1e3).as_vec3();
        let vertices = corners(edges).map(at);
        let named = BOX.map(|corners| corners.map(|corner| corner + 1));
        let [a, b, c, d, e, f, g, h] = vertices;
        let with_one = [Vec3::ZERO, a, b, c, d, e, f, g, h];
        let plain = tumble::f32::MassProperties::mesh(1.0, &vertices, &BOX);
        prop_assert_eq!(plain, tumble::f32::MassProperties::mesh(1.0, &with_one, &named));
    }

    #[test]
    fn the_moments_do_not_depend_on_the_axes_in_which_a_body_is_given(
        edges in edges(), turn in orientations(), way in directions(),
    ) {
        let ball = MassProperties::ball(0.3, 0.2).unwrap().at(way * 0.5);
        let own = MassProperties::cuboid(1.0, edges).unwrap().with(&ball);
        let other = turned(own, turn).at(way * 3.0);
        let moments = |body: &MassProperties| {
            let found = InertiaProperties::<f64>::new(body.mass, body.inertia).unwrap().moments();
            let mut moments = found.to_array();
            moments.sort_by(f64::total_cmp);
            DVec3::from(moments)
        };
        // Jacobi's method and the rotation: a few dozen roundings of the largest moment.
        prop_assert!((moments(&own) - moments(&other)).length() <= 64.0 * f64::EPSILON * own.inertia.to_cols_array().into_iter().fold(0.0, f64::max));
    }

    #[test]
    fn the_order_in_which_parts_are_joined_does_not_matter(a in edges(), b in edges(), way in directions(), turn in orientations()) {
        let first = MassProperties::cuboid(1.0, a).unwrap();
        let second = turned(MassProperties::cuboid(3.0, b).unwrap(), turn).at(way);
        let third = MassProperties::rod(0.1, 1.0).unwrap().at(-way);
        let one = first.with(&second).with(&third);
        let other = third.with(&first).with(&second);
        agree(&one, &other, 2.0).map_err(TestCaseError::fail)?;
        // And a part that is taken away again leaves the rest.
        let hole = MassProperties { mass: -second.mass, inertia: -second.inertia, ..second };
        agree(&first.with(&third), &one.with(&hole), 8.0).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn inertia_about_another_place_is_that_of_the_points_about_it(edges in edges(), place in directions()) {
        let points = eight_points(edges);
        let body = MassProperties::points(&points, &[0.25; 8]).unwrap();
        let about = points.iter().fold(DMat3::ZERO, |sum, &point| {
            let d = point - place;
            let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            sum + (DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer) * 0.25
        });
        let difference = (body.inertia_about(place) - about).to_cols_array();
        prop_assert!(difference.iter().all(|entry| entry.abs() < 1e-14), "{difference:?}");
    }

    /// The hull of a prism's corners is the prism, whatever lies inside or twice on it; its moments
    /// follow from those of n triangles about the axis: `m r² (1 - (2/3) sin²(π/n))/2`, and half of
    /// that and `m h²/12` across.
    #[test]
    fn the_hull_of_a_prism_is_the_prism(n in 3_usize..24, height in 0.1..2.0_f64, seed in prop::collection::vec(directions(), 6), turn in orientations()) {
        let rim = |k: usize, z: f64| {
            let angle = TAU * k as f64 / n as f64;
            turn * DVec3::new(angle.cos(), angle.sin(), z)
        };
        let mut points: Vec<DVec3> = (0..n).flat_map(|k| [rim(k, -height / 2.0), rim(k, height / 2.0)]).collect();
        // Inside; doubles; on an edge; within a facet.
        points.extend(seed.iter().map(|&way| way * (0.2 * height.min(1.0))));
        points.push(points[1]);
        points.insert(0, (points[0] + points[1]) / 2.0);
        points.insert(3, (rim(0, 0.1 * height) + rim(1, 0.2 * height)) / 2.0);
        let hull = MassProperties::hull(2.0, &points).unwrap();
        let along = 1.0 - 2.0 / 3.0 * (PI / n as f64).sin().powi(2);
        let across = along / 2.0 + height * height / 6.0;
        let prism = MassProperties {
            mass: 2.0,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::new(across, across, along)),
        };
        // Points within 256 units in the last place of the hull's size from a facet belong to it.
        // This changes the volume of a thin prism by a fraction of that.
        agree(&turned(prism, turn), &hull, 10.0).map_err(TestCaseError::fail)?;
    }

    /// Points within a facet may have the least numbers of all: the centres of both caps, points on
    /// the sides, and some on edges.
    #[test]
    fn the_hull_of_a_prism_is_the_prism_in_any_order(
        n in 3_usize..16,
        height in 0.1..2.0_f64,
        turn in orientations(),
        order in prop::collection::vec(any::<u64>(), 60),
    ) {
        let rim = |k: usize, z: f64| {
            let angle = TAU * k as f64 / n as f64;
            turn * DVec3::new(angle.cos(), angle.sin(), z)
        };
        let [low, high] = [-height / 2.0, height / 2.0];
        let corners = (0..n).flat_map(|k| [rim(k, low), rim(k, high)]);
        let centres = [turn * (DVec3::Z * low), turn * (DVec3::Z * high)];
        let sides = (0..n).map(|k| (rim(k, 0.3 * low) + rim(k + 1, 0.4 * high)) / 2.0);
        let edges = [(rim(0, low) + rim(1, low)) / 2.0, rim(2, 0.1 * high)];
        let points: Vec<DVec3> = corners.chain(centres).chain(sides).chain(edges).collect();
        let mut mixed: Vec<_> = order.iter().zip(&points).collect();
        mixed.sort_by_key(|(order, _)| **order);
        let mixed: Vec<DVec3> = mixed.into_iter().map(|(_, &point)| point).collect();
        prop_assert_eq!(mixed.len(), points.len());
        let centres_first: Vec<DVec3> = centres.into_iter().chain(mixed.iter().copied()).collect();
        let along = 1.0 - 2.0 / 3.0 * (PI / n as f64).sin().powi(2);
        let across = along / 2.0 + height * height / 6.0;
        let prism = turned(MassProperties {
            mass: 2.0,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::new(across, across, along)),
        }, turn);
        for points in [mixed, centres_first] {
            let hull = MassProperties::hull(2.0, &points).unwrap();
            agree(&prism, &hull, 10.0).map_err(TestCaseError::fail)?;
        }
    }

    /// Checks the fraction `h/√(4r² + h²)` of all orientations in which a coin falls back on its
    /// edge, because its normal is nearly horizontal.
    ///
    /// Heights on a sphere are uniformly distributed (Archimedes). For a US nickel the fraction is
    /// 9 in 100 (Murray & Teare, Phys. Rev. E 48, 2547, 1993, find 1 in 6000 after bounces).
    #[test]
    fn a_coin_whose_weight_is_over_its_edge_stands(turn in orientations()) {
        let coin = SolidCoin::new(0.005, 10.605e-3, 1.95e-3);
        let state = State::at(DVec3::ZERO).with_orientation(turn);
        let share: f64 = 1.95 / (4.0 * 10.605_f64.powi(2) + 1.95_f64.powi(2)).sqrt();
        prop_assert!((share - 0.0916).abs() < 5e-5);
        let up = (turn * DVec3::X).z;
        let expected = if up.abs() < share { CoinFace::Edge } else if up > 0.0 { CoinFace::Heads } else { CoinFace::Tails };
        prop_assert_eq!(coin.face_up(&state), expected);
    }

    #[test]
    fn the_side_that_is_up_is_the_one_whose_normal_rises_most(turn in orientations()) {
        let die = Cuboid::cube(0.004, 0.016);
        let sides = [
            (CuboidFace::X, DVec3::X), (CuboidFace::MinusX, -DVec3::X), (CuboidFace::Y, DVec3::Y),
            (CuboidFace::MinusY, -DVec3::Y), (CuboidFace::Z, DVec3::Z), (CuboidFace::MinusZ, -DVec3::Z),
        ];
        let height = |normal: DVec3| (turn * normal).z;
        let highest = sides.into_iter().max_by(|a, b| height(a.1).total_cmp(&height(b.1))).unwrap();
        prop_assert_eq!(die.face_up(&State::at(DVec3::ZERO).with_orientation(turn)), Some(highest.0));
    }
}

/// The sides of a box, corner i at the signs of i's bits.
const BOX: [[usize; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5], // x
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3], // y
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6], // z
];

#[test]
fn a_ball_has_the_moments_of_six_points_on_its_axes() {
    // 4 of 6 points of mass m/6 turn about an axis: 2 m d²/3 = 2 m r²/5.
    let d = 0.3 * 0.6_f64.sqrt();
    let places = [
        DVec3::X,
        -DVec3::X,
        DVec3::Y,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
    ]
    .map(|p| p * d);
    let points = MassProperties::points(&places, &[0.5; 6]).unwrap();
    agree(&MassProperties::ball(3.0, 0.3).unwrap(), &points, 0.3).unwrap();
    agree(
        &MassProperties::ellipsoid(3.0, DVec3::splat(0.3)).unwrap(),
        &points,
        0.3,
    )
    .unwrap();
}

#[test]
fn a_shell_is_what_a_thinner_ball_leaves_of_a_ball() {
    // m(r) = r³, so that the difference of two balls is homogeneous; its moment is 2 (r⁵ - s⁵)/5
    // and its mass r³ - s³: 2/3 m r² as s goes to r, with an error of first order.
    let error = |gap: f64| {
        let hole = 1.0 - gap;
        let ball = MassProperties::ball(1.0, 1.0).unwrap();
        let rest = ball.with(&MassProperties::ball(-hole.powi(3), hole).unwrap());
        rest.inertia.x_axis.x
            / MassProperties::shell(rest.mass, 1.0)
                .unwrap()
                .inertia
                .x_axis
                .x
            - 1.0
    };
    assert!((error(1e-3) / 1e-3 + 1.0).abs() < 1e-2, "{}", error(1e-3));
    assert!((error(1e-4) / 1e-4 + 1.0).abs() < 1e-3, "{}", error(1e-4));
}

#[test]
fn parts_without_mass_leave_the_others_as_they_are() {
    let nothing = MassProperties::point(0.0).at(DVec3::X);
    let ball = MassProperties::ball(2.0, 0.3).unwrap().at(DVec3::Y);
    for whole in [
        nothing.with(&nothing).with(&ball),
        ball.with(&nothing).with(&nothing),
    ] {
        assert_eq!(whole, ball);
    }
    // What is left of a body and a hole of the same mass has no centre.
    let hole = MassProperties::point(-2.0);
    let error = ball.with(&hole).with(&ball).check().unwrap_err();
    assert_eq!(error.rule, Rule::Finite);
}

#[test]
fn a_capsule_is_a_cylinder_between_half_balls() {
    let (radius, length, density): (f64, f64, f64) = (0.3, 0.8, 7.0);
    let tube = density * PI * radius * radius * length;
    let cap = density * 2.0 / 3.0 * PI * radius.powi(3);
    // About the centre of its flat side a half-ball has a ball's moments for its mass; its centre
    // of mass is 3r/8 above.
    let lift = 0.375 * radius;
    let moment = 0.4 * cap * radius * radius;
    let across = moment - cap * lift * lift;
    let half_ball = |side: f64| MassProperties {
        mass: cap,
        centre_of_mass: DVec3::Z * side * (length / 2.0 + lift),
        inertia: DMat3::from_diagonal(DVec3::new(across, across, moment)),
    };
    let built = MassProperties::cylinder(tube, radius, length)
        .unwrap()
        .with(&half_ball(1.0))
        .with(&half_ball(-1.0));
    agree(
        &MassProperties::capsule(tube + 2.0 * cap, radius, length).unwrap(),
        &built,
        1.0,
    )
    .unwrap();
    agree(
        &MassProperties::capsule(2.0, 0.3, 0.0).unwrap(),
        &MassProperties::ball(2.0, 0.3).unwrap(),
        0.3,
    )
    .unwrap();
    let body = Capsule::solid(2.0, 0.3, 0.8);
    assert_eq!(
        (body.radius(), body.length(), body.bounding_radius()),
        (0.3, 0.8, 0.7)
    );
}

#[test]
fn the_hull_of_a_fine_cone_comes_to_the_cone() {
    let cone = Cone::solid(1.0, 0.5, 0.9);
    let off = |count: usize| {
        let rim = (0..count).map(|k| {
            let angle = TAU * k as f64 / count as f64;
            DVec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), 0.0)
        });
        let points: Vec<DVec3> = rim.chain([DVec3::Z * 0.9]).collect();
        let hull = MassProperties::hull(1.0, &points).unwrap();
        assert!((hull.centre_of_mass - DVec3::Z * 0.225).length() < 1e-15);
        hull.inertia.z_axis.z / cone.inertia().z_axis.z - 1.0
    };
    // A pyramid on a polygon has `1 - (2/3) sin²(π/n)` of the cone's moment about the axis.
    for count in [12, 60] {
        let expected = -2.0 / 3.0 * (PI / count as f64).sin().powi(2);
        assert!(
            (off(count) - expected).abs() < 1e-14,
            "{count}: {}",
            off(count)
        );
    }
    assert_eq!(cone.contacts()[0].position, DVec3::Z * (0.9 - 0.225));
    assert_eq!((cone.radius(), cone.height()), (0.5, 0.9));
}

/// A point on an edge of a box, close to a corner: within the thickness of one facet it is on the
/// plane, and just outside that of the next.
#[test]
fn a_point_on_the_edge_of_a_rotated_box_changes_nothing() {
    let corners = [
        [
            0.014176213301687404,
            -0.4928617472559256,
            -0.3266848935281937,
        ],
        [
            -0.11677233443825696,
            0.056733413034365604,
            -0.5770461232402294,
        ],
        [
            -0.11140343023662873,
            -0.5048501959077489,
            -0.2873190596091497,
        ],
        [
            -0.2423519779765731,
            0.04474496438254222,
            -0.5376802893211854,
        ],
        [0.2423519779765731, -0.04474496438254222, 0.5376802893211854],
        [0.11140343023662873, 0.5048501959077489, 0.2873190596091497],
        [
            0.11677233443825696,
            -0.056733413034365604,
            0.5770461232402294,
        ],
        [
            -0.014176213301687404,
            0.4928617472559256,
            0.3266848935281937,
        ],
    ];
    let on_edge = [
        0.24233702595876425,
        -0.044682210295031055,
        0.5376517024782619,
    ];
    let points = |all: &[[f64; 3]]| -> Vec<DVec3> { all.iter().map(|&p| DVec3::from(p)).collect() };
    let alone = MassProperties::hull(1.0, &points(&corners)).unwrap();
    let with_point = points(&[&corners[..], &[on_edge]].concat());
    let hull = MassProperties::hull(1.0, &with_point).unwrap();
    for (a, b) in hull
        .inertia
        .to_cols_array()
        .iter()
        .zip(alone.inertia.to_cols_array())
    {
        assert!((a - b).abs() < 1e-14, "{hull:?} {alone:?}");
    }
}

/// `Σ` over a grid of a rounded cube's points: within one in a thousand by 100 cells along an edge.
#[test]
fn the_docs_tell_how_much_a_round_die_has_less_than_a_sharp_one() {
    let excess = |radius: f64| {
        let (count, core) = (100, 0.5 - radius);
        let centre = |i: i32| (f64::from(i) + 0.5) / f64::from(count) * 0.5;
        let beyond = |i: i32| (centre(i) - core).max(0.0).powi(2);
        let (mut cells, mut sum) = (0.0, 0.0);
        for x in 0..count {
            for y in 0..count {
                for z in 0..count {
                    if beyond(x) + beyond(y) + beyond(z) <= radius * radius {
                        cells += 1.0;
                        sum += centre(x).powi(2) + centre(y).powi(2);
                    }
                }
            }
        }
        1.0 / (6.0 * sum / cells) - 1.0
    };
    assert!((excess(0.1) - 0.029).abs() < 1e-3, "{}", excess(0.1));
    assert!((excess(0.05) - 0.008).abs() < 1e-3, "{}", excess(0.05));
}

#[test]
fn a_rounded_box_reaches_as_far_as_a_sharp_one_along_its_axes_and_less_to_its_corners() {
    let sharp = Cuboid::solid(1.0, DVec3::new(0.2, 0.4, 0.6));
    let round = sharp.rounded(0.05);
    let lowest = |body: &Cuboid, way: DVec3| {
        let heights = body
            .contacts()
            .iter()
            .map(|c| way.dot(c.position) - c.radius);
        heights.fold(f64::INFINITY, f64::min)
    };
    for way in [DVec3::X, DVec3::Y, DVec3::Z] {
        assert!((lowest(&sharp, way) - lowest(&round, way)).abs() < 1e-16);
    }
    let corner = DVec3::ONE.normalize();
    let less = lowest(&round, corner) - lowest(&sharp, corner);
    assert!(
        (less - 0.05 * (3.0_f64.sqrt() - 1.0)).abs() < 1e-16,
        "{less}"
    );
    assert_eq!(
        (round.edges(), round.corner_radius()),
        (sharp.edges(), 0.05)
    );
    assert_eq!(sharp.face_up(&State::default()), Some(CuboidFace::Z));
    // On an edge, as nearly as a number can say.
    let turn = DQuat::from_rotation_x(PI / 4.0);
    assert_eq!(
        sharp.face_up(&State::default().with_orientation(turn)),
        None
    );
}

#[test]
fn opposite_sides_of_a_die_make_seven_and_each_number_comes_once() {
    use CuboidFace::{MinusX, MinusY, MinusZ, X, Y, Z};
    for (side, opposite) in [(X, MinusX), (Y, MinusY), (Z, MinusZ)] {
        assert_eq!(side.pips() + opposite.pips(), 7);
    }
    let mut pips = [X, Y, Z, MinusX, MinusY, MinusZ].map(CuboidFace::pips);
    pips.sort_unstable();
    assert_eq!(pips, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn every_body_passes_its_contract() {
    let blank = ContactPoint::default();
    let egg = MassProperties::ball(1.0, 0.3)
        .unwrap()
        .at(DVec3::new(0.01, -0.02, 0.1));
    let tetrahedron = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO];
    let bodies: [Box<dyn RigidPointBody>; 18] = [
        Box::new(Sphere::solid(1.0, 0.3)),
        Box::new(Sphere::shell(1.0, 0.3)),
        Box::new(Sphere::loaded(0.3, egg)),
        Box::new(Cuboid::cube(1.0, 0.3)),
        Box::new(Cuboid::solid(1e-3, DVec3::new(0.1, 20.0, 3.0)).rounded(0.05)),
        Box::new(Cuboid::loaded(DVec3::ONE, egg).rounded(0.5)),
        Box::new(Capsule::solid(1.0, 0.3, 2.0)),
        Box::new(Capsule::solid(1.0, 0.3, 0.0)),
        Box::new(Rod::new(1.0, 0.3)),
        Box::new(PointMass::new(1.0)),
        Box::new(Cone::solid(1.0, 0.3, 2.0)),
        Box::new(Cone::solid_with_storage([blank; 4], 1.0, 0.3, 0.1)),
        Box::new(SolidCoin::new(1.0, 0.5, 0.1)),
        Box::new(SolidCoin::new_with_storage(
            vec![blank; 2002],
            1.0,
            0.01,
            0.1,
        )),
        Box::new(SolidCoin::new_with_storage([blank; 6], 1.0, 0.5, 1e-6)),
        Box::new(Solid::hull(1.0, tetrahedron).unwrap()),
        Box::new(Ellipsoid::solid(1.0, DVec3::new(1.0, 1e-3, 20.0))),
        Box::new(Ellipsoid::loaded(DVec3::new(0.3, 0.3, 0.4), egg)),
    ];
    for seed in 0..3 {
        let plan = CheckPlan { seed, cases: 200 };
        for (number, body) in bodies.iter().enumerate() {
            let result = check_body(&**body, plan);
            assert!(result.is_ok(), "body {number}: {}", result.unwrap_err());
        }
        check_body(&Sphere::<f32>::solid(1.0, 0.3), plan).unwrap();
        check_body(&Cuboid::<f32>::cube(1.0, 0.3), plan).unwrap();
        check_body(&SolidCoin::<f32>::new(1.0, 0.3, 0.1), plan).unwrap();
        check_body(&tumble::Cone::<f32>::solid(1.0, 0.3, 0.1), plan).unwrap();
    }
}

#[test]
fn a_solid_coin_looks_at_the_points_under_the_plane_and_few_others() {
    let coin = SolidCoin::new(1.0, 0.5, 0.1);
    for step in 0..500 {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.017, 0.3, -0.11) * f64::from(step));
        let normal = turn * DVec3::Z;
        let lowest = -(0.05 * normal.x.abs() + 0.5 * normal.y.hypot(normal.z));
        for depth in [1e-6, 1e-3, 0.02, 0.4] {
            let offset = lowest + depth;
            let run = coin.contacts_below(normal, offset);
            let below = |rim: usize| {
                let points = coin.contacts().iter().skip(rim).step_by(2);
                points
                    .filter(|point| point.position.dot(normal) < offset)
                    .count()
            };
            assert_eq!(
                run.count,
                2 * below(0).max(below(1)),
                "step {step}, {run:?}"
            );
        }
    }
}

/// A rod and a disc of points as one body, with the contacts of neither: mass points and contact
/// points stand apart.
#[test]
fn a_composite_falls_like_the_cloud_of_its_points() {
    let points = eight_points(DVec3::new(0.3, 0.2, 0.5)).map(|p| p + DVec3::new(0.1, 0.0, -0.4));
    let cloud = PointCloud::new(points, [0.25; 8]).unwrap();
    let distribution = MassProperties::points(&points, &[0.25; 8]).unwrap();
    let composite = Solid::new(distribution, points.map(ContactPoint::bare)).unwrap();
    assert_eq!(composite.centre_of_mass(), cloud.centre_of_mass());
    let start = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::X)
        .with_angular_momentum(DVec3::new(0.01, 0.02, -0.005));
    let end = |body: &dyn RigidPointBody| {
        let stepper = Stepper::new(body).unwrap();
        let stepper = stepper.with_gravity(UniformGravity::down(9.8)).unwrap();
        let stepper = stepper.with_ground(FlatGround::level(1e4, 3.0)).unwrap();
        let mut state = start;
        stepper.advance(&mut state, 1.0).unwrap();
        state
    };
    assert_eq!(end(&cloud), end(&composite));
}

#[test]
fn a_capsule_that_slides_across_its_axis_comes_to_roll_at_the_speed_of_its_moment() {
    // From a slide at v it rolls at v/(1 + I/(m r²)) (validation case C2), whatever its length. The
    // force's arm is the radius, however deep it sinks, so that only the slip that friction needs
    // is left of the difference.
    let body = Capsule::solid(1.0, 0.1, 0.3);
    let ratio = body.inertia().z_axis.z / 0.01;
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(1e5, 400.0)))
        .and_then(|stepper| {
            stepper.with_friction(tumble::Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-8,
            })
        })
        .unwrap();
    let sink = 9.8 / 2e5;
    let mut state = State::at(DVec3::Z * (0.1 - sink))
        .with_rotation_vector(DVec3::Y * (PI / 2.0))
        .with_linear_velocity(DVec3::Y);
    stepper.advance(&mut state, 1.0).unwrap();
    let expected = 1.0 / (1.0 + ratio);
    assert!(
        (state.linear_velocity.y - expected).abs() < 1e-6,
        "{} {expected}",
        state.linear_velocity.y
    );
}

#[test]
fn an_energy_of_rotation_that_overflows_is_not_finite() {
    // |L|² overflows, and the part along the symmetry axis takes infinity from it again.
    let coin = Stepper::new(tumble::f32::Coin::ring(1.0, 0.5)).unwrap();
    for direction in [Vec3::X, Vec3::Z, Vec3::new(0.3, -0.2, 0.9)] {
        let state = tumble::f32::State::at(Vec3::ZERO).with_angular_momentum(direction * 1e30);
        let rotation = coin.energy(&state).rotation;
        assert!(!rotation.is_finite(), "{direction}: {rotation} J");
    }
}

/// A body that is saved and loaded has the same bits, and one that is invalid in the file is
/// refused.
#[cfg(feature = "serde")]
macro_rules! saved_and_loaded {
    ($type:ty, $body:expr, $wrong:literal) => {{
        let body: $type = $body;
        let text = serde_json::to_string(&body).unwrap();
        let loaded: $type = serde_json::from_str(&text).unwrap();
        assert_eq!(loaded, body, "{text}");
        assert_eq!(format!("{loaded:?}"), format!("{body:?}"));
        let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
        *value.pointer_mut($wrong).unwrap() = (-1.0).into();
        let error = serde_json::from_value::<$type>(value).unwrap_err();
        assert!(
            error.to_string().contains("must be above 0, got -1"),
            "{error}"
        );
    }};
}

#[test]
fn a_hull_and_a_mesh_need_a_finite_mass() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let both = |mass| {
        [
            MassProperties::hull(mass, &corners),
            MassProperties::mesh(mass, &corners, &faces),
        ]
    };
    assert!(both(1.0).iter().all(Result::is_ok));
    for error in [f64::NAN, f64::INFINITY].into_iter().flat_map(both) {
        let error = error.unwrap_err().to_string();
        assert!(error.contains("mass of a part must be finite"), "{error}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_cloud_far_from_the_origin_is_saved_and_loaded() {
    // The square of the distance overflows in single precision.
    let points = [Vec3::ZERO, Vec3::Y, Vec3::Z].map(|point| point + Vec3::X * 1e20);
    let cloud = PointCloud::new(points, [1.0_f32; 3]).unwrap();
    let text = serde_json::to_string(&cloud).unwrap();
    let loaded: PointCloud<f32, [ContactPoint<f32>; 3]> = serde_json::from_str(&text).unwrap();
    assert_eq!(loaded, cloud);
}

#[cfg(feature = "serde")]
#[test]
fn a_body_of_a_file_needs_contacts() {
    fn emptied<B: serde::Serialize + serde::de::DeserializeOwned>(body: &B, list: &str) -> String {
        let mut value = serde_json::to_value(body).unwrap();
        value[list] = serde_json::json!([]);
        serde_json::from_value::<B>(value)
            .err()
            .unwrap()
            .to_string()
    }
    let cloud = PointCloud::new([DVec3::X, DVec3::Y, DVec3::Z], [1.0; 3]).unwrap();
    let many = PointCloud::with_storage(cloud.contacts().to_vec(), &[1.0; 3]).unwrap();
    let solid = Solid::new(
        MassProperties::ball(1.0, 0.1).unwrap(),
        vec![ContactPoint::default()],
    );
    for error in [
        emptied(&many, "points"),
        emptied(&solid.unwrap(), "contacts"),
    ] {
        assert!(error.contains("must be at least 1, got 0"), "{error}");
    }
    let far_too_many = r#"{"points":16777216,"mass":1.0,"radius":0.5,"shape":1.0}"#;
    assert!(serde_json::from_str::<tumble::Coin>(far_too_many).is_err());
}

#[cfg(feature = "serde")]
#[test]
fn a_body_that_is_saved_and_loaded_has_the_same_bits_and_must_be_valid() {
    use tumble::{Coin, Disc, ThickDisc};
    let (mass, radius, edges) = (0.37, 0.123_456_789, DVec3::new(0.3, 0.1, 0.7));
    let loaded = MassProperties::ball(mass, radius)
        .unwrap()
        .at(DVec3::new(0.01, -0.02, 0.03));
    saved_and_loaded!(Coin, Coin::ring(mass, radius), "/mass");
    saved_and_loaded!(SolidCoin, SolidCoin::new(mass, radius, 0.017), "/thickness");
    saved_and_loaded!(Disc, Disc::ring(mass, radius, 77), "/mass");
    saved_and_loaded!(Disc, Disc::solid(mass, radius, 77), "/radius");
    saved_and_loaded!(
        ThickDisc,
        ThickDisc::solid(mass, radius, 0.017, 77),
        "/thickness"
    );
    saved_and_loaded!(Cone, Cone::solid(mass, radius, 0.4), "/height");
    saved_and_loaded!(
        Cuboid,
        Cuboid::solid(mass, edges).rounded(0.011),
        "/distribution/mass"
    );
    saved_and_loaded!(Cuboid, Cuboid::loaded(edges, loaded), "/distribution/mass");
    saved_and_loaded!(Sphere, Sphere::loaded(radius, loaded), "/radius");
    saved_and_loaded!(
        Ellipsoid,
        Ellipsoid::loaded(edges, loaded),
        "/distribution/mass"
    );
    saved_and_loaded!(Capsule, Capsule::solid(mass, radius, 0.2), "/radius");
    saved_and_loaded!(Rod, Rod::new(mass, 0.9), "/length");
    saved_and_loaded!(PointMass, PointMass::new(mass), "/mass");
    let many: Coin<f64, Vec<ContactPoint>> =
        Coin::ring_with_storage(vec![ContactPoint::default(); 31], mass, radius);
    saved_and_loaded!(Coin<f64, Vec<ContactPoint>>, many.clone(), "/mass");
    // An array holds its own number of points and no other.
    let text = serde_json::to_string(&many).unwrap();
    let error = serde_json::from_str::<Coin>(&text).unwrap_err().to_string();
    assert!(error.contains("cannot hold 31 contacts"), "{error}");
}

#[cfg(feature = "serde")]
#[test]
fn a_body_with_contacts_of_its_own_is_saved_with_them() {
    let points = [
        DVec3::new(0.3, 0.1, -0.2),
        DVec3::new(-0.4, 0.2, 0.6),
        DVec3::new(0.1, -0.7, 0.05),
        DVec3::new(0.2, 0.3, 0.9),
    ];
    let masses = [0.1, 0.23, 0.31, 0.017];
    let contacts = points.map(ContactPoint::bare);
    let tetrahedron = PointCloud::new(points, masses).unwrap();
    saved_and_loaded!(PointCloud<f64, [ContactPoint; 4]>, tetrahedron, "/mass");
    let cloud = PointCloud::with_storage(contacts.to_vec(), &masses).unwrap();
    saved_and_loaded!(PointCloud<f64, Vec<ContactPoint>>, cloud, "/mass");
    let ball = MassProperties::ball(0.37, 0.2)
        .unwrap()
        .at(DVec3::new(0.01, -0.02, 0.03));
    let solid = Solid::new(ball, contacts).unwrap();
    saved_and_loaded!(Solid<f64, [ContactPoint; 4]>, solid, "/distribution/mass");
    let text = serde_json::to_string(&solid).unwrap();
    for other in [
        serde_json::from_str::<Solid<f64, [ContactPoint; 3]>>(&text).err(),
        serde_json::from_str::<Solid<f64, [ContactPoint; 5]>>(&text).err(),
    ] {
        let error = other.unwrap().to_string();
        assert!(error.contains("contacts"), "{error}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_stepper_that_is_saved_and_loaded_is_the_same_and_must_be_valid() {
    use tumble::{Coin, Coulomb, FlatGround, StrangSplitting, UniformGravity};
    type Table = tumble::Stepper<Coin, FlatGround, Coulomb, UniformGravity, StrangSplitting>;
    let table: Table = tumble::Stepper::builder(Coin::ring(0.01, 0.013))
        .ground(FlatGround::level(1e4, 0.5))
        .friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        })
        .gravity(UniformGravity::down(9.81))
        .integrator(StrangSplitting { time_step: 1e-3 })
        .build()
        .unwrap();
    let text = serde_json::to_string(&table).unwrap();
    let loaded: Table = serde_json::from_str(&text).unwrap();
    assert_eq!(loaded, table, "{text}");
    for (from, to, name) in [
        ("\"mass\":0.01", "\"mass\":-0.01", "mass"),
        ("\"coefficient\":0.3", "\"coefficient\":-0.3", "friction"),
        ("\"time_step\":0.001", "\"time_step\":0.0", "time step"),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(wrong, text, "{from} in {text}");
        let error = serde_json::from_str::<Table>(&wrong)
            .unwrap_err()
            .to_string();
        assert!(error.contains(name), "{error}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_rim_is_saved_and_a_skew_one_is_refused() {
    let rim = Rim::new(DVec3::Z * 0.01, DVec3::new(0.3, 0.1, 0.9), 0.2, 60);
    let text = serde_json::to_string(&rim).unwrap();
    let loaded: Rim = serde_json::from_str(&text).unwrap();
    assert_eq!(loaded, rim);
    assert_eq!(loaded.check(), Ok(()));
    let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let axis = value.pointer("/axes/0").unwrap().clone();
    *value.pointer_mut("/axes/1").unwrap() = axis;
    let skew: Rim = serde_json::from_value(value.clone()).unwrap();
    let error = skew.check().unwrap_err().to_string();
    // The cosine shows a small error of the angle, which the length of the normal does not.
    assert!(
        error.contains("cosine between the axes of the rim must be 0"),
        "{error}"
    );
    *value.pointer_mut("/axes/1").unwrap() = serde_json::json!([0.0, 0.0, 0.5]);
    let short: Rim = serde_json::from_value(value).unwrap();
    let error = short.check().unwrap_err().to_string();
    assert!(
        error.contains("second axis of the rim") && error.ends_with("got 0.5"),
        "{error}"
    );
}

/// Axes that are off by far less than half of the digits, in length or in direction.
#[cfg(feature = "serde")]
#[test]
fn the_axes_of_a_rim_are_perpendicular_unit_vectors_to_rounding() {
    let skew = |axes: [[f64; 3]; 2]| {
        serde_json::json!({
            "centre": [0.0, 0.0, 0.0], "axes": axes, "radius": 0.5, "points": 12.0
        })
    };
    for off in [1e-4_f64, 1e-9, 1e-13] {
        let cos = (1.0 - off * off).sqrt();
        let along: Rim = serde_json::from_value(skew([[1.0, 0.0, 0.0], [off, cos, 0.0]])).unwrap();
        let found = along.check().unwrap_err();
        assert_eq!(found.rule, Rule::Zero, "{found}");
        assert!((found.value / off - 1.0).abs() < 1e-9, "{found}");
        let long = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0 + off]];
        let long: Rim = serde_json::from_value(skew(long)).unwrap();
        assert_eq!(long.check().unwrap_err().rule, Rule::UnitLength);
    }
    let single: tumble::f32::Rim =
        serde_json::from_value(skew([[1.0, 0.0, 0.0], [0.02, 0.9998, 0.0]])).unwrap();
    assert_eq!(single.check().unwrap_err().rule, Rule::Zero);
}

/// The constructor computes its axes in both precisions to the rounding that is allowed.
#[test]
fn rims_with_any_normal_are_valid() {
    for number in 0..2000_u32 {
        let angle = f64::from(number);
        let normal = DVec3::new(
            angle.sin(),
            (1.7 * angle).cos(),
            (2.3 * angle).sin().powi(9),
        );
        let rim = Rim::new(DVec3::ZERO, normal, 0.5, 12);
        assert_eq!(rim.check(), Ok(()), "{normal}");
        let rim = Rim::new(Vec3::ZERO, normal.as_vec3(), 0.5, 12);
        assert_eq!(rim.check(), Ok(()), "{normal}");
    }
}

/// A body that says by itself whether two of its moments are equal.
struct Saying<B>(B, bool);

impl<B: RigidPointBody> RigidPointBody for Saying<B> {
    fn mass(&self) -> f64 {
        self.0.mass()
    }
    fn inertia(&self) -> DMat3 {
        self.0.inertia()
    }
    fn is_symmetric(&self) -> bool {
        self.1
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.0.contacts()
    }
}

proptest! {
    #![proptest_config(cases(64))]

    /// The moments of these types are equal for all parameters, or no scene could be composed.
    #[test]
    fn a_type_that_says_it_is_symmetric_has_two_equal_moments(
        mass in log_uniform(1e-6, 1e6),
        radius in log_uniform(1e-6, 1e6),
        ratio in log_uniform(1e-3, 1e3),
    ) {
        let length = radius * ratio;
        let bodies: [&dyn RigidPointBody; 8] = [
            &Coin::ring(mass, radius),
            &SolidCoin::new(mass, radius, length),
            &Disc::ring(mass, radius, 60),
            &Disc::solid(mass, radius, 60),
            &ThickDisc::solid(mass, radius, length, 60),
            &Capsule::solid(mass, radius, length),
            &Rod::new(mass, length),
            &PointMass::new(mass),
        ];
        for body in bodies {
            prop_assert!(body.is_symmetric());
            prop_assert!(Stepper::new(body).is_ok());
        }
    }

    /// What a body says of its moments changes no bit of a result.
    #[test]
    fn a_body_that_does_not_say_it_is_symmetric_has_the_same_bits(
        spin in prop::array::uniform3(-20.0..20.0_f64),
        turn in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let rod = Rod::new(0.3, 0.4);
        let start = State::at(DVec3::Z * 0.5)
            .with_rotation_vector(turn.into())
            .with_angular_momentum(DVec3::from(spin) * 1e-3);
        for integrator in [
            AnyIntegrator::from(SymplecticEuler { time_step: 1e-3 }),
            EnergyMomentum { time_step: 1e-2 }.into(),
            Rk4 { time_step: 1e-3 }.into(),
        ] {
            let [said, silent] = [true, false].map(|says| {
                let mut state = start;
                let stepper = Stepper::builder(Saying(rod, says))
                    .gravity(UniformGravity::down(9.81))
                    .ground(FlatGround::level(1e4, 3.0))
                    .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-2 })
                    .integrator(integrator);
                stepper.build().unwrap().advance(&mut state, 0.5).unwrap();
                state
            });
            prop_assert_eq!(said, silent);
        }
    }
}

#[test]
fn a_body_that_says_it_is_symmetric_and_is_not_is_refused() {
    let wrong = Saying(Cuboid::solid(1.0, DVec3::new(0.1, 0.2, 0.3)), true);
    let message = "number of different principal moments of a symmetric body must be at most 2, \
                   got 3";
    assert_eq!(Stepper::new(&wrong).unwrap_err().to_string(), message);
    assert!(check_body(&wrong, CheckPlan::default()).is_err());
    let right = Saying(Cuboid::solid(1.0, DVec3::new(0.2, 0.2, 0.3)), true);
    assert!(Stepper::new(&right).is_ok());
    check_body(&right, CheckPlan::default()).unwrap();
}
