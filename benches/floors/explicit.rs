//! The explicit methods as their formulas state them.

use super::number::{N, Q, V, times, uncounted};
use super::scene::{Load, Point, Scene, Touching};

/// Cosine and `sin(h)/h` by the terms of their series that `h²` needs.
fn cos_and_sinc(square: N) -> (N, N) {
    let largest = square.0;
    let series = |coefficients: &[f64]| {
        let (last, others) = coefficients.split_last().unwrap();
        let sum = others
            .iter()
            .rev()
            .fold(N(*last), |sum, &c| sum * square + c);
        sum * square + 1.0
    };
    let cos = [
        -0.5,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40320.0,
        -1.0 / 3628800.0,
    ];
    let sinc = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362880.0,
        -1.0 / 39916800.0,
    ];
    // As many terms as the next one is below rounding.
    let terms = match largest {
        s if s < 1.0 / 65536.0 => 2,
        s if s < 1.0 / 1024.0 => 4,
        _ => 5,
    };
    assert!(
        largest < 0.01,
        "a step rotates the body too far for these series"
    );
    (series(&cos[..terms]), series(&sinc[..terms]))
}

impl Scene {
    /// Exact rotation without torque: `exp(h L/I) q exp(h s (a·L) i)`, with halves of the angles.
    pub(crate) fn turned_freely(&self, q: Q, momentum: V, seconds: f64) -> Q {
        let half = 0.5 * seconds;
        let precession = momentum * (self.inverse * half);
        let (cos, sinc) = cos_and_sinc(precession.dot(precession));
        let turn = Q {
            w: cos,
            v: precession * sinc,
        };
        let spin = q.first_axis().dot(momentum) * (self.inverse_excess * half);
        let (cos, sinc) = cos_and_sinc(spin * spin);
        turn.times(q.scaled(cos).plus(q.times_first_axis(), spin * sinc))
    }

    fn accelerated(&self, velocity: V, force: V, seconds: f64) -> V {
        velocity + (force * (1.0 / self.mass) + self.gravity) * seconds
    }

    /// `ω = J⁻¹ L; q' = exp(dt ω) q; x' = x + dt v; v' = v + dt (F/m + g); L' = L + dt Σ r' × F`.
    pub(crate) fn forward_euler(&self, start: &Point) -> Point {
        let axes = start.q.axes();
        let spin = self.angular_velocity(axes[0], start.l);
        let half = spin * (0.5 * self.dt);
        let (cos, sinc) = cos_and_sinc(half.dot(half));
        let q = Q {
            w: cos,
            v: half * sinc,
        }
        .times(start.q);
        let touching = Touching::at(self, start.x, &axes);
        let load = if touching.is_empty() {
            touching.load(self, start.v, spin, None)
        } else {
            let axes_after = q.axes();
            let numbers = self.touching(start.x.z(), &axes);
            let arms = Vec::from_iter(numbers.iter().map(|&i| times(&axes_after, self.points[i])));
            touching.load(self, start.v, spin, Some(&arms))
        };
        Point {
            x: start.x + start.v * self.dt,
            v: self.accelerated(start.v, load.force, self.dt),
            q,
            l: start.l + load.torque * self.dt,
        }
    }

    /// `v' = v + dt (F/m + g); L' = L + dt T; x' = x + dt v'`, and the exact rotation by `L'`.
    pub(crate) fn symplectic_euler(&self, start: &Point) -> Point {
        let load = self.load_at(start.x, start.q, start.v, start.l);
        let v = self.accelerated(start.v, load.force, self.dt);
        let l = start.l + load.torque * self.dt;
        Point {
            x: start.x + v * self.dt,
            v,
            q: self.turned_freely(start.q, l, self.dt),
            l,
        }
    }

    /// Load at a pose of a unit quaternion. In flight it takes no operation.
    fn load_at(&self, position: V, q: Q, velocity: V, momentum: V) -> Load {
        let axes = uncounted(|| q.axes());
        if self.touching(position.z(), &axes).is_empty() {
            return Load {
                force: V::ZERO,
                torque: V::ZERO,
            };
        }
        let axes = q.axes();
        let spin = self.angular_velocity(axes[0], momentum);
        Touching::at(self, position, &axes).load(self, velocity, spin, None)
    }

    /// Half a free flight, a kick by the midpoint rule, half a free flight.
    pub(crate) fn strang_splitting(&self, start: &Point) -> Point {
        let half = 0.5 * self.dt;
        let x = start.x + start.v * half;
        let q = self.turned_freely(start.q, start.l, half);
        let axes = uncounted(|| q.axes());
        let (mut v, mut l) = (start.v, start.l);
        if self.touching(x.z(), &axes).is_empty() {
            v = v + self.gravity * self.dt;
        } else {
            let axes = q.axes();
            let touching = Touching::at(self, x, &axes);
            let load_at = |v, l| touching.load(self, v, self.angular_velocity(axes[0], l), None);
            let load = load_at(v, l);
            let middle = self.accelerated(v, load.force, half);
            let load = load_at(middle, l + load.torque * half);
            v = self.accelerated(v, load.force, self.dt);
            l = l + load.torque * self.dt;
        }
        Point {
            x: x + v * half,
            v,
            q: self.turned_freely(q, l, half),
            l,
        }
    }

    /// The classical method, `q` of length 1 at the end.
    pub(crate) fn rk4(&self, start: &Point) -> Point {
        let dt = self.dt;
        let k1 = self.slope(start, true);
        let k2 = self.slope(&start.plus(&k1, N(0.5 * dt)), false);
        let k3 = self.slope(&start.plus(&k2, N(0.5 * dt)), false);
        let k4 = self.slope(&start.plus(&k3, N(dt)), false);
        let sum = k1.sum(&k4).plus(&k2.sum(&k3), N(2.0));
        let end = start.plus(&sum, N(dt / 6.0));
        Point {
            q: end.q.normalised(),
            ..end
        }
    }

    fn slope(&self, point: &Point, is_unit: bool) -> Point {
        let axes = if is_unit {
            point.q.axes()
        } else {
            point.q.axes_of_any_length()
        };
        let spin = self.angular_velocity(axes[0], point.l);
        let load = Touching::at(self, point.x, &axes).load(self, point.v, spin, None);
        Point {
            x: point.v,
            v: load.force * (1.0 / self.mass) + self.gravity,
            q: point.q.rate(spin * 0.5),
            l: load.torque,
        }
    }
}

impl Point {
    fn sum(&self, other: &Self) -> Self {
        Self {
            x: self.x + other.x,
            v: self.v + other.v,
            q: Q {
                w: self.q.w + other.q.w,
                v: self.q.v + other.q.v,
            },
            l: self.l + other.l,
        }
    }
}
