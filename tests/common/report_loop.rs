//! The time loop of the report "Special Topics: Coin Project", line by line.
//!
//! A yardstick for the library, and on purpose not part of it: arrays of points `X` and `U`, the
//! inertia summed over the points in every step and solved as a 3x3 system, the arms turned by
//! Rodrigues' formula, the forces taken from the points as they stood after the step before (so the
//! slip velocity lags by one step; in the first step it is zero, whatever the spin). Every quantity
//! is updated in the order of the listing. Nothing here is tuned and nothing is repaired: the loop
//! gains energy in flight, divides by zero at rest and lets the points drift apart, as the report's
//! does. The comments in quotation marks are lines of the report's listing, whose names the
//! variables keep.
//!
//! Tests, benches and the example share the file by `#[path]`; it depends on nothing but `std`. SI
//! units throughout.

// Each user of the file calls another part of it.
#![allow(dead_code)]

use core::f64::consts::{PI, TAU};

/// `M_total= 1`, kg.
pub(crate) const MASS: f64 = 1.0;
/// `radius = 0.5`, m.
pub(crate) const RADIUS: f64 = 0.5;
/// `g = 9.8`, m/s^2.
pub(crate) const GRAVITY: f64 = 9.8;
/// `10^-10`, m/s, which the report adds to the slip speed before it divides by it.
pub(crate) const SLIP_SPEED: f64 = 1e-10;

/// Which axis of the coin the first angular momentum lies along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Along the coin's normal: the coin rolls.
    Rolling,
    /// Along the coin's steepest diameter: the coin spins on its edge.
    Spinning,
}

/// Parameters that the report varies, and those that it keeps fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReportTrial {
    /// Rolling or spinning.
    pub(crate) direction: Direction,
    /// `angle`: of the coin from the vertical, rad.
    pub(crate) tilt: f64,
    /// `mu`.
    pub(crate) coefficient: f64,
    /// Size of the first `L`, kg m^2/s.
    pub(crate) angular_momentum: f64,
    /// `D`, N s/m a point.
    pub(crate) damping: f64,
    /// `S`, N/m a point.
    pub(crate) stiffness: f64,
    /// `num_points`.
    pub(crate) points: usize,
    /// `dt`, s.
    pub(crate) time_step: f64,
}

impl ReportTrial {
    /// Trial 1 to 8 of the report with its own points and time step; `None` for any other number.
    pub(crate) fn numbered(trial: usize) -> Option<Self> {
        use Direction::{Rolling, Spinning};
        let (direction, tilt, coefficient, angular_momentum) = match trial {
            1 => (Rolling, PI / 12.0, 0.3, 1.0),
            2 => (Rolling, PI / 12.0, 0.3, 1.5),
            3 => (Rolling, PI / 12.0, 0.8, 1.0),
            4 => (Spinning, 0.0, 0.3, 1.0),
            5 => (Spinning, PI / 12.0, 0.1, 1.5),
            6 => (Spinning, 0.0, 0.3, 5.0),
            7 => (Spinning, PI / 12.0, 0.3, 5.0),
            8 => (Spinning, PI / 12.0, 0.3, 1.0),
            _ => return None,
        };
        Some(Self {
            direction,
            tilt,
            coefficient,
            angular_momentum,
            damping: 0.5,
            stiffness: 1000.0,
            points: 120,
            time_step: 1e-4,
        })
    }
}

type Vector = [f64; 3];
type Matrix = [[f64; 3]; 3];

/// State of the report's program between two passes of its loop.
#[derive(Clone, Debug)]
pub(crate) struct ReportLoop {
    trial: ReportTrial,
    steps: u64,
    /// `M`: mass of a point (all are equal).
    point_mass: f64,
    /// `X`: the points.
    x: Vec<Vector>,
    /// `U`: their velocities.
    u: Vec<Vector>,
    /// `Xrel`: the arms.
    xrel: Vec<Vector>,
    /// `Urel`: velocities of the points about the centre.
    urel: Vec<Vector>,
    /// `Xcm`: the centre.
    xcm: Vector,
    /// `Ucm`: its velocity.
    ucm: Vector,
    /// `L`: angular momentum about the centre, world axes.
    l: Vector,
    /// `I`, as it was at the start of the last step.
    inertia: Matrix,
    /// `Omega`, as it was at the start of the last step.
    omega: Vector,
    /// `F_normal_point` of the last step.
    normal_force: Vec<f64>,
    /// `F_friction` of the last step.
    friction: Vec<Vector>,
    /// `Utan` of the last step: tangential velocities of the points before it.
    utan: Vec<Vector>,
}

impl ReportLoop {
    /// The coin as the report sets it up before its loop.
    pub(crate) fn new(trial: ReportTrial) -> Self {
        let n = trial.points;
        let (sin, cos) = trial.tilt.sin_cos();
        // "roty = @(t) [cos(t) 0 sin(t) ; 0 1 0 ; -sin(t) 0 cos(t)]"
        let tilted = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
        // "initial_pos = [0,0,radius*cos(angle)]"
        let start = [0.0, 0.0, RADIUS * cos];
        // "theta = num * 2 * pi / num_points; X(num,:) = [0,radius*cos(theta),radius*sin(theta)]"
        // "X = (R*X')'; X = X+initial_pos"
        let x: Vec<Vector> = (1..=n)
            .map(|num| num as f64 * TAU / n as f64)
            .map(|theta| [0.0, RADIUS * theta.cos(), RADIUS * theta.sin()])
            .map(|point| plus(times(&tilted, point), start))
            .collect();
        // "L = 1*(R*[1 0 0]')"
        let axis = match trial.direction {
            Direction::Rolling => [1.0, 0.0, 0.0],
            Direction::Spinning => [0.0, 0.0, 1.0],
        };
        let l = scaled(times(&tilted, axis), trial.angular_momentum);
        // "Xcm = (1/M_total)*sum((M.*X)); Xrel = X-Xcm"
        let point_mass = MASS / n as f64;
        let xcm = x.iter().fold([0.0; 3], |sum, &point| {
            plus(sum, scaled(point, point_mass / MASS))
        });
        let xrel = x.iter().map(|&point| minus(point, xcm)).collect();
        Self {
            trial,
            steps: 0,
            point_mass,
            x,
            u: vec![[0.0; 3]; n],
            xrel,
            urel: vec![[0.0; 3]; n],
            xcm,
            ucm: [0.0; 3],
            l,
            inertia: [[0.0; 3]; 3],
            omega: [0.0; 3],
            normal_force: vec![0.0; n],
            friction: vec![[0.0; 3]; n],
            utan: vec![[0.0; 3]; n],
        }
    }

    /// One pass of the report's loop.
    pub(crate) fn step(&mut self) {
        let dt = self.trial.time_step;
        // "% Compute I", "Omega = I\L"
        self.inertia = self.sum_inertia();
        self.omega = solve(self.inertia, self.l);
        // "Xrel = ...", "Urel = cross(Omega, Xrel)"
        self.turn_arms();
        // "Xcm=Xcm +dt*Ucm": the old velocity.
        self.xcm = plus(self.xcm, scaled(self.ucm, dt));
        // "F_normal_point = ...", "F_friction = ...": the old points and their old velocities.
        self.press_and_rub();
        // "Ucm=Ucm+dt*force./M_total", "L = L + dt*net_torque'": the new arms, the old forces.
        let (force, net_torque) = self.sum_force_and_torque();
        self.ucm = plus(self.ucm, scaled(force, dt / MASS));
        self.l = plus(self.l, scaled(net_torque, dt));
        // "X = Xcm + Xrel; U = Ucm + Urel"
        for i in 0..self.x.len() {
            self.x[i] = plus(self.xcm, self.xrel[i]);
            self.u[i] = plus(self.ucm, self.urel[i]);
        }
        self.steps += 1;
    }

    /// "I = I + M(k).*( (norm(Xrel(k,:))^2).*eye(3) - Xrel(k,:)'*Xrel(k,:) )"
    fn sum_inertia(&self) -> Matrix {
        let mut inertia = [[0.0; 3]; 3];
        for arm in &self.xrel {
            let square = dot(*arm, *arm);
            for (row, line) in inertia.iter_mut().enumerate() {
                for (column, entry) in line.iter_mut().enumerate() {
                    let diagonal = if row == column { square } else { 0.0 };
                    *entry += self.point_mass * (diagonal - arm[row] * arm[column]);
                }
            }
        }
        inertia
    }

    /// Rodrigues' formula: "Xrel = ( P_Omega*(Xrel') + cos(norm(Omega)*dt).*(eye(3) -
    /// P_Omega)*(Xrel')
    /// + sin(norm(Omega)*dt).*(Omega_cross*(Xrel'))./norm(Omega) )'". Not a number without spin, as
    ///   in the report.
    fn turn_arms(&mut self) {
        let rate = norm(self.omega);
        let (sin, cos) = (rate * self.trial.time_step).sin_cos();
        // "unit_Omega = Omega/norm(Omega); P_Omega = unit_Omega*unit_Omega'"
        let unit_omega = scaled(self.omega, 1.0 / rate);
        let mut along = [[0.0; 3]; 3];
        let mut across = [[0.0; 3]; 3];
        for row in 0..3 {
            for column in 0..3 {
                let identity = if row == column { 1.0 } else { 0.0 };
                along[row][column] = unit_omega[row] * unit_omega[column];
                across[row][column] = cos * (identity - along[row][column]);
            }
        }
        for (arm, velocity) in self.xrel.iter_mut().zip(&mut self.urel) {
            let swept = scaled(cross(self.omega, *arm), sin / rate);
            *arm = plus(plus(times(&along, *arm), times(&across, *arm)), swept);
            // "Urel = cross((Omega'.*ones(num_points,3)),(Xrel))": the old rate, the new arms.
            *velocity = cross(self.omega, *arm);
        }
    }

    /// The forces of the ground on the points as they stood after the step before.
    fn press_and_rub(&mut self) {
        let ReportTrial {
            stiffness,
            damping,
            coefficient,
            ..
        } = self.trial;
        for i in 0..self.x.len() {
            let (x, u) = (self.x[i], self.u[i]);
            // "F_normal_point = ((X(:,3)<0).*(S*(-X(:,3))-D*U(:,3)))"
            let pressed = if x[2] < 0.0 {
                stiffness * -x[2] - damping * u[2]
            } else {
                0.0
            };
            // "F_normal_point = (F_normal_point > 0).*F_normal_point"
            self.normal_force[i] = if pressed > 0.0 { pressed } else { 0.0 };
            // "Utan = [U(:,1),U(:,2),zeros(num_points,1)]", "Utan_norm = (vecnorm(Utan')' +
            // 10^-10)*[1,1,1]"
            self.utan[i] = [u[0], u[1], 0.0];
            let utan_norm = norm(self.utan[i]) + SLIP_SPEED;
            // "Utan_unit = Utan./Utan_norm", "F_friction = - mu*F_normal_point.*Utan_unit"
            let rubbing = -coefficient * self.normal_force[i];
            self.friction[i] = scaled(self.utan[i], rubbing / utan_norm);
        }
    }

    /// `force` and `net_torque`.
    fn sum_force_and_torque(&self) -> (Vector, Vector) {
        let (mut force, mut net_torque) = ([0.0; 3], [0.0; 3]);
        for i in 0..self.x.len() {
            // "force_z = (-M)*g + F_normal_point"
            let force_z = -self.point_mass * GRAVITY + self.normal_force[i];
            let force_point = [self.friction[i][0], self.friction[i][1], force_z];
            force = plus(force, force_point);
            // "torque = cross(Xrel,force_point)"
            net_torque = plus(net_torque, cross(self.xrel[i], force_point));
        }
        (force, net_torque)
    }

    /// The trial that runs.
    pub(crate) fn trial(&self) -> &ReportTrial {
        &self.trial
    }

    /// Simulated time, s.
    pub(crate) fn time(&self) -> f64 {
        self.steps as f64 * self.trial.time_step
    }

    /// The centre of mass, m.
    pub(crate) fn centre(&self) -> [f64; 3] {
        self.xcm
    }

    /// Velocity of the centre of mass, m/s.
    pub(crate) fn velocity(&self) -> [f64; 3] {
        self.ucm
    }

    /// Angular momentum about the centre of mass, world axes, kg m^2/s.
    pub(crate) fn angular_momentum(&self) -> [f64; 3] {
        self.l
    }

    /// Vector from the centre to point `num`, m. Points count from 1, as in the report.
    pub(crate) fn arm(&self, num: usize) -> [f64; 3] {
        self.xrel[num - 1]
    }

    /// `Esave`, J: the report's energy, which mixes the rotation at the start of the step with the
    /// rest at its end, and counts the springs of those points only that pushed in the step.
    pub(crate) fn energy(&self) -> f64 {
        // "energy_ground = energy_ground + 0.5*S*X(i,3)^2" where "F_normal_point(i) > 0"
        let energy_ground = (self.x.iter().zip(&self.normal_force))
            .filter(|(_, force)| **force > 0.0)
            .fold(0.0, |sum, (x, _)| {
                sum + 0.5 * self.trial.stiffness * x[2] * x[2]
            });
        // "Esave(clock)= M_total*g*Xcm(3) + 0.5*M_total*norm(Ucm)^2 + 0.5*Omega'*I*Omega +
        // energy_ground"
        let rotation = 0.5 * dot(self.omega, times(&self.inertia, self.omega));
        self.energy_of_centre() + rotation + energy_ground
    }

    /// Energy of the state as it stands, J: the rotation of now, and the springs of all points
    /// below the ground.
    pub(crate) fn full_energy(&self) -> f64 {
        let springs = (self.x.iter().filter(|x| x[2] < 0.0))
            .fold(0.0, |sum, x| sum + 0.5 * self.trial.stiffness * x[2] * x[2]);
        let omega = solve(self.sum_inertia(), self.l);
        self.energy_of_centre() + 0.5 * dot(omega, self.l) + springs
    }

    fn energy_of_centre(&self) -> f64 {
        MASS * GRAVITY * self.xcm[2] + 0.5 * MASS * dot(self.ucm, self.ucm)
    }

    /// "[values,index] = min(X)": number (from 1) and position of the lowest point, the first of
    /// them if there are several.
    pub(crate) fn lowest_point(&self) -> (usize, [f64; 3]) {
        let mut lowest = 0;
        for i in 1..self.x.len() {
            if self.x[i][2] < self.x[lowest][2] {
                lowest = i;
            }
        }
        (lowest + 1, self.x[lowest])
    }

    /// `UtanSave`, m/s: the slip that the last step's friction of the now lowest point was computed
    /// from.
    pub(crate) fn slip(&self) -> [f64; 3] {
        self.utan[self.lowest_point().0 - 1]
    }

    /// Number of points below the ground.
    pub(crate) fn touching(&self) -> usize {
        self.x.iter().filter(|x| x[2] < 0.0).count()
    }

    /// Cosine of the angle between the coin's normal and the vertical: 0 upright, 1 or -1 flat.
    pub(crate) fn normal_height(&self) -> f64 {
        // The points n/4 and n stand at right angles where four divides n.
        let n = self.trial.points;
        let (quarter, last) = (self.arm(n / 4), self.arm(n));
        cross(last, quarter)[2] / (RADIUS * RADIUS)
    }
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn scaled(a: Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn times(m: &Matrix, a: Vector) -> Vector {
    [dot(m[0], a), dot(m[1], a), dot(m[2], a)]
}

/// `I\L` by Gaussian elimination; the largest pivot comes first. Not a number for points on a line.
fn solve(mut m: Matrix, mut b: Vector) -> Vector {
    for pivot in 0..3 {
        let best = (pivot + 1..3).fold(pivot, |best, row| {
            if m[row][pivot].abs() > m[best][pivot].abs() {
                row
            } else {
                best
            }
        });
        m.swap(pivot, best);
        b.swap(pivot, best);
        let (leading, known) = (m[pivot], b[pivot]);
        for row in pivot + 1..3 {
            let factor = m[row][pivot] / leading[pivot];
            m[row] = minus(m[row], scaled(leading, factor));
            b[row] -= factor * known;
        }
    }
    let z = b[2] / m[2][2];
    let y = (b[1] - m[1][2] * z) / m[1][1];
    let x = (b[0] - m[0][1] * y - m[0][2] * z) / m[0][0];
    [x, y, z]
}
