//! The continuous model of the report's coin, integrated independently of the library: where
//! `tests/data/works.csv` comes from.
//!
//! Dormand and Prince's method of order 5 in steps of 5 us. A point is off the ground, pushes, or
//! touches without a push. Which of the three holds is kept through a step, and a step in which it
//! changes for a point ends there, located by halving to the last bit. So the equations are smooth
//! within each step. The works are three more unknowns.

use tumble::glam::{DMat3, DQuat, DVec3};

const STEP: f64 = 5e-6;
const POINTS: usize = 120;
const RADIUS: f64 = 0.5;
const MASS: f64 = 1.0;
const GRAVITY: f64 = 9.8;
const STIFFNESS: f64 = 1000.0;
const DAMPING: f64 = 0.5;

/// Position, velocity, orientation, angular momentum, and the works of friction, dampers and clamp.
type Numbers = [f64; 16];

#[derive(Clone, Copy, PartialEq)]
enum Contact {
    Off,
    Pushes,
    Clamped,
}

pub(crate) struct Coin {
    friction: f64,
    slip_speed: f64,
    /// Moments of inertia, body axes.
    rim: [DVec3; POINTS],
}

/// A coin, its works and its energy at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) works: [f64; 3],
    pub(crate) energy: f64,
}

impl Coin {
    pub(crate) fn new(friction: f64, slip_speed: f64) -> Self {
        let rim = core::array::from_fn(|k| {
            let angle = core::f64::consts::TAU * (k as f64 + 1.0) / POINTS as f64;
            DVec3::new(0.0, RADIUS * angle.cos(), RADIUS * angle.sin())
        });
        Self {
            friction,
            slip_speed,
            rim,
        }
    }

    /// The moments at `times` (s, rising).
    pub(crate) fn moments(&self, start: &tumble::State, times: &[f64]) -> Vec<Moment> {
        let q = start.orientation;
        let (x, v, l) = (
            start.position,
            start.linear_velocity,
            start.angular_momentum,
        );
        let mut y = [
            x.x, x.y, x.z, v.x, v.y, v.z, q.w, q.x, q.y, q.z, l.x, l.y, l.z, 0.0, 0.0, 0.0,
        ];
        let (mut moments, mut begin) = (Vec::new(), 0.0);
        for &end in times {
            let mut left = ((end - begin) / STEP).round();
            while left > 0.0 {
                self.advance(&mut y, STEP);
                left -= 1.0;
            }
            begin = end;
            moments.push(Moment {
                works: [y[13], y[14], y[15]],
                energy: self.energy(&y),
            });
        }
        moments
    }

    /// One step, in parts that end where a contact changes.
    fn advance(&self, y: &mut Numbers, seconds: f64) {
        let mut left = seconds;
        while left > 0.0 {
            let contacts = self.contacts(y);
            let whole = self.step(y, &contacts, left);
            if self.contacts(&whole) == contacts {
                *y = whole;
                return;
            }
            let (mut before, mut after) = (0.0, left);
            while before < 0.5 * (before + after) && 0.5 * (before + after) < after {
                let middle = 0.5 * (before + after);
                if self.contacts(&self.step(y, &contacts, middle)) == contacts {
                    before = middle;
                } else {
                    after = middle;
                }
                // Below the rounding of the positions a shorter step moves nothing.
                if after - before < 1e-19 {
                    break;
                }
            }
            *y = self.step(y, &contacts, after);
            left -= after;
        }
    }

    fn contacts(&self, y: &Numbers) -> [Contact; POINTS] {
        let motion = Motion::of(y);
        core::array::from_fn(|k| {
            let (arm, depth) = motion.point(self.rim[k]);
            let rise = (motion.velocity + motion.spin.cross(arm)).z;
            if depth <= 0.0 {
                Contact::Off
            } else if STIFFNESS * depth - DAMPING * rise > 0.0 {
                Contact::Pushes
            } else {
                Contact::Clamped
            }
        })
    }

    fn step(&self, y: &Numbers, contacts: &[Contact; POINTS], seconds: f64) -> Numbers {
        const ROWS: [&[f64]; 6] = [
            &[1.0 / 5.0],
            &[3.0 / 40.0, 9.0 / 40.0],
            &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
            &[
                19372.0 / 6561.0,
                -25360.0 / 2187.0,
                64448.0 / 6561.0,
                -212.0 / 729.0,
            ],
            &[
                9017.0 / 3168.0,
                -355.0 / 33.0,
                46732.0 / 5247.0,
                49.0 / 176.0,
                -5103.0 / 18656.0,
            ],
            &[
                35.0 / 384.0,
                0.0,
                500.0 / 1113.0,
                125.0 / 192.0,
                -2187.0 / 6784.0,
                11.0 / 84.0,
            ],
        ];
        let mut slopes = vec![self.rates(y, contacts)];
        let mut end = *y;
        for (i, row) in ROWS.iter().enumerate() {
            end = core::array::from_fn(|n| {
                let slope: f64 = row.iter().zip(&slopes).map(|(w, slope)| w * slope[n]).sum();
                y[n] + seconds * slope
            });
            if i < 5 {
                slopes.push(self.rates(&end, contacts));
            }
        }
        end
    }

    fn rates(&self, y: &Numbers, contacts: &[Contact; POINTS]) -> Numbers {
        let motion = Motion::of(y);
        let (mut force, mut torque, mut power) = (DVec3::ZERO, DVec3::ZERO, [0.0; 3]);
        for (k, contact) in contacts.iter().enumerate() {
            if *contact == Contact::Off {
                continue;
            }
            let (arm, depth) = motion.point(self.rim[k]);
            let velocity = motion.velocity + motion.spin.cross(arm);
            if *contact == Contact::Clamped {
                power[2] -= STIFFNESS * depth * velocity.z;
                continue;
            }
            let normal = STIFFNESS * depth - DAMPING * velocity.z;
            let slip = velocity.with_z(0.0);
            let rubs = slip * (-self.friction * normal / (slip.length() + self.slip_speed));
            let total = rubs + DVec3::Z * normal;
            force += total;
            torque += arm.cross(total);
            power[0] += rubs.dot(slip);
            power[1] -= DAMPING * velocity.z * velocity.z;
        }
        let a = force / MASS - DVec3::Z * GRAVITY;
        let (v, w) = (motion.velocity, motion.spin);
        let q = DQuat::from_xyzw(w.x, w.y, w.z, 0.0) * motion.orientation * 0.5;
        let t = torque;
        [
            v.x, v.y, v.z, a.x, a.y, a.z, q.w, q.x, q.y, q.z, t.x, t.y, t.z, power[0], power[1],
            power[2],
        ]
    }

    fn energy(&self, y: &Numbers) -> f64 {
        let motion = Motion::of(y);
        let momentum = DVec3::new(y[10], y[11], y[12]);
        let springs: f64 = (0..POINTS)
            .map(|k| 0.5 * STIFFNESS * motion.point(self.rim[k]).1.max(0.0).powi(2))
            .sum();
        0.5 * MASS * motion.velocity.length_squared()
            + 0.5 * momentum.dot(motion.spin)
            + MASS * GRAVITY * y[2]
            + springs
    }
}

struct Motion {
    height: f64,
    velocity: DVec3,
    orientation: DQuat,
    axes: DMat3,
    spin: DVec3,
}

impl Motion {
    fn of(y: &Numbers) -> Self {
        let orientation = DQuat::from_xyzw(y[7], y[8], y[9], y[6]);
        let axes = DMat3::from_quat(orientation.normalize());
        let momentum = axes.transpose() * DVec3::new(y[10], y[11], y[12]);
        // A ring: m r^2 about its normal, half of it about a diameter.
        let moment = MASS * RADIUS * RADIUS;
        Self {
            height: y[2],
            velocity: DVec3::new(y[3], y[4], y[5]),
            orientation,
            axes,
            spin: axes * (momentum / DVec3::new(moment, 0.5 * moment, 0.5 * moment)),
        }
    }

    /// The arm and the penetration depth of a point of the rim.
    fn point(&self, point: DVec3) -> (DVec3, f64) {
        let arm = self.axes * point;
        (arm, -(self.height + arm.z))
    }
}
