//! `EnergyMomentum` as its formulas state it: Newton's iterations on the momentum balance of a
//! step.
//!
//! ```text
//! m (v' - v)/2 - dt/2 (F + m g) = 0      (L' - L)/2 - dt/2 T = 0
//! v' = 2 vₘ - v                          L' = R (2 J ωₘ - L),     R = cay(a),  a = dt ωₘ/2
//! ```
//! F and T are the mean forces of the contacts on a path of constant rate, with Coulomb's friction
//! at the mean slip. The number of iterations is that which the library has taken. Where its last
//! matrix is accurate enough, the formulas use it again, as the library does. That decision, the
//! energies and the limiter are not counted.

#![allow(
    clippy::needless_range_loop,
    reason = "rows and columns are named by their numbers, as in the formulas"
)]

use super::number::{M, N, Q, V, times, uncounted};
use super::scene::{Point, Scene};

/// Iterations and evaluations of a step of the library.
#[derive(Clone, Copy)]
pub(crate) struct Work {
    pub(crate) iterations: u32,
    pub(crate) evaluations: u32,
}

/// A trial: the unknowns and what follows from them for every contact.
struct Trial {
    /// Mean velocity, m/s.
    velocity: V,
    /// Argument of the Cayley map.
    spin: V,
    shift: V,
    /// `R - 1`.
    change: M,
    end_velocity: V,
    end_momentum: V,
}

/// A contact, as it was when it was last evaluated.
struct Touch {
    point: V,
    /// Arm at the start, m, and depth there. They are computed when the contact is first active.
    start: Option<(V, N)>,
    is_active: bool,
    /// Mean normal force, N, and its derivative by the depth at the end, N/m.
    normal: N,
    stiffness: N,
    slip: V,
    speed: N,
    /// `μ/(|slip| + ε)` and `1/(|slip| + ε)`.
    per_load: N,
    per_width: N,
    force: V,
    arm: V,
    end_arm: V,
    dual: Option<Dual>,
}

/// Friction divided by its limit, as a linear function of the slip.
#[derive(Clone, Copy)]
struct Dual {
    value: V,
    slip: V,
    direction: V,
    per_width: N,
}

/// Rows of the matrix. An entry that no term has reached takes no addition.
struct Matrix([[Option<N>; 6]; 6]);

/// Size of a residual and what the library compares it with.
#[derive(Clone, Copy)]
struct Sizes {
    size: f64,
    tolerance: f64,
}

impl Scene {
    pub(crate) fn energy_momentum(&self, start: &Point, work: Work) -> Point {
        if work.evaluations == 0 {
            return self.flight(start);
        }
        let axes = start.q.axes();
        let mut touches = Vec::from_iter(self.points.iter().map(|&point| Touch::new(point)));
        let spin = self.angular_velocity(axes[0], start.l) * (0.5 * self.dt);
        let fallen = start.v + self.gravity * (0.5 * self.dt);
        let mut trial = self.trial((start, axes[0]), fallen, spin);
        let (mut factors, mut last) = (None, None);
        for evaluation in 0..work.evaluations {
            self.respond(start, &axes, &trial, &mut touches);
            let (force, torque) = self.residual(start, fallen, &trial, &touches);
            if evaluation == work.iterations {
                break;
            }
            let sizes = uncounted(|| self.sizes(start, axes[0], &touches, force, torque));
            let is_enough = last.is_some_and(|last: Sizes| {
                sizes.size * (sizes.size / last.size) <= sizes.tolerance * EXACT
            });
            last = Some(sizes);
            if !is_enough {
                let matrix = self.matrix(&axes[0], &trial, &mut touches);
                factors = Some(Factors::of(matrix));
            }
            let [shift, turn] = factors.as_ref().unwrap().solve(-force, -torque);
            let a = trial.spin;
            let spin = a + (turn - a.cross(turn) + a * a.dot(turn)) * 0.5;
            let velocity = trial.velocity + shift * (1.0 / self.dt);
            trial = self.trial((start, axes[0]), velocity, spin);
        }
        let turn = Q {
            w: N(1.0),
            v: trial.spin,
        };
        let length = (1.0 + trial.spin.dot(trial.spin)).sqrt();
        Point {
            x: start.x + trial.shift,
            v: trial.end_velocity,
            q: turn.turning(start.q).scaled(1.0 / length),
            l: trial.end_momentum,
        }
    }

    /// Exact flight.
    fn flight(&self, start: &Point) -> Point {
        let mean = start.v + self.gravity * (0.5 * self.dt);
        Point {
            x: start.x + mean * self.dt,
            v: start.v + self.gravity * self.dt,
            q: self.turned_freely(start.q, start.l, self.dt),
            l: start.l,
        }
    }

    /// `J ω` for the axis of symmetry at the start of the step.
    fn momentum(&self, axis: V, spin: V) -> V {
        spin * self.moment + axis * (axis.dot(spin) * self.moment_excess)
    }

    fn trial(&self, (start, axis): (&Point, V), velocity: V, spin: V) -> Trial {
        let change = rotation_change(spin);
        let mean = self.momentum(axis, spin) * (4.0 / self.dt);
        let turned = mean - start.l;
        Trial {
            velocity,
            spin,
            shift: velocity * self.dt,
            change,
            end_velocity: velocity * 2.0 - start.v,
            end_momentum: turned + times(&change, turned),
        }
    }

    /// Evaluates the contacts that are active in a trial. The search for them is not counted.
    fn respond(&self, start: &Point, axes: &M, trial: &Trial, touches: &mut [Touch]) {
        for touch in touches {
            touch.is_active = uncounted(|| {
                let arm = times(axes, touch.point);
                let depth = -(start.x.z() + arm.z());
                let moved = trial.shift + times(&trial.change, arm);
                let (force, stiffness) = self.mean_force(depth, depth - moved.z());
                force.0 > 0.0 || stiffness.0 > 0.0
            });
            if touch.is_active {
                touch.respond(self, start, axes, trial);
            }
        }
    }

    /// Mean normal force while the depth changes at a constant rate, and its derivative by the
    /// depth at the end: spring and damper that never pull.
    fn mean_force(&self, start: N, end: N) -> (N, N) {
        let (k, c) = (self.stiffness, self.damping / self.dt);
        let path = end - start;
        if path >= N::ZERO {
            if start >= N::ZERO {
                ((start + end) * (0.5 * k) + path * c, N(0.5 * k + c))
            } else if end > N::ZERO {
                let share = end / path;
                let stiffness = share * (1.0 - share * 0.5) * k + c;
                (end * share * (0.5 * k) + end * c, stiffness)
            } else {
                (N::ZERO, N::ZERO)
            }
        } else if start > N::ZERO {
            let cut = -path * (c / k);
            let (first, last) = (start - cut, end - cut);
            if last >= N::ZERO {
                ((first + last) * (0.5 * k), N(0.5 * k + c))
            } else if first > N::ZERO {
                let share = first / -path;
                let stiffness = share * c + share * share * (0.5 * k);
                (first * share * (0.5 * k), stiffness)
            } else {
                (N::ZERO, N::ZERO)
            }
        } else {
            (N::ZERO, N::ZERO)
        }
    }

    /// Residual of the momentum balance.
    fn residual(&self, start: &Point, fallen: V, trial: &Trial, touches: &[Touch]) -> (V, V) {
        let mut sums: Option<[V; 2]> = None;
        for touch in touches.iter().filter(|touch| touch.is_active) {
            let torque = touch.arm.cross(touch.force);
            sums = Some(match sums {
                Some([force, sum]) => [force + touch.force, sum + torque],
                None => [touch.force, torque],
            });
        }
        let linear = (trial.velocity - fallen) * self.mass;
        let angular = (trial.end_momentum - start.l) * 0.5;
        match sums {
            Some([force, torque]) => {
                let half = 0.5 * self.dt;
                (linear - force * half, angular - torque * half)
            }
            None => (linear, angular),
        }
    }

    /// Derivative of the residual by a shift and a rotation of the end of the step, over `dt/2`.
    fn matrix(&self, axis: &V, trial: &Trial, touches: &mut [Touch]) -> Matrix {
        let mut matrix = Matrix([[None; 6]; 6]);
        let mut strain = 0.0;
        for touch in touches.iter_mut().filter(|touch| touch.is_active) {
            strain += touch.per_load.0 * touch.normal.0 * self.dt / self.mass;
            touch.add_to(&mut matrix, self);
        }
        assert!(strain <= 2.0, "friction is not resolved: {strain}");
        for i in 0..3 {
            matrix.add(i, i, N(self.mass / self.dt));
        }
        // J (1 - â + a aᵀ), and R applied to it.
        let a = trial.spin;
        let o = N::ZERO;
        let hat = [[o, -a.z(), a.y()], [a.z(), o, -a.x()], [-a.y(), a.x(), o]];
        let turned = trial.end_momentum * -0.5;
        let of_turned = [
            [o, turned.z(), -turned.y()],
            [-turned.z(), o, turned.x()],
            [turned.y(), -turned.x(), o],
        ];
        for j in 0..3 {
            let mut column = a * a.0[j];
            for i in 0..3 {
                column.0[i] = if i == j {
                    column.0[i] + 1.0
                } else {
                    column.0[i] + hat[j][i]
                };
            }
            let mean = self.momentum(*axis, column);
            let end = (mean + times(&trial.change, mean)) * (1.0 / self.dt);
            for i in 0..3 {
                let entry = if i == j {
                    end.0[i]
                } else {
                    end.0[i] + of_turned[j][i]
                };
                matrix.add(3 + i, 3 + j, entry);
            }
        }
        matrix
    }

    /// Size of the residual and its tolerance, as the library computes them.
    fn sizes(&self, start: &Point, axis: V, touches: &[Touch], force: V, torque: V) -> Sizes {
        let square = |l: V| l.dot(self.angular_velocity(axis, l)).0;
        let size = (force.dot(force).0 / self.mass + square(torque)).sqrt();
        let own = (start.v.dot(start.v).0 * self.mass + square(start.l)).sqrt();
        let active = touches.iter().filter(|touch| touch.is_active);
        let normal: f64 = active.map(|touch| touch.normal.0).sum();
        let weight = -self.gravity.z().0 * self.mass;
        let scale = own + 0.5 * self.dt * (weight + normal) / self.mass.sqrt();
        Sizes {
            size,
            tolerance: scale * f64::EPSILON.powf(0.75),
        }
    }
}

/// Multiple of the tolerance that counts as rounding.
const EXACT: f64 = 1e-4;

/// `R - 1 = 2 (â + â²)/(1 + |a|²)`.
fn rotation_change(a: V) -> M {
    let [x, y, z] = a.0;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let scale = 2.0 / (1.0 + (xx + yy + zz));
    let (xy, yz, zx) = (x * y, y * z, z * x);
    [
        V([-(yy + zz), xy + z, zx - y]) * scale,
        V([xy - z, -(zz + xx), yz + x]) * scale,
        V([zx + y, yz - x, -(xx + yy)]) * scale,
    ]
}

impl Q {
    /// Product `(1 + v) other` for a quaternion whose scalar part is 1.
    fn turning(self, other: Self) -> Self {
        Self {
            w: other.w - self.v.dot(other.v),
            v: other.v + self.v * other.w + self.v.cross(other.v),
        }
    }
}

impl Touch {
    fn new(point: V) -> Self {
        Self {
            point,
            start: None,
            is_active: false,
            normal: N::ZERO,
            stiffness: N::ZERO,
            slip: V::ZERO,
            speed: N::ZERO,
            per_load: N::ZERO,
            per_width: N::ZERO,
            force: V::ZERO,
            arm: V::ZERO,
            end_arm: V::ZERO,
            dual: None,
        }
    }

    /// Path and force over a trial.
    fn respond(&mut self, scene: &Scene, start: &Point, axes: &M, trial: &Trial) {
        let point = self.point;
        let (arm, depth) = *self.start.get_or_insert_with(|| {
            let arm = times(axes, point);
            (arm, -(start.x.z() + arm.z()))
        });
        let swung = times(&trial.change, arm);
        let moved = trial.shift + swung;
        (self.normal, self.stiffness) = scene.mean_force(depth, depth - moved.z());
        self.end_arm = arm + swung;
        self.arm = (arm + self.end_arm) * 0.5;
        let per_second = 1.0 / scene.dt;
        let [x, y] = [moved.x() * per_second, moved.y() * per_second];
        self.slip = V([x, y, N::ZERO]);
        self.speed = (x * x + y * y).sqrt();
        self.per_width = 1.0 / (self.speed + scene.slip_speed);
        self.per_load = self.per_width * scene.friction;
        let share = -(self.per_load * self.normal);
        self.force = V([x * share, y * share, self.normal]);
    }

    /// Friction divided by its limit, at the slip of the trial.
    fn dual(&mut self, direction: V) -> V {
        let [x, y, _] = self.slip.0;
        let value = match self.dual {
            None => V([x * self.per_width, y * self.per_width, N::ZERO]),
            Some(last) => {
                let change = (x - last.slip.x()) * last.direction.x()
                    + (y - last.slip.y()) * last.direction.y();
                let [p, q] =
                    [0, 1].map(|i| (self.slip.0[i] - last.value.0[i] * change) * last.per_width);
                let square = p * p + q * q;
                if square > N(1.0) {
                    let scale = 1.0 / square.sqrt();
                    V([p * scale, q * scale, N::ZERO])
                } else {
                    V([p, q, N::ZERO])
                }
            }
        };
        self.dual = Some(Dual {
            value,
            slip: self.slip,
            direction,
            per_width: self.per_width,
        });
        value
    }

    /// Adds `-dt/2` times the derivative of force and torque.
    fn add_to(&mut self, matrix: &mut Matrix, scene: &Scene) {
        let per_speed = 1.0 / self.speed;
        let [x, y] = [self.slip.x(), self.slip.y()];
        let u = [x * per_speed, y * per_speed];
        let dual = self.dual(V([u[0], u[1], N::ZERO]));
        let c = self.per_load * self.normal * 0.5;
        let rise = self.stiffness * (0.5 * scene.dt);
        let loaded = -(self.per_load * rise);
        let along = [dual.x() * -c, dual.y() * -c];
        let columns = [
            [along[0] * u[0] + c, along[1] * u[0]],
            [along[0] * u[1], along[1] * u[1] + c],
            [x * loaded, y * loaded],
        ];
        self.add_columns(matrix, columns, rise);
        // (ϑ × r') × F = r' (F · ϑ) - ϑ (F · r'), for half of the arm.
        let force = self.force * (-0.25 * scene.dt);
        let products: [[N; 3]; 3] = self.end_arm.0.map(|arm| force.0.map(|force| arm * force));
        let along = products[0][0] + products[1][1] + products[2][2];
        for i in 0..3 {
            for j in 0..3 {
                let entry = products[i][j];
                matrix.add(3 + i, 3 + j, if i == j { entry - along } else { entry });
            }
        }
    }

    /// Adds force and torque by the shift (`columns`, and `rise` for the normal force) and by the
    /// rotation `ϑ × r'`.
    fn add_columns(&self, matrix: &mut Matrix, [a, b, c]: [[N; 2]; 3], rise: N) {
        let [x, y, z] = self.end_arm.0;
        let combined =
            |p: [N; 2], s: N, q: [N; 2], t: N| [p[0] * s - q[0] * t, p[1] * s - q[1] * t];
        let all = [
            (a, None),
            (b, None),
            (c, Some(rise)),
            (combined(c, y, b, z), Some(rise * y)),
            (combined(a, z, c, x), Some(-(rise * x))),
            (combined(b, x, a, y), None),
        ];
        let [rx, ry, rz] = self.arm.0;
        for (j, ([fx, fy], fz)) in all.into_iter().enumerate() {
            matrix.add(0, j, fx);
            matrix.add(1, j, fy);
            match fz {
                Some(fz) => {
                    matrix.add(2, j, fz);
                    matrix.add(3, j, ry * fz - rz * fy);
                    matrix.add(4, j, rz * fx - rx * fz);
                }
                None => {
                    matrix.add(3, j, -(rz * fy));
                    matrix.add(4, j, rz * fx);
                }
            }
            matrix.add(5, j, rx * fy - ry * fx);
        }
    }
}

impl Matrix {
    fn add(&mut self, row: usize, column: usize, term: N) {
        let entry = &mut self.0[row][column];
        *entry = Some(match *entry {
            Some(sum) => sum + term,
            None => term,
        });
    }
}

/// Triangular factors by Gaussian elimination.
struct Factors {
    rows: [[N; 6]; 6],
    inverse: [N; 6],
}

impl Factors {
    fn of(matrix: Matrix) -> Self {
        let mut rows = matrix
            .0
            .map(|row| row.map(|entry| entry.unwrap_or(N::ZERO)));
        let mut inverse = [N::ZERO; 6];
        for p in 0..6 {
            inverse[p] = 1.0 / rows[p][p];
            let upper = rows[p];
            for row in &mut rows[p + 1..] {
                let factor = row[p] * inverse[p];
                row[p] = factor;
                for column in p + 1..6 {
                    row[column] = row[column] - factor * upper[column];
                }
            }
        }
        Self { rows, inverse }
    }

    fn solve(&self, force: V, torque: V) -> [V; 2] {
        let ([a, b, c], [d, e, f]) = (force.0, torque.0);
        let mut x = [a, b, c, d, e, f];
        for i in 0..6 {
            for j in 0..i {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
        }
        for i in (0..6).rev() {
            for j in i + 1..6 {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
            x[i] = x[i] * self.inverse[i];
        }
        let [a, b, c, d, e, f] = x;
        [V([a, b, c]), V([d, e, f])]
    }
}
