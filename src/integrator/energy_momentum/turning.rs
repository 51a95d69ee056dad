//! Resistance to rolling and spinning at a fixed pose: half of it before a step, half of it after.
//!
//! ```text
//! (I + h Σ K) ω' = I ω,     K = k_r (1 - n nᵀ) + k_d n nᵀ,     k_r, k_d >= 0
//! ```
//!
//! The equation is backward Euler, for all contacts at once. `k_r` and `k_d` are the resistances to
//! rolling and to spinning, which fit the law at ω' after a few passes. For any `k_r, k_d >= 0` the
//! rotational energy decreases, by `h (2 ω'ᵀ Σ K ω' + ...)/2`, as for the impulses of
//! [`resist`](super::resist). If the computed energy is not lower because of rounding, the state is
//! not changed. On a ground that rotates, ω is relative to it.

use super::shared::{motion_of, visit_contacts};
use super::work;
use crate::contact::Motion;
use crate::energy::Energy;
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::integrator::interface::Step;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Number of passes that fit the resistances to the law. No pass increases the energy.
const PASSES: u32 = 6;

/// Number of groups of contacts that are kept for the passes. A floor with three walls needs as
/// many.
const GROUPS: usize = 4;

/// Effect of one contact's law on the angular momentum in a time h: the columns of `h K`. The
/// change is h times the torque, `h K ω`.
type Columns<R> = [<R as Real>::Vec3; 3];

/// Applies the resistance of the contacts to rotation for a time (s) to the state and its energy.
/// Both stay unchanged if the friction law has no such resistance.
#[inline]
pub(super) fn resisted<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) {
    if scene.friction().rolling_resistance(R::ZERO).is_none() {
        return;
    }
    let slowed = slowed(scene, state, seconds);
    if slowed.not_finite().is_some() {
        return;
    }
    // The pose is that of `state`, and so are the springs.
    let lower = Energy {
        springs: energy.springs,
        ..Energy::without_springs(scene, &slowed)
    };
    let work = work::of_impulse(scene, state.position, [state, &slowed]);
    if lower.total() <= energy.total() + work {
        (*state, *energy) = (slowed, lower);
        step.drive_work += work;
    }
}

fn slowed<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> State<R> {
    let motion = motion_of(scene, state);
    let groups = Groups::of(scene, &motion);
    if groups.is_empty() {
        return *state;
    }
    let properties = scene.inertia_properties();
    let (inertia, momentum) = properties.inertia_for_solving(&motion.axes, state.angular_momentum);
    let before = scene.contact_model().seen(&motion).angular_velocity;
    let mut after = before;
    let mut taken = R::Vec3::ZERO;
    for _ in 0..PASSES {
        let resistance = groups.resistance(scene, &motion, after, seconds);
        let resisted = times::<R>(&resistance, before);
        if resisted == R::Vec3::ZERO {
            return *state;
        }
        let change = solved::<R>(sum::<R>(&inertia, &resistance), -resisted);
        taken = times::<R>(&inertia, change);
        let fitted = before + change;
        if fitted == after {
            break;
        }
        after = fitted;
    }
    State {
        angular_momentum: properties.without_dead_spin(state.rotation(), momentum + taken),
        ..*state
    }
}

/// Calls `visit` with the normal and the resistance of each contact that touches.
fn visit_laws<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    visit: &mut dyn FnMut(R::Vec3, RollingResistance<R>),
) {
    visit_contacts(scene, motion, &mut |contact| {
        let (ground, friction) = contact.laws(scene.ground(), scene.friction());
        let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
        if let Some(law) = friction.rolling_resistance_at(contact.position, normal_force) {
            let law = RollingResistance {
                rolling: law.rolling * contact.weight,
                spinning: law.spinning * contact.weight,
                ..law
            };
            visit(contact.normal, law);
        }
    });
}

/// Resistances of the contacts, found in one visit. Contacts with the same normal and the same turn
/// speed resist as one contact with the sum of their torques.
struct Groups<R: Real> {
    known: [(R::Vec3, RollingResistance<R>); GROUPS],
    /// Number of groups. Above [`GROUPS`], each pass visits the contacts again.
    count: usize,
}

impl<R: Real> Groups<R> {
    fn of<D: Dynamics<R>>(scene: &D, motion: &Motion<R>) -> Self {
        let none = RollingResistance {
            rolling: R::ZERO,
            spinning: R::ZERO,
            turn_speed: R::ONE,
        };
        let mut groups = Self {
            known: [(R::Vec3::ZERO, none); GROUPS],
            count: 0,
        };
        visit_laws(scene, motion, &mut |normal, law| groups.add(normal, law));
        groups
    }

    fn add(&mut self, normal: R::Vec3, law: RollingResistance<R>) {
        for (known, sum) in self.known.iter_mut().take(self.count) {
            if *known == normal && sum.turn_speed == law.turn_speed {
                sum.rolling += law.rolling;
                sum.spinning += law.spinning;
                return;
            }
        }
        if let Some(free) = self.known.get_mut(self.count) {
            *free = (normal, law);
        }
        self.count += 1;
    }

    fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// `h Σ K` for contacts with the resistance that they have at an angular velocity.
    fn resistance<D: Dynamics<R>>(
        &self,
        scene: &D,
        motion: &Motion<R>,
        angular_velocity: R::Vec3,
        seconds: R,
    ) -> Columns<R> {
        let mut sum = [R::Vec3::ZERO; 3];
        let mut add = |normal, law| add_contact(&mut sum, normal, &law, angular_velocity, seconds);
        if self.count <= GROUPS {
            let groups = self.known.iter().take(self.count);
            groups.for_each(|&(normal, law)| add(normal, law));
        } else {
            visit_laws(scene, motion, &mut add);
        }
        sum
    }
}

/// Adds `h K` of one contact, or of one group of contacts.
fn add_contact<R: Real>(
    sum: &mut Columns<R>,
    n: R::Vec3,
    law: &RollingResistance<R>,
    angular_velocity: R::Vec3,
    seconds: R,
) {
    let [rolling, spinning] = of_contact(law, n, angular_velocity);
    let (rolling, beyond) = (rolling * seconds, (spinning - rolling) * seconds);
    let o = R::ZERO;
    sum[0] += R::Vec3::new(rolling, o, o) + n * (n.x() * beyond);
    sum[1] += R::Vec3::new(o, rolling, o) + n * (n.y() * beyond);
    sum[2] += R::Vec3::new(o, o, rolling) + n * (n.z() * beyond);
}

fn of_contact<R: Real>(
    law: &RollingResistance<R>,
    n: R::Vec3,
    angular_velocity: R::Vec3,
) -> [R; 2] {
    let spinning = angular_velocity.dot(n);
    let rolling = angular_velocity - n * spinning;
    law.per_turn(rolling.length(), spinning.abs())
}

fn sum<R: Real>([x, y, z]: &Columns<R>, [a, b, c]: &Columns<R>) -> Columns<R> {
    [*x + *a, *y + *b, *z + *c]
}

fn times<R: Real>([x, y, z]: &Columns<R>, v: R::Vec3) -> R::Vec3 {
    *x * v.x() + *y * v.y() + *z * v.z()
}

/// Solves three equations by Cramer's rule. The matrix is positive definite.
fn solved<R: Real>([x, y, z]: Columns<R>, b: R::Vec3) -> R::Vec3 {
    let normal = y.cross(z);
    let per = R::ONE / x.dot(normal);
    R::Vec3::new(
        b.dot(normal) * per,
        x.dot(b.cross(z)) * per,
        x.dot(y.cross(b)) * per,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::State;
    use crate::{FlatGround, Frictionless, MovingGround, Scene, Sphere, UniformGravity};
    use crate::{SpringDamperGround, WithResistance};
    use glam::DVec3;

    /// The table gives the ball the angular momentum L about the vertical, at its own rate Ω. So it
    /// does the work `Ω L`, in addition to the work of the earlier stages of the step.
    #[test]
    fn a_turntable_works_on_a_ball_whose_spin_it_resists() {
        let (radius, depth, rate, earlier) = (0.05, 1e-3, 2.0, 3.0);
        let flat = FlatGround::level(1e4, 0.0);
        let ground = MovingGround::turntable(flat, DVec3::ZERO, rate);
        let friction = WithResistance {
            friction: Frictionless,
            rolling: 1e-3,
            spinning: 2e-3,
            turn_speed: 1e-2,
        };
        let gravity = UniformGravity::down(9.8);
        let scene = Scene::new(Sphere::solid(0.2, radius), ground, friction, gravity).unwrap();
        let start = State::at(DVec3::new(0.3, -0.1, radius - depth));
        let before = Energy::of(&scene, &start);
        let (mut state, mut energy, seconds) = (start, before, 1e-3);
        let mut step = Step::new(seconds, 0);
        step.drive_work = earlier;
        resisted(&scene, &mut state, &mut energy, seconds, &mut step);
        // The ball is slower than the table throughout, so that the torque is nearly the largest.
        let largest = friction.spinning * flat.spring_force(depth) * seconds;
        let given = state.angular_momentum.z / largest;
        assert!((0.9..1.0).contains(&given), "{given}");
        let work = step.drive_work - earlier;
        let expected = rate * state.angular_momentum.z;
        assert!(
            (work - expected).abs() < 4.0 * f64::EPSILON * earlier,
            "{work:e}"
        );
        assert!(energy.rotation > 0.0);
        assert!(energy.total() <= before.total() + work);
    }
}
