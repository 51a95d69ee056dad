//! Hills and valleys: the gap is a distance, springs under them do no work round a closed path, and
//! what slides and rolls there does so by closed forms.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::cell::Cell;
use core::f64::consts::{PI, TAU};

use crate::kit::erased::Stepper;
use crate::kit::{self, log_uniform};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Bowl, Coulomb, Elevation, EnergyMomentum, Frictionless, Ground, HeightField, Ramp, Shape,
    SlidingFriction, SpringDamper, State, Surface, Terrain, UniformGravity, Waves,
};

const G: f64 = 9.8;

/// The squares of these numbers underflow. At the bend, the root of their sum must not be 0.
#[test]
fn a_ramp_with_a_tiny_bend_has_a_gap_everywhere() {
    for width in [1e-150, 1e-163, 1e-200, 5e-324] {
        let ramp = Terrain::of(Ramp { slope: 0.5, width });
        for x in [0.0, -0.0, 1e-170, -1e-170, 1.0, -1.0_f64] {
            let surface: Surface = ramp.surface(DVec3::new(x, 0.0, 0.5 * x.max(0.0) + 0.1));
            let (gap, normal) = (surface.gap, surface.normal);
            assert!(
                (0.08..0.1 + 1e-12).contains(&gap),
                "{width} m, {x} m: {gap} m"
            );
            assert!((normal.length() - 1.0).abs() < 1e-12, "{width} m, {x} m");
        }
    }
}

/// A ball of a tenth of the radius of curvature, more than its size away from steep waves: the
/// search from the point vertically below may not find the nearest point of the surface.
#[test]
fn a_ball_in_the_air_above_steep_waves_touches_nothing() {
    let length = 2.0;
    for slope in [3.6, 5.0, 8.0, 20.0] {
        let amplitude = slope * length / TAU;
        let waves = Waves { amplitude, length };
        let radius = 0.1 * (length / TAU).powi(2) / amplitude;
        let shape = Terrain::of(waves);
        let height = |x: f64| -> f64 { waves.elevation(x, 0.0).height };
        let mut count = 0;
        for number in 0..4000_u16 {
            // Places in no order, by multiples of irrational numbers.
            let share = |factor: f64| (f64::from(number) * factor).fract();
            let x = length * share(0.618_033_988_7);
            let up = (amplitude - height(x)) * share(0.414_213_562_4);
            let centre = DVec3::new(x, 0.0, height(x) + up);
            let distance_at = |part: i16| {
                let along = x + up.min(length) * f64::from(part) / 500.0;
                centre.distance(DVec3::new(along, 0.0, height(along)))
            };
            let distance = (-500..=500).map(distance_at).fold(f64::MAX, f64::min);
            if distance < 2.0 * radius {
                continue;
            }
            count += 1;
            let surface: Option<Surface> = shape.surface_under(centre, radius);
            let gap = surface.map_or(f64::MAX, |surface| surface.gap);
            assert!(gap > radius, "{gap} m of {distance} m at {centre}, {slope}");
        }
        assert!(count > 3000, "{count}");
    }
}

/// The named reliefs, with radii of curvature of 1 m at least.
fn each_relief(mut test: impl FnMut(&str, &dyn Shape)) {
    test(
        "bowl",
        &Terrain {
            height_field: Bowl {
                curvatures: [1.0, 0.4],
            },
        },
    );
    test(
        "saddle",
        &Terrain {
            height_field: Bowl {
                curvatures: [0.8, -0.9],
            },
        },
    );
    test(
        "ramp",
        &Terrain {
            height_field: Ramp {
                slope: 1.0,
                width: 0.5,
            },
        },
    );
    test(
        "waves",
        &Terrain {
            height_field: Waves {
                amplitude: 0.1,
                length: 2.0,
            },
        },
    );
}

/// Work of a spring of 1 N/m round a circle of radius 0.1 m about a point, J: `∮ k d n · ds`, by
/// the trapezoidal rule, which is exact for smooth periodic functions.
fn work_round(surface: impl Fn(DVec3) -> (f64, DVec3), centre: DVec3, axes: [DVec3; 2]) -> f64 {
    let count = 400;
    let mut work = 0.0;
    for i in 0..count {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(count)).sin_cos();
        let place = centre + (axes[0] * cos + axes[1] * sin) * 0.1;
        let way = (axes[1] * cos - axes[0] * sin) * (0.1 * TAU / f64::from(count));
        let (gap, normal) = surface(place);
        work += normal.dot(way) * -gap;
    }
    work
}

#[test]
fn springs_under_a_terrain_do_no_work_round_a_closed_path() {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    each_relief(|name, shape| {
        for place in [[0.3, -0.2], [-0.6, 0.5], [0.05, 0.0]] {
            let [at_x, at_y] = place;
            let near = DVec3::new(at_x, at_y, 0.0);
            // A path under the surface, up to 0.3 m deep: below every radius of curvature.
            let centre = near - z * (shape.surface(near).gap + 0.15);
            for axes in [[x, z], [y, z], [x, y], [(x + y) * 0.5_f64.sqrt(), z]] {
                let work = work_round(
                    |p| (shape.surface(p).gap, shape.surface(p).normal),
                    centre,
                    axes,
                );
                // Forces of 0.3 N along 0.6 m, to rounding of the 400 terms.
                assert!(work.abs() < 1e-14, "{name}: {work:e} J round {centre}");
            }
        }
    });
}

#[test]
fn a_vertical_depth_along_the_normal_would_do_work_round_a_closed_path() {
    // A wrong measure of depth, which the crate does not use: (h - z)/√(1 + |∇h|²) along the normal
    // of the point vertically above. The test above would detect it: a bowl of radius of curvature
    // 1 m.
    let law = |p: DVec3| {
        let upright = DVec3::new(-p.x, -p.y, 1.0);
        let height = (p.x * p.x + p.y * p.y) / 2.0;
        ((p.z - height) / upright.length(), upright.normalize())
    };
    let work = work_round(law, DVec3::new(0.5, 0.0, 0.0), [DVec3::X, DVec3::Z]);
    assert!(work.abs() > 1e-5, "{work:e} J");
}

proptest! {
    #![proptest_config(kit::cases(300))]

    /// A point is constructed from its nearest point: along the normal, by less than the radius of
    /// curvature.
    #[test]
    fn the_gap_is_the_distance_to_the_nearest_point(x in -2.0..2.0_f64, y in -2.0..2.0_f64, gap in -0.5..0.5_f64, curvatures in [-1.0..1.0_f64, -1.0..1.0_f64]) {
        for with_hessian in [true, false] {
            let bowl = Bowl { curvatures };
            let height_field = move |x: f64, y: f64| {
                let elevation = bowl.elevation(x, y);
                if with_hessian { elevation } else { Elevation::new(elevation.height, elevation.gradient) }
            };
            let [hx, hy] = height_field(x, y).gradient;
            let normal = DVec3::new(-hx, -hy, 1.0).normalize();
            let foot = DVec3::new(x, y, height_field(x, y).height);
            let surface = Terrain::of(height_field).surface(foot + normal * gap);
            // Without the hessian each evaluation gains a factor of 2, and the error of the gap is
            // the square of that of the point: 2^-46. The error of the normal is that of the point.
            let (of_gap, of_normal) = if with_hessian { (1e-14, 1e-13) } else { (1e-13, 1e-6) };
            prop_assert!((surface.gap - gap).abs() < of_gap * 10.0, "{} for {gap}", surface.gap);
            prop_assert!((surface.normal - normal).length() < of_normal * 10.0, "{} for {normal}", surface.normal);
        }
    }

    /// The surface under a contact is that of its centre, to the last bit. A bare point above the
    /// terrain is left out after one elevation.
    #[test]
    fn a_bare_point_above_a_terrain_costs_one_elevation(
        x in -2.0..2.0_f64,
        y in -2.0..2.0_f64,
        gap in -0.5..0.5_f64,
        radius in 0.0..0.3_f64,
        curvatures in [-1.0..1.0_f64, -1.0..1.0_f64],
    ) {
        let asked = Cell::new(0);
        let bowl = Bowl { curvatures };
        let terrain = Terrain::of(|x: f64, y: f64| {
            asked.set(asked.get() + 1);
            bowl.elevation(x, y)
        });
        let centre = DVec3::new(x, y, bowl.elevation(x, y).height + gap);
        let surface = terrain.surface(centre);
        prop_assert_eq!(terrain.surface_under(centre, radius), Some(surface));
        asked.set(0);
        let under = terrain.surface_under(centre, 0.0);
        prop_assert_eq!(under, (gap < 0.0).then_some(surface));
        prop_assert!(gap < 0.0 || asked.get() == 1, "{} elevations", asked.get());
    }

    /// A level terrain is a plane, and a bowl of no curvature is level, to the last place.
    #[test]
    fn a_terrain_without_height_is_the_plane(x in -1e3..1e3_f64, y in -1e3..1e3_f64, z in -1.0..1.0_f64) {
        let flat = Terrain { height_field: Bowl { curvatures: [0.0_f64; 2] } };
        let surface: tumble::Surface = flat.surface(DVec3::new(x, y, z));
        prop_assert_eq!(surface.gap.to_bits(), z.to_bits());
        prop_assert_eq!(surface.normal, DVec3::Z);
    }

    /// A slope's end is a tilted plane: the terms beyond are `slope width²/(4 x)`.
    #[test]
    fn a_ramp_ends_as_a_plane(slope in -2.0..2.0_f64, gap in -0.1..0.1_f64) {
        let (x, width) = (100.0, 0.01);
        let normal = DVec3::new(-slope, 0.0, 1.0).normalize();
        let surface = Terrain { height_field: Ramp { slope, width } }.surface(DVec3::new(x, 0.0, slope * x) + normal * gap);
        prop_assert!((surface.gap - gap).abs() < slope.abs() * width * width / (3.0 * x) + 1e-13);
    }
}

/// The cycloid valley with the generating radius a: `x = a (φ + sin φ)`, `z = a (1 - cos φ)`, |φ| <
/// π.
struct Cycloid {
    radius: f64,
}

impl HeightField for Cycloid {
    fn elevation(&self, x: f64, _y: f64) -> Elevation {
        // φ + sin φ = x/a by Newton's method, from a line that is never beyond.
        let aim = (x / self.radius).clamp(-3.0, 3.0);
        let mut angle = aim / 2.0;
        for _ in 0..30 {
            angle -= (angle + angle.sin() - aim) / (1.0 + angle.cos());
        }
        let cosine = (angle / 2.0).cos();
        let bend = 1.0 / (4.0 * self.radius * cosine.powi(4));
        Elevation::new(
            self.radius * (1.0 - angle.cos()),
            [(angle / 2.0).tan(), 0.0],
        )
        .with_hessian([bend, 0.0, 0.0])
    }
}

/// A point of 1 kg on a terrain of springs of 1e6 N/m that carry it 1e-5 m deep, with enough
/// damping to follow the terrain.
fn stepper_on<'a>(
    height_field: impl HeightField + 'a,
    friction: impl SlidingFriction + 'a,
    time_step: f64,
) -> Stepper<'a> {
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 2000.0,
    };
    let body = tumble::PointCloud::new([DVec3::ZERO], [1.0]).unwrap();
    Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(Ground {
            law,
            shape: Terrain { height_field },
        })
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(EnergyMomentum { time_step })
        .unwrap()
}

#[test]
fn a_bead_in_a_cycloid_valley_swings_as_long_at_any_height() {
    // Case I3 (Huygens, Horologium oscillatorium, 1673): 4π√(a/g), whatever the amplitude.
    let a = 0.1;
    let period = 4.0 * PI * (a / G).sqrt();
    assert!((period - 1.269_395).abs() < 5e-7);
    for angle in [0.1, 0.8, 1.5_f64] {
        let dt = period / 4000.0;
        let stepper = stepper_on(Cycloid { radius: a }, Frictionless, dt);
        let (x, z) = (a * (angle + angle.sin()), a * (1.0 - angle.cos()));
        let mut state = State::at(DVec3::new(x, 0.0, z));
        // Quarter periods, at the passages through the bottom, half an oscillation apart.
        let (mut before, mut passages, mut time) = (x, Vec::new(), 0.0);
        while passages.len() < 3 {
            stepper.step(&mut state).unwrap();
            time += dt;
            let here = state.position.x;
            if before * here < 0.0 {
                passages.push(time - dt * here / (here - before));
            }
            before = here;
        }
        let found = passages[2] - passages[0];
        // It penetrates by N/k, 2e-5 m at most, of the radii of curvature of 4a cos(φ/2) = 0.29 m
        // at least: 1e-4 of them. Order 2: (2π/4000)²/12.
        assert!(
            (found / period - 1.0).abs() < 1e-4,
            "{found} s from {angle}"
        );
    }
}

proptest! {
    #![proptest_config(kit::cases(8))]

    /// Case I5: what comes to rest in the paraboloid z = x²/2 does so where the slope, x, is at
    /// most the coefficient.
    #[test]
    fn what_slides_in_a_bowl_comes_to_rest_where_the_slope_is_below_the_coefficient(coefficient in 0.1..0.8_f64, start in 0.9..1.5_f64, speed in log_uniform(0.01, 1.0)) {
        let stepper = stepper_on(Bowl { curvatures: [1.0, 1.0] }, Coulomb { coefficient, slip_speed: 1e-7 }, 1e-3);
        let mut state = State::at(DVec3::new(start, 0.0, start * start / 2.0)).with_linear_velocity(DVec3::Y * speed);
        stepper.advance(&mut state, 8.0).unwrap();
        let place = state.position;
        let steepness = place.x.hypot(place.y);
        // It creeps on by 1e-7 m/s, or a hundred times that within 1 % of the limit.
        stepper.advance(&mut state, 1.0).unwrap();
        prop_assert!((state.position - place).length() < 1e-5, "it still moves, by {}", (state.position - place).length());
        prop_assert!(steepness <= coefficient * 1.0001, "{steepness} for {coefficient}");
    }
}

#[test]
fn a_ball_in_a_bowl_swings_as_on_the_parallel_surface() {
    // Without friction the centre of a ball of radius r slides on the surface that lies r inside, a
    // bowl of the curvature 1/(R - r): ω² = g/(R - r).
    let (bowl, radius) = (1.0, 0.25);
    let ball = tumble::PointCloud::with_storage(
        [tumble::ContactPoint {
            position: DVec3::ZERO,
            radius,
        }],
        &[1.0],
    )
    .unwrap();
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 2000.0,
    };
    let height_field = Bowl {
        curvatures: [1.0 / bowl; 2],
    };
    let period = TAU * ((bowl - radius) / G).sqrt();
    let time_step = period / 4000.0;
    let stepper = Stepper::new(ball)
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(Ground {
            law,
            shape: Terrain { height_field },
        })
        .unwrap()
        .with_integrator(EnergyMomentum { time_step })
        .unwrap();
    let amplitude = 0.003;
    let z = radius + amplitude * amplitude / 2.0 / (bowl - radius);
    let mut state = State::at(DVec3::new(amplitude, 0.0, z - 1e-5));
    stepper.advance(&mut state, period).unwrap();
    // The terms that the law of small oscillations leaves out are (amplitude/length)², 1.6e-5, and
    // the body penetrates by 1e-5 of its length. 2π of both make the phase.
    assert!(
        (state.position.x / amplitude - 1.0).abs() < 1e-4,
        "{}",
        state.position
    );
    stepper.advance(&mut state, period / 4.0).unwrap();
    assert!(
        state.position.x.abs() < 3e-4 * amplitude,
        "{}",
        state.position
    );
}

/// The inside of an upright cylinder about the z axis.
struct Hole {
    radius: f64,
}

impl Shape for Hole {
    fn surface(&self, point: DVec3) -> tumble::Surface {
        let level = point.with_z(0.0);
        tumble::Surface {
            gap: self.radius - level.length(),
            normal: -level.normalize(),
        }
    }
}

#[test]
fn a_ball_that_sticks_and_rolls_round_a_wall_does_so_at_order_two() {
    // A solid ball rolls round in a hole at 10 rad/s (case I2). Its slip settles in ε/(μ R Ω²) =
    // 1e-9 s: no step resolves it. What settles a stick looked at the end velocity along the mean
    // normal, half a step's turn beside the wall's own at the end, and was of order 1: 1.2e-3 m off
    // at 0.1 ms.
    let (hole, radius, rate) = (0.5, 0.1, 10.0);
    let (arm, law) = (
        hole - radius,
        SpringDamper {
            stiffness: 1e6,
            damping: 200.0,
        },
    );
    let speed = arm * rate;
    let end = |time_step: f64| {
        let stepper = Stepper::new(tumble::Sphere::solid(1.0, radius))
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(G)))
            .and_then(|stepper| {
                stepper.with_ground(Ground {
                    law,
                    shape: Hole { radius: hole },
                })
            })
            .and_then(|stepper| {
                stepper.with_friction(Coulomb {
                    coefficient: 1.0,
                    slip_speed: 4e-8,
                })
            })
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(DVec3::X * (arm + speed * rate / law.stiffness))
            .with_linear_velocity(DVec3::Y * speed)
            .with_angular_momentum(DVec3::Z * (-0.4 * radius * speed));
        stepper.advance(&mut state, 1.0).unwrap();
        state.position
    };
    let ends = [4e-4, 2e-4, 1e-4].map(end);
    let changes = [(ends[1] - ends[0]).length(), (ends[2] - ends[1]).length()];
    // The next term is two orders smaller; a slip of 1e-8 m/s is not.
    let order = (changes[0] / changes[1]).log2();
    assert!((order - 2.0).abs() < 0.1, "{order}, {changes:?}");
    // A third of the last change is left.
    assert!(changes[1] < 2e-6, "{changes:?}");
}

/// A groove along y: the nearer of two planes that rise to both sides at 45 degrees.
struct Groove;

impl Shape for Groove {
    fn surface(&self, point: DVec3) -> tumble::Surface {
        let side = if point.x > 0.0 { -1.0 } else { 1.0 };
        let normal = DVec3::new(side, 0.0, 1.0) / 2.0_f64.sqrt();
        tumble::Surface {
            gap: normal.dot(point),
            normal,
        }
    }
}

#[test]
fn a_ball_in_a_groove_rests_on_one_of_its_planes_and_twice_as_deep() {
    // Two contacts of k = W/(√2 · 0.98 mm) would rest at 0.98 mm, with `2 k d cos 45° = W`. One
    // contact has `k d cos 45° = W` on average: 1.96 mm.
    let (radius, k) = (0.1, G / (2.0_f64.sqrt() * 0.98e-3));
    let stepper = Stepper::new(tumble::Sphere::solid(1.0, radius))
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(Ground {
            law: SpringDamper {
                stiffness: k,
                damping: 50.0,
            },
            shape: Groove,
        })
        .unwrap();
    let mut state = State::at(DVec3::Z * (radius * 2.0_f64.sqrt()));
    stepper.advance(&mut state, 2.0).unwrap();
    let (mut sum, count) = (0.0, 1000);
    for _ in 0..count {
        stepper.step(&mut state).unwrap();
        sum += radius - Groove.surface(state.position).gap;
    }
    let depth = sum / f64::from(count);
    // It moves to and fro below the edge, by some hundredths of the depth.
    assert!((1.8e-3..=2.0e-3).contains(&depth), "{depth:e}");
}
