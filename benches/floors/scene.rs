//! The scene of the counts: a body with two equal moments, its points on level ground.

use super::number::{M, N, Q, V, uncounted};
use tumble::glam::{DQuat, DVec3};
use tumble::{State, Trial};

/// Parameters of a scene and products of them, known before the first step.
pub(crate) struct Scene {
    /// Points in body axes, m.
    pub(crate) points: Vec<V>,
    pub(crate) mass: f64,
    /// Moment about the axes across that of symmetry, and what the moment about that axis, the
    /// first one, has more, kg m².
    pub(crate) moment: f64,
    pub(crate) moment_excess: f64,
    /// The same of the inverse moments, 1/(kg m²).
    pub(crate) inverse: f64,
    pub(crate) inverse_excess: f64,
    /// Stiffness (N/m) and damping (N s/m) of a point.
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) slip_speed: f64,
    pub(crate) gravity: V,
    /// Step size, s.
    pub(crate) dt: f64,
}

impl Scene {
    /// The ring of trial 1 with these points, of equal mass.
    pub(crate) fn ring(points: &[DVec3], dt: f64) -> Self {
        let radius = Trial::<f64>::RADIUS;
        let across = 0.5 * Trial::<f64>::MASS * radius * radius;
        let share = 120.0 / points.len() as f64;
        let friction = super::scenes::trial_1().friction();
        Self {
            points: points.iter().map(|point| V::of(point.to_array())).collect(),
            mass: Trial::<f64>::MASS,
            moment: across,
            moment_excess: across,
            inverse: 1.0 / across,
            inverse_excess: 0.5 / across - 1.0 / across,
            stiffness: Trial::<f64>::STIFFNESS * share,
            damping: Trial::<f64>::DAMPING * share,
            friction: friction.coefficient,
            slip_speed: friction.slip_speed,
            gravity: V::of([0.0, 0.0, -Trial::<f64>::GRAVITY]),
            dt,
        }
    }

    /// Angular velocity for the axis of symmetry: `L/I + s (a·L) a`.
    pub(crate) fn angular_velocity(&self, axis: V, momentum: V) -> V {
        momentum * self.inverse + axis * (axis.dot(momentum) * self.inverse_excess)
    }

    /// Numbers of the points that touch, found beforehand: the search is no part of the formulas.
    pub(crate) fn touching(&self, height: N, axes: &M) -> Vec<usize> {
        let touches = |point: &V| 0.0 - (height + super::number::times(axes, *point).z()) > N::ZERO;
        uncounted(|| {
            let points = self.points.iter().enumerate();
            points
                .filter(|(_, point)| touches(point))
                .map(|(i, _)| i)
                .collect()
        })
    }

    /// Force of a point on the body, for its depth and its velocity: spring and damper that never
    /// pull, and Coulomb's friction that becomes viscous at small slip.
    pub(crate) fn push(&self, depth: N, velocity: V) -> V {
        let normal = self.normal_force(depth, -velocity.z());
        let [x, y, _] = velocity.0;
        let slip = (x * x + y * y).sqrt();
        let share = normal * -self.friction / (slip + self.slip_speed);
        V([x * share, y * share, normal])
    }

    /// Force of spring and damper, which never pulls.
    pub(crate) fn normal_force(&self, depth: N, closing_speed: N) -> N {
        (depth * self.stiffness + closing_speed * self.damping).at_least(0.0)
    }
}

/// State of counting numbers, or its time derivative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) x: V,
    pub(crate) v: V,
    pub(crate) q: Q,
    pub(crate) l: V,
}

impl Point {
    pub(crate) fn of(state: &State) -> Self {
        let q = state.orientation.normalize();
        Self {
            x: V::of(state.position.to_array()),
            v: V::of(state.linear_velocity.to_array()),
            q: Q {
                w: N(q.w),
                v: V::of([q.x, q.y, q.z]),
            },
            l: V::of(state.angular_momentum.to_array()),
        }
    }

    pub(crate) fn to_state(self) -> State {
        let vector = |v: V| DVec3::from_array(v.0.map(|n| n.0));
        let [x, y, z] = self.q.v.0.map(|n| n.0);
        State {
            position: vector(self.x),
            linear_velocity: vector(self.v),
            orientation: DQuat::from_xyzw(x, y, z, self.q.w.0),
            angular_momentum: vector(self.l),
        }
    }

    /// Returns `self + slope seconds`, number by number.
    pub(crate) fn plus(&self, slope: &Self, seconds: N) -> Self {
        Self {
            x: self.x + slope.x * seconds,
            v: self.v + slope.v * seconds,
            q: self.q.plus(slope.q, seconds),
            l: self.l + slope.l * seconds,
        }
    }
}

/// Force and torque of the points that touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) force: V,
    pub(crate) torque: V,
}

impl Load {
    const NONE: Self = Self {
        force: V::ZERO,
        torque: V::ZERO,
    };
}

/// Points that touch at a pose, with their arms and depths.
pub(crate) struct Touching {
    arms: Vec<V>,
    depths: Vec<N>,
}

impl Touching {
    pub(crate) fn at(scene: &Scene, position: V, axes: &M) -> Self {
        let touching = scene.touching(position.z(), axes);
        let arms = Vec::from_iter(
            touching
                .iter()
                .map(|&i| super::number::times(axes, scene.points[i])),
        );
        let depths = arms.iter().map(|arm| -(position.z() + arm.z())).collect();
        Self { arms, depths }
    }

    /// Force and torque for the velocities of the body, with other arms for the torque if these are
    /// given.
    pub(crate) fn load(&self, scene: &Scene, velocity: V, spin: V, others: Option<&[V]>) -> Load {
        let mut load = Load::NONE;
        for (i, (&arm, &depth)) in self.arms.iter().zip(&self.depths).enumerate() {
            let force = scene.push(depth, velocity + spin.cross(arm));
            let arm = others.map_or(arm, |others| others[i]);
            let torque = arm.cross(force);
            // The first one is the sum so far.
            load = if i == 0 {
                Load { force, torque }
            } else {
                Load {
                    force: load.force + force,
                    torque: load.torque + torque,
                }
            };
        }
        load
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.arms.is_empty()
    }
}
