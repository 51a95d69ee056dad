//! Group I, grounds that are not level: bowls, valleys, and where a body rests on them.

use core::f64::consts::{PI, TAU};
use core::ops::ControlFlow;

use tumble::glam::DVec3;
use tumble::{
    Bowl, Coulomb, Elevation, EnergyMomentum, Frictionless, Ground, RigidPointBody, Rk4, Sample,
    Shape, SlidingFriction, SmoothCoulomb, SpringDamper, State, StrangSplitting, Surface, Terrain,
    UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::{log_uniform, point_mass};
use crate::scenes::ball;
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[
    &SPHERE_IN_BOWL,
    &GOLF_BALL,
    &CYCLOID,
    &REST_IN_A_TROUGH,
    &SPHERICAL_PENDULUM,
];

const GRAVITY: f64 = 9.8;

/// Mean time (s) from passage to passage of x = 0 towards -x, of a body that starts at rest.
fn swing(
    body: impl RigidPointBody,
    shape: impl Shape,
    friction: impl SlidingFriction,
    start: DVec3,
    law: SpringDamper,
    seconds: f64,
) -> f64 {
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground { law, shape })
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(StrangSplitting { time_step: 1e-4 })
        .unwrap();
    let (mut passages, mut before) = (Vec::new(), (0.0, start.x));
    stepper
        .run(&mut State::at(start), seconds, &mut |sample: &Sample<
            '_,
        >| {
            let now = (sample.time, sample.state.position.x);
            if before.1 > 0.0 && now.1 <= 0.0 {
                passages.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    let swings = passages.len() - 1;
    (passages[swings] - passages[0]) / swings as f64
}

// -----------------------------------------------------------------------------------------------
// I1: a ball in a spherical bowl
// -----------------------------------------------------------------------------------------------

/// The inside of a sphere about the origin.
struct SphericalBowl {
    radius: f64,
}

impl Shape for SphericalBowl {
    fn surface(&self, point: DVec3) -> Surface {
        let distance = point.length();
        Surface {
            gap: self.radius - distance,
            normal: point / -distance,
        }
    }
}

const FIRM: SpringDamper = SpringDamper {
    stiffness: 1e5,
    damping: 20.0,
};

/// Friction enough to roll: 3000/s of slip.
const GRIP: Coulomb = Coulomb {
    coefficient: 1.0,
    slip_speed: GRAVITY / 3000.0,
};

/// Time of an oscillation of 0.05 rad of a ball in a bowl of 1 m.
fn swing_in_bowl(moment: f64, radius: f64, friction: impl SlidingFriction) -> f64 {
    let arm = 1.0 - radius + GRAVITY / FIRM.stiffness;
    let (sin, cos) = 0.05_f64.sin_cos();
    let start = DVec3::new(sin, 0.0, -cos) * arm;
    let bowl = SphericalBowl { radius: 1.0 };
    swing(ball(moment, radius), bowl, friction, start, FIRM, 6.0)
}

/// Error of the period of an oscillation in a bowl: the oscillation's own `θ²/16`, the
/// ground's depth `m g/k` of the arm's length by half, and the slip's phase.
const MISS: f64 = 1.5 * (0.05 * 0.05 / 16.0 + 0.5 * GRAVITY / 1e5);

static SPHERE_IN_BOWL: Case = Case::new(
    "I1",
    "rolling `2π √((1+β)(R - r)/g)`, on ice `2π √((R - r)/g)`",
    "Routh, Dynamics of a System of Rigid Bodies (1905)",
    || {
        let period = |share: f64| TAU * (share * 0.9 / GRAVITY).sqrt();
        let (sphere, hoop, ice) = (period(1.4), period(2.0), period(1.0));
        vec![
            figure(
                "sphere of 0.1 m in a bowl of 1 m: period, s",
                sphere,
                swing_in_bowl(0.4, 0.1, GRIP),
                MISS * sphere,
            ),
            figure("hoop", hoop, swing_in_bowl(1.0, 0.1, GRIP), MISS * hoop),
            figure(
                "on ice",
                ice,
                swing_in_bowl(0.4, 0.1, Frictionless),
                MISS * ice,
            ),
        ]
    },
)
.and(&[&ANY_BOWL]);

#[test]
fn a_ball_that_rolls_in_a_bowl_swings_slower_than_one_that_slides() {
    SPHERE_IN_BOWL.holds();
}

random! {
    ANY_BOWL = new(20, "ball of 0.02 to 0.5 m");
    fn balls_of_any_moment_and_size_swing_in_a_bowl_by_the_closed_form(
        moment in 0.1..1.0_f64,
        radius in 0.02..0.5_f64,
    ) |misses| {
        let expected = TAU * ((1.0 + moment) * (1.0 - radius) / GRAVITY).sqrt();
        let got = swing_in_bowl(moment, radius, GRIP);
        // The arm is 1 - r: the ground's depth is a larger share of it.
        misses.near("period", [got, expected], MISS / (1.0 - radius) * expected)?;
    }
}

// -----------------------------------------------------------------------------------------------
// I2: a golf ball in the hole
// -----------------------------------------------------------------------------------------------

/// The inside of an upright cylinder about the z axis.
struct Hole {
    radius: f64,
}

impl Shape for Hole {
    fn surface(&self, point: DVec3) -> Surface {
        let level = point.with_z(0.0);
        Surface {
            gap: self.radius - level.length(),
            normal: -level.normalize(),
        }
    }
}

/// A ball that rolls round the wall of a hole at Ω, released without a vertical speed: rolling
/// turns its spin about the radius into a vertical force, `z'' = -g/(1 + β) - k² z` with
/// `k = Ω √(β/(1 + β))`. So it descends by `2g/(β Ω²)` and comes up again.
///
/// Returns k over Ω, and the depth of the lowest point (m).
fn dip(moment: f64, [hole, radius]: [f64; 2], rate: f64) -> [f64; 2] {
    let arm = hole - radius;
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 200.0,
    };
    // The wall carries arm Ω², 40 m/s² in the printed case: 3e4/s of slip, and (1 + 1/β) of that in
    // rolling, which Runge-Kutta follows up to 2.7.
    let friction = Coulomb {
        coefficient: 1.0,
        slip_speed: arm * rate * rate / 3e4,
    };
    let stepper = Stepper::new(ball(moment, radius))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground {
            law,
            shape: Hole { radius: hole },
        })
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(Rk4 {
            time_step: f64::min(2e-5, 2.0 / (3e4 * (1.0 + 1.0 / moment))),
        })
        .unwrap();
    let speed = arm * rate;
    let depth = speed * rate / law.stiffness;
    let mut state = State::at(DVec3::X * (arm + depth))
        .with_linear_velocity(DVec3::Y * speed)
        .with_angular_momentum(DVec3::Z * (-moment * radius * speed));
    let expected = rate * (moment / (1.0 + moment)).sqrt();
    let (mut lowest, mut turn, mut before) = (0.0, 0.0, (0.0, 0.0));
    stepper
        .run(&mut state, 1.2 * PI / expected, &mut |sample: &Sample<
            '_,
        >| {
            let now = (sample.time, sample.state.linear_velocity.z);
            // Half an oscillation: the ball is lowest where the vertical speed changes sign.
            if before.1 < 0.0 && now.1 >= 0.0 {
                let time = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
                let place = sample.state.position;
                lowest = place.z;
                let angle = place.y.atan2(place.x) - rate * (now.0 - time);
                turn = angle + ((rate * time - angle) / TAU).round() * TAU;
            }
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    [PI / turn, -lowest]
}

random! {
    /// Tolerance as in the printed case. Friction supports the weight, a fraction `g/(R - r) Ω²` of
    /// the wall's load on average, and slips meanwhile by that of ε; a tenth more as the load comes
    /// and goes. The wall's depth, arm Ω²/S of the arm, makes the speed larger by as much. The time
    /// is late as the way is long.
    ANY_HOLE = new(16, "ball, hole of 0.3 to 1 m, rate at which the wall force is 3 to 20 weights");
    fn balls_of_any_kind_come_up_again_in_a_hole_of_any_size(
        moment in 0.2..1.0_f64,
        hole in 0.3..1.0_f64,
        part in 0.05..0.5_f64,
        load in log_uniform(3.0, 20.0),
    ) |misses| {
        let radius = part * hole;
        let arm = hole - radius;
        let rate = (load * GRAVITY / arm).sqrt();
        let [turns, lowest] = dip(moment, [hole, radius], rate);
        let expected = 2.0 * GRAVITY / (moment * rate * rate);
        let ratio = (moment / (1.0 + moment)).sqrt();
        let slip = load * GRAVITY / 3e4 / (load - 1.0) * PI / (rate * ratio);
        let depth = load * GRAVITY / 1e6 / arm;
        misses.near("dip", [lowest, expected], 1.1 * slip + 4.0 * depth * expected)?;
        misses.near("swings by turns", [turns, ratio], (1.1 * slip / expected + 2.0 * depth) * ratio)?;
    }
}

static GOLF_BALL: Case = Case::new(
    "I2",
    "`k = Ω √(β/(1+β))`, dips by `2g/(β Ω²)`",
    "Littlewood, A Mathematician's Miscellany (1953); Gualtieri et al., Am. J. Phys. 74, 497 (2006)",
    || {
        let dip = |moment| dip(moment, [0.5, 0.1], 10.0);
        let ([sphere, lowest], [shell, lowest_of_shell]) = (dip(0.4), dip(2.0 / 3.0));
        let depth = |moment: f64| 2.0 * GRAVITY / (moment * 100.0);
        // Friction carries the weight, g of the wall's 40 m/s² on average: for half an oscillation
        // it slips by so much of ε, a tenth more as the load comes and goes. The wall's depth is
        // 4e-5 m of 0.4 m.
        let sunk = |moment: f64| {
            let (share, rate) = (GRAVITY / 40.0, 10.0 * (moment / (1.0 + moment)).sqrt());
            1.1 * 40.0 / 3e4 * share / (1.0 - share) * PI / rate + 1e-4 * depth(moment)
        };
        // Of the time as of the way, a fraction of 2.5e-4 m in 0.5 m.
        let miss = 6e-4;
        vec![
            figure(
                "ball in a hole: vertical oscillations per revolution",
                (2.0_f64 / 7.0).sqrt(),
                sphere,
                miss,
            ),
            figure("dip, m", depth(0.4), lowest, sunk(0.4)),
            figure("shell: swings by turns", (0.4_f64).sqrt(), shell, miss),
            figure("dip, m", depth(2.0 / 3.0), lowest_of_shell, sunk(2.0 / 3.0)),
        ]
    },
)
.and(&[&ANY_HOLE]);

#[test]
fn a_ball_that_rolls_round_a_hole_comes_up_again() {
    GOLF_BALL.holds();
}

// -----------------------------------------------------------------------------------------------
// I3: Huygens' cycloid
// -----------------------------------------------------------------------------------------------

/// m
const WHEEL: f64 = 0.1;

/// The valley `x = a (φ + sin φ)`, `z = a (1 - cos φ)`: slope `tan(φ/2)`, bend `1/(4a cos⁴(φ/2))`.
fn cycloid(wheel: f64, x: f64) -> Elevation {
    let mut angle = x / (2.0 * wheel);
    for _ in 0..30 {
        let miss = angle + angle.sin() - x / wheel;
        angle -= miss / (1.0 + angle.cos());
        if miss.abs() < 1e-15 {
            break;
        }
    }
    let (height, half) = (wheel * (1.0 - angle.cos()), 0.5 * angle);
    let bend = 1.0 / (4.0 * wheel * half.cos().powi(4));
    Elevation::new(height, [half.tan(), 0.0]).with_hessian([bend, 0.0, 0.0])
}

/// Time of an oscillation of a point in the cycloid that starts at rest at φ.
fn swing_in_cycloid(wheel: f64, angle: f64) -> f64 {
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 200.0,
    };
    let half = 0.5 * angle;
    let normal = DVec3::new(-half.sin(), 0.0, half.cos());
    let place = DVec3::new(angle + angle.sin(), 0.0, 1.0 - angle.cos()) * wheel;
    let start = place - normal * (GRAVITY * half.cos() / law.stiffness);
    swing(
        point_mass(1.0),
        Terrain::of(move |x: f64, _y: f64| cycloid(wheel, x)),
        Frictionless,
        start,
        law,
        // Its first passage and two more.
        2.3 * 4.0 * PI * (wheel / GRAVITY).sqrt(),
    )
}

/// The point runs below the curve, by its weight and its centripetal force, 2 m g at most, over the
/// stiffness, of a radius of curvature of `4 a cos(φ/2)`.
fn miss_in_cycloid(wheel: f64, angle: f64) -> f64 {
    2.0 * GRAVITY / 1e6 / (4.0 * wheel * (0.5 * angle).cos())
}

random! {
    /// Tolerance as in the printed case, and the step's `(ω_c dt)²/24` of the ground's springs,
    /// 1000 rad/s, with their share of the oscillation.
    ANY_CYCLOID = new(16, "wheel of 0.03 to 0.4 m, amplitude of 0.05 to 2.6 rad");
    fn points_in_any_cycloid_swing_at_one_rate_at_every_amplitude(
        wheel in log_uniform(0.03, 0.4),
        angle in log_uniform(0.05, 2.6),
    ) |misses| {
        let expected = 4.0 * PI * (wheel / GRAVITY).sqrt();
        let got = swing_in_cycloid(wheel, angle);
        // The oscillation's own rate over the springs', by the square.
        let soft = GRAVITY / (4.0 * wheel) / 1e6;
        misses.near("period", [got, expected], expected * (miss_in_cycloid(wheel, angle) + soft))?;
    }
}

static CYCLOID: Case = Case::new(
    "I3",
    "`4π √(a/g)` at every amplitude",
    "Huygens, Horologium Oscillatorium (1673)",
    || {
        [0.2, 1.0, 2.0]
            .map(|angle| {
                let got = swing_in_cycloid(WHEEL, angle);
                // Half a unit of the last printed digit.
                let tolerance = 1.269_395 * miss_in_cycloid(WHEEL, angle) + 5e-7;
                figure(
                    format!("cycloid of 0.1 m, from φ = {angle}: period, s"),
                    1.269_395,
                    got,
                    tolerance,
                )
            })
            .to_vec()
    },
)
.and(&[&ANY_CYCLOID]);

#[test]
fn a_point_in_a_cycloid_swings_at_one_rate_at_every_amplitude() {
    CYCLOID.holds();
    let period = 4.0 * PI * (WHEEL / GRAVITY).sqrt();
    assert!((period - 1.269_395).abs() < 5e-7);
}

// -----------------------------------------------------------------------------------------------
// I5: rest on a slope
// -----------------------------------------------------------------------------------------------

/// The trough `z = x²/2`, in metres: its slope is x.
const TROUGH: Terrain<Bowl> = Terrain {
    height_field: Bowl {
        curvatures: [1.0, 0.0],
    },
};

/// Position of a point (x, m) some seconds after it has been released in the trough at x, moving
/// along it.
fn after(x: f64, speed: f64, coefficient: f64, seconds: f64) -> State {
    let law = SpringDamper {
        stiffness: 1e5,
        damping: 300.0,
    };
    let stepper = Stepper::new(point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground { law, shape: TROUGH })
        .unwrap()
        .with_friction(SmoothCoulomb {
            coefficient,
            slip_speed: 1e-6,
        })
        .unwrap()
        .with_integrator(EnergyMomentum { time_step: 1e-3 })
        .unwrap();
    let normal = DVec3::new(-x, 0.0, 1.0).normalize();
    let depth = GRAVITY * normal.z / law.stiffness;
    let mut state = State::at(DVec3::new(x, 0.0, 0.5 * x * x) - normal * depth)
        .with_linear_velocity(DVec3::new(normal.z, 0.0, -normal.x) * speed);
    stepper.advance(&mut state, seconds).unwrap();
    state
}

static REST_IN_A_TROUGH: Case = Case::new(
    "I5",
    "rests where `|∇h| ≤ μ`",
    "Coulomb (1785)",
    || {
        let (mut low, mut high) = (0.2, 0.4);
        for _ in 0..9 {
            let middle = 0.5 * (low + high);
            if middle - after(middle, 0.0, 0.3, 1.0).position.x < 1e-3 {
                low = middle;
            } else {
                high = middle;
            }
        }
        // An excess of slope d is 1 mm in a second at d = 2 mm/(g s²) = 2e-4; then what the
        // bisection leaves.
        vec![figure(
            "trough z = x²/2, μ = 0.3: farthest rest, m",
            0.3,
            low,
            2e-4 + 0.2 / 512.0,
        )]
    },
)
.and(&[&ANY_TROUGH]);

#[test]
fn a_point_in_a_trough_stays_where_the_slope_is_below_the_coefficient() {
    REST_IN_A_TROUGH.holds();
}

random! {
    /// Checks the motion from any position, at any speed along the trough.
    ANY_TROUGH = new(20, "place, speed and μ");
    fn whatever_slides_in_a_trough_comes_to_rest_within_the_coefficient(
        x in -0.9..0.9_f64,
        speed in -2.0..2.0_f64,
        coefficient in 0.1..0.6_f64,
    ) |misses| {
        let state = after(x, speed, coefficient, 8.0);
        misses.within("speed", state.linear_velocity.length(), 1e-5)?;
        // It is released by the ground's depth, m g/k.
        misses.within("place beyond", (state.position.x.abs() - coefficient).max(0.0), 1e-4)?;
    }
}

// -----------------------------------------------------------------------------------------------
// I6: a spherical pendulum
// -----------------------------------------------------------------------------------------------

/// Rotation about the vertical (rad) of a point on a sphere of radius R, from its highest point, at
/// z₁ over the middle with the level speed v, to its lowest and up to its highest again:
/// `φ' = R₁ v/(R² - z²)` with `R₁² = R² - z₁²`, and
/// `R² z'² = 2 g (z₁ - z) (R² - z²) + v² (z₁² - z²) = 2 g (z₁ - z) (z - z₂) (z₃ - z)`, where z₂ and
/// z₃ are the roots of `z² - u z - R² - u z₁`, `u = v²/2g`. With
/// `z = (z₁ + z₂)/2 + (z₁ - z₂)/2 cos s` the integrand of `2 ∫ φ' dz/z'` is smooth and periodic,
/// and the midpoint rule leaves nothing.
fn apsidal_turn(radius: f64, high: f64, speed: f64) -> f64 {
    let u = speed * speed / (2.0 * GRAVITY);
    let root = (0.25 * u * u + radius * radius + u * high).sqrt();
    let (low, third) = (0.5 * u - root, 0.5 * u + root);
    let parts = 400;
    let level = (radius * radius - high * high).sqrt();
    let sum: f64 = (0..parts)
        .map(|part| {
            let cos = ((f64::from(part) + 0.5) * PI / f64::from(parts)).cos();
            let z = 0.5 * (high + low) + 0.5 * (high - low) * cos;
            level * speed * radius
                / ((radius * radius - z * z) * (2.0 * GRAVITY * (third - z)).sqrt())
        })
        .sum();
    2.0 * sum * PI / f64::from(parts)
}

/// Rotation about the vertical of the model in a frictionless bowl of 1 m; from rest but for the
/// level speed at θ from the bottom.
fn turn_in_bowl(theta: f64, speed: f64) -> f64 {
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 0.0,
    };
    let stepper = Stepper::new(point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground {
            law,
            shape: SphericalBowl { radius: 1.0 },
        })
        .unwrap()
        .with_integrator(Rk4 { time_step: 2e-4 })
        .unwrap();
    let (sin, cos) = theta.sin_cos();
    let load = GRAVITY * cos + speed * speed;
    let place = DVec3::new(sin, 0.0, -cos) * (1.0 + load / law.stiffness);
    let mut state = State::at(place).with_linear_velocity(DVec3::Y * speed);
    let (mut azimuth, mut found) = (0.0, 0.0);
    let mut before = (place, 0.0);
    stepper
        .run(&mut state, 3.0, &mut |sample: &Sample<'_>| {
            let now = (sample.state.position, sample.state.linear_velocity.z);
            let more = before.0.with_z(0.0).angle_between(now.0.with_z(0.0));
            azimuth += more;
            // Highest again: the vertical speed falls through 0.
            if before.1 > 0.0 && now.1 <= 0.0 {
                found = azimuth - more * now.1 / (now.1 - before.1);
                return ControlFlow::Break(());
            }
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    found
}

/// The bowl gives way by the load over its stiffness, up to `g + 2 g (1 - cos θ) + v²` over 1e6/s²:
/// so much longer is the pendulum, and so much more or less where it is fast; the turn beyond half
/// a turn is of the first order in that. The step of Runge-Kutta follows the springs, 1000 rad/s,
/// at 0.2 rad: what is left of their oscillation there, a hundredth of the depth, is not seen. A
/// turning point between two steps is known to the second order of one, 2e-4 s: `(ω dt)²` of a
/// radian.
fn miss_of_turn(theta: f64, speed: f64) -> f64 {
    let load = GRAVITY * (3.0 - 2.0 * theta.cos()) + speed * speed;
    2.0 * PI * load / 1e6 + (2e-4 * PI).powi(2)
}

static SPHERICAL_PENDULUM: Case = Case::new(
    "I6",
    "apsides turn by `(3π/4) ab/R²` a period, for small ones; `2 ∫ φ' dz/z'`",
    "Airy, Mem. R. Astron. Soc. 20, 121 (1851); Olsson, Am. J. Phys. 46, 1118 (1978)",
    || {
        // a = 0.2 R at the highest, and b = 0.1 R: v = b √(g/R) to the first order.
        let (theta, speed) = (0.2_f64.asin(), 0.1 * GRAVITY.sqrt());
        let got = turn_in_bowl(theta, speed);
        let exact = apsidal_turn(1.0, -theta.cos(), speed);
        let airy = 0.75 * PI * 0.2 * 0.1;
        vec![
            // The next order: a²/R² and b²/R² of it.
            figure(
                "a = 0.2 R, b = 0.1 R: advance in a period, rad",
                airy,
                2.0 * got - TAU,
                0.05 * airy + 2.0 * miss_of_turn(theta, speed),
            ),
            figure(
                "by the quadrature, rad",
                2.0 * exact - TAU,
                2.0 * got - TAU,
                2.0 * miss_of_turn(theta, speed),
            ),
        ]
    },
)
.and(&[&ANY_PENDULUM]);

#[test]
fn the_apsides_of_a_spherical_pendulum_advance_as_airy_says() {
    SPHERICAL_PENDULUM.holds();
}

random! {
    /// Slower than the cone, where the start is the highest point.
    ANY_PENDULUM = new(24, "amplitude of 0.1 to 1.4 rad, 0.1 to 0.9 of the speed on a cone: the quadrature");
    fn the_apsides_of_any_spherical_pendulum_turn_by_the_quadrature_of_its_energy(
        theta in 0.1..1.4_f64,
        share in 0.1..0.9_f64,
    ) |misses| {
        // On a cone v² = g R sin² θ/cos θ.
        let speed = share * theta.sin() * (GRAVITY / theta.cos()).sqrt();
        let expected = apsidal_turn(1.0, -theta.cos(), speed);
        // A turning point is the flatter, the nearer to the cone.
        let miss = miss_of_turn(theta, speed) / (1.0 - share * share);
        misses.near("turn", [turn_in_bowl(theta, speed), expected], miss)?;
    }
}
