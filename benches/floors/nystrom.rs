//! `Nystrom` as its formulas state it, with the correction of contacts that close or open.

use super::number::{N, Q, V, times, uncounted};
use super::scene::{Load, Point, Scene, Touching};

/// Time of a stage, weights `A` of the pose and `a` of the velocities.
struct Row<const S: usize> {
    time: f64,
    poses: [f64; S],
    speeds: [f64; S],
}

const SECOND: Row<1> = Row {
    time: 1.0 / 4.0,
    poses: [1.0 / 32.0],
    speeds: [1.0 / 4.0],
};
const THIRD: Row<2> = Row {
    time: 5.0 / 8.0,
    poses: [3.0 / 128.0, 11.0 / 64.0],
    speeds: [-5.0 / 16.0, 15.0 / 16.0],
};
const FOURTH: Row<3> = Row {
    time: 1.0,
    poses: [11.0 / 50.0, 1.0 / 35.0, 44.0 / 175.0],
    speeds: [47.0 / 35.0, -12.0 / 7.0, 48.0 / 35.0],
};
const END: Row<4> = Row {
    time: 1.0,
    poses: [1.0 / 10.0, 2.0 / 9.0, 8.0 / 45.0, 0.0],
    speeds: [1.0 / 10.0, 8.0 / 27.0, 64.0 / 135.0, 7.0 / 54.0],
};

/// Motion of a stage and the accelerations there.
struct Stage {
    motion: Motion,
    acceleration: V,
    torque: V,
    /// Second derivative of the quaternion, 1/s².
    bend: Q,
}

#[derive(Clone, Copy)]
struct Motion {
    x: V,
    v: V,
    axes: [V; 3],
    spin: V,
}

impl Scene {
    pub(crate) fn nystrom(&self, start: &Point) -> Point {
        let first = self.stage(start, true);
        let rate = start.q.rate(first.motion.spin * 0.5);
        let second = self.stage(&self.ahead((start, rate), &SECOND, [&first]), false);
        let third = self.ahead((start, rate), &THIRD, [&first, &second]);
        let third = self.stage(&third, false);
        let fourth = self.ahead((start, rate), &FOURTH, [&first, &second, &third]);
        let fourth = self.stage(&fourth, false);
        let end = self.ahead((start, rate), &END, [&first, &second, &third, &fourth]);
        let end = self.corrected([&first, &third, &fourth], end);
        Point {
            q: end.q.normalised(),
            ..end
        }
    }

    fn motion(&self, point: &Point, is_unit: bool) -> Motion {
        let axes = if is_unit {
            point.q.axes()
        } else {
            point.q.axes_of_any_length()
        };
        Motion {
            x: point.x,
            v: point.v,
            axes,
            spin: self.angular_velocity(axes[0], point.l),
        }
    }

    /// `x'' = F/m + g; q'' = (0, J⁻¹ (T - ω × L)) q/2 - ω² q/4`.
    fn stage(&self, point: &Point, is_unit: bool) -> Stage {
        let motion = self.motion(point, is_unit);
        let Motion { x, v, axes, spin } = motion;
        let load = Touching::at(self, x, &axes).load(self, v, spin, None);
        let turn = self.angular_velocity(axes[0], load.torque - spin.cross(point.l));
        Stage {
            motion,
            acceleration: load.force * (1.0 / self.mass) + self.gravity,
            torque: load.torque,
            bend: (point.q.rate(turn * 0.5)).plus(point.q, spin.dot(spin) * -0.25),
        }
    }

    fn ahead<const S: usize>(
        &self,
        (start, rate): (&Point, Q),
        row: &Row<S>,
        stages: [&Stage; S],
    ) -> Point {
        let h = self.dt;
        let (mut point, mut velocity, mut rate) = (*start, start.v, rate);
        for (i, stage) in stages.into_iter().enumerate() {
            if row.poses[i] != 0.0 {
                let pose = N(h * row.poses[i] / row.time);
                velocity = velocity + stage.acceleration * pose;
                rate = rate.plus(stage.bend, pose);
            }
            let speed = N(h * row.speeds[i]);
            point.v = point.v + stage.acceleration * speed;
            point.l = point.l + stage.torque * speed;
        }
        let along = N(h * row.time);
        point.x = point.x + velocity * along;
        point.q = point.q.plus(rate, along);
        point
    }

    /// Corrects the end of the step for contacts that begin or cease to push in it.
    fn corrected(&self, [first, third, last]: [&Stage; 3], end: Point) -> Point {
        let ends = [first.motion, uncounted(|| self.motion(&end, false))];
        let changing = uncounted(|| {
            let pushes =
                |motion: &Motion, i: usize| Side::of(self, motion, self.points[i]).force.0 > 0.0;
            let near =
                [first, last].map(|stage| self.touching(stage.motion.x.z(), &stage.motion.axes));
            let mut near = near.concat();
            near.sort_unstable();
            near.dedup();
            near.retain(|&i| pushes(&ends[0], i) != pushes(&ends[1], i));
            near
        });
        if changing.is_empty() {
            return end;
        }
        let motion = self.motion(&end, false);
        let mut missed = [Missed::NONE; 2];
        for i in changing {
            let motions = [&first.motion, &motion, &third.motion, &last.motion];
            self.add_missed(self.points[i], motions, &mut missed);
        }
        self.with_missed(end, motion.axes[0], &missed)
    }

    /// Adds the error of the stages in `∫ f ds` and in `∫ (1 - s) f ds` for one contact.
    fn add_missed(&self, point: V, motions: [&Motion; 4], missed: &mut [Missed; 2]) {
        let sides = motions.map(|motion| Side::of(self, motion, point));
        let [start, end, third, last] = &sides;
        let path = Path::between(start, end, self.dt);
        let force = |share: N| path.force(self, share);
        let [from, to] = pushing(&path, force, start.force.0 > 0.0);
        let [mut speeds, mut poses] = means(force, from, to);
        let taken = [start.force, force(N(SECOND.time)), third.force, last.force];
        for (i, taken) in taken.into_iter().enumerate() {
            speeds = speeds - taken * END.speeds[i];
            if END.poses[i] != 0.0 {
                poses = poses - taken * END.poses[i];
            }
        }
        let directions = [motions[0], motions[1]].map(|motion| self.direction(motion, point));
        let (rest, half) = (speeds - poses, poses * 0.5);
        missed[0].add(&directions, [poses, rest]);
        missed[1].add(&directions, [half, half]);
    }

    /// Force and torque of a contact per newton of its normal force, to which the friction of this
    /// law is proportional.
    fn direction(&self, motion: &Motion, point: V) -> Load {
        let arm = times(&motion.axes, point);
        let [x, y, _] = (motion.v + motion.spin.cross(arm)).0;
        let share = N(-self.friction) / ((x * x + y * y).sqrt() + self.slip_speed);
        let force = V([x * share, y * share, N(1.0)]);
        Load {
            force,
            torque: arm.cross(force),
        }
    }

    fn with_missed(&self, mut end: Point, axis: V, [speeds, poses]: &[Missed; 2]) -> Point {
        let (h, per_mass) = (self.dt, 1.0 / self.mass);
        let turn = self.angular_velocity(axis, poses.torque);
        end.x = end.x + poses.force * (per_mass * h * h);
        end.q = end.q.plus(end.q.rate(turn * 0.5), N(h * h));
        end.v = end.v + speeds.force * (per_mass * h);
        end.l = end.l + speeds.torque * h;
        end
    }
}

/// Sum of corrections of force and torque.
#[derive(Clone, Copy)]
struct Missed {
    force: V,
    torque: V,
}

impl Missed {
    const NONE: Self = Self {
        force: V::ZERO,
        torque: V::ZERO,
    };

    fn add(&mut self, [first, last]: &[Load; 2], [early, late]: [N; 2]) {
        self.force = self.force + first.force * early + last.force * late;
        self.torque = self.torque + first.torque * early + last.torque * late;
    }
}

/// Depth, closing speed and normal force of a contact in a motion.
struct Side {
    depth: N,
    closing_speed: N,
    force: N,
}

impl Side {
    fn of(scene: &Scene, motion: &Motion, point: V) -> Self {
        let arm = times(&motion.axes, point);
        let depth = -(motion.x.z() + arm.z());
        let [a, b, _] = motion.spin.0;
        let closing_speed = -(motion.v.z() + (a * arm.y() - b * arm.x()));
        Self {
            depth,
            closing_speed,
            force: force_at(scene, depth, closing_speed),
        }
    }
}

fn force_at(scene: &Scene, depth: N, closing_speed: N) -> N {
    if depth > N::ZERO {
        scene.normal_force(depth, closing_speed)
    } else {
        N::ZERO
    }
}

/// Hermite's cubic of the depth over the step.
struct Path {
    start: N,
    end: N,
    start_slope: N,
    square: N,
    cube: N,
    per_second: f64,
}

impl Path {
    fn between(start: &Side, end: &Side, seconds: f64) -> Self {
        let [first, last] = [start, end].map(|side| side.closing_speed * seconds);
        let rise = end.depth - start.depth;
        Self {
            start: start.depth,
            end: end.depth,
            start_slope: first,
            square: 3.0 * rise - 2.0 * first - last,
            cube: first + last - 2.0 * rise,
            per_second: 1.0 / seconds,
        }
    }

    fn at(&self, s: N) -> (N, N) {
        let (square, cube) = (self.square, self.cube);
        (
            self.start + s * (self.start_slope + s * (square + s * cube)),
            self.start_slope + s * (2.0 * square + s * (3.0 * cube)),
        )
    }

    fn force(&self, scene: &Scene, share: N) -> N {
        let (depth, slope) = self.at(share);
        force_at(scene, depth, slope * self.per_second)
    }

    /// Fraction of the step at which the contact passes the surface, by two steps of Newton's
    /// method.
    fn surface(&self) -> Option<N> {
        if (self.start > N::ZERO) == (self.end > N::ZERO) {
            return None;
        }
        let nearer = |share: N| {
            let (depth, slope) = self.at(share);
            share - depth / slope
        };
        let first = nearer(self.start / (self.start - self.end));
        let share = nearer(first);
        let found = (0.0..=1.0).contains(&share.0) && (share.0 - first.0).abs() < 0.03;
        assert!(found, "these scenes need no bisection");
        Some(share)
    }
}

/// Fractions of the step between which a contact pushes.
fn pushing(path: &Path, force: impl Fn(N) -> N, at_start: bool) -> [N; 2] {
    let surface = path.surface();
    if at_start {
        [N::ZERO, edge(force, N::ZERO, surface.unwrap_or(N(1.0)))]
    } else {
        let from = surface.unwrap_or_else(|| edge(force, N(1.0), N::ZERO));
        [from, N(1.0)]
    }
}

/// Fraction at which a force falls to 0: the zero of a chord.
fn edge(force: impl Fn(N) -> N, inside: N, outside: N) -> N {
    let at = |share: f64| {
        let place = inside + (outside - inside) * share;
        (place, force(place))
    };
    for [first, second] in [[0.75, 0.9], [0.5, 0.7]] {
        let (second, less) = at(second);
        if less > N::ZERO {
            let (first, more) = at(first);
            return beyond([first, second], [more, less], outside);
        }
    }
    edge_by_halving(force, inside, outside)
}

fn beyond([first, second]: [N; 2], [more, less]: [N; 2], limit: N) -> N {
    let on = (second - first) * (less / (more - less));
    let rest = limit - second;
    if on.0.abs() < rest.0.abs() && less.0 < more.0 {
        second + on
    } else {
        limit
    }
}

fn edge_by_halving(force: impl Fn(N) -> N, inside: N, outside: N) -> N {
    let (mut near, mut far) = (inside, outside);
    for _ in 0..6 {
        let middle = (near + far) * 0.5;
        if force(middle) > N::ZERO {
            near = middle;
        } else {
            far = middle;
        }
    }
    let last = near - (far - near);
    beyond([last, near], [force(last), force(near)], far)
}

/// `∫ f ds` and `∫ (1 - s) f ds` by Gauss's rule with two points.
fn means(force: impl Fn(N) -> N, from: N, to: N) -> [N; 2] {
    let (middle, half) = ((from + to) * 0.5, (to - from) * 0.5);
    let reach = half * (1.0 / 3.0_f64.sqrt());
    let nodes = [middle - reach, middle + reach];
    let [first, second] = nodes.map(force);
    [
        (first + second) * half,
        (first * (1.0 - nodes[0]) + second * (1.0 - nodes[1])) * half,
    ]
}
