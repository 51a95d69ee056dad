//! Bare points on a level plane: what most scenes are, and the short way to their load.
//!
//! There, the depth of a contact with the arm `r` (from the centre of mass, world axes) is what the
//! arm leaves of the centre's own, the ground pushes along z, and the slip has no z component. With
//! the plane at the height `h`, and place, velocity and angular velocity `x`, `v` and `ω` of the
//! body:
//!
//! ```text
//! depth = (h - x.z) - r.z        velocity = v + ω × r        slip = (velocity.x, velocity.y, 0)
//! ```

use super::{Load, Motion};
use crate::body::ContactPoint;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Number of contacts of a block, which go abreast. Each stage of a block is a loop of this length
/// over arrays, which the compiler makes operations on as many lanes as the processor has; a
/// shorter one it would unroll first, and then find no lanes. A divisor of the coin's 120.
const ABREAST: usize = 24;

/// Whether the processor computes on two numbers at once. There a step with few contacts takes less
/// time if they go in pairs; elsewhere it would take more instructions. No bit depends on it.
const HAS_LANES: bool = cfg!(any(
    target_feature = "sse2",
    target_feature = "neon",
    target_feature = "simd128"
));

/// Number of contacts whose forces are all worked out, in pairs, before the first of them is added:
/// even, and a rolling body seldom touches with more.
const FEW: usize = 6;

/// The load of the contacts of `parts` on a body above the plane z = `height` (m); with other
/// `arm_axes`, the torque that it has with those.
#[inline(always)]
pub(super) fn load<R: Real, G, F>(
    laws: (&G, &F),
    height: R,
    parts: [&[ContactPoint<R>]; 2],
    motion: &Motion<R>,
    arm_axes: Option<&Axes<R>>,
) -> Load<R>
where
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    let depth = height - motion.position.z();
    let [head, tail] = parts;
    let mut load = Level { depth, motion }.with(Load::default(), laws, head, arm_axes);
    if !tail.is_empty() {
        // What is handed to a function stays in memory. So a copy is, and the load is taken back
        // part by part.
        let motion = &{ *motion };
        let whole = Level { depth, motion }.with_tail(load, laws, tail, arm_axes);
        load.force = whole.force;
        load.torque = whole.torque;
        load.touching = whole.touching;
    }
    load
}

/// A body above a level plane.
struct Level<'a, R: Real> {
    /// Depth of the centre of mass, m.
    depth: R,
    motion: &'a Motion<R>,
}

impl<R: Real> Level<'_, R> {
    /// Depth at an arm, m.
    #[inline(always)]
    fn depth(&self, arm: R::Vec3) -> R {
        self.depth - arm.z()
    }

    /// Force of the ground on a contact at an arm and a depth (m) above 0, N.
    #[inline(always)]
    fn force<G, F>(&self, (ground, friction): (&G, &F), arm: R::Vec3, depth: R) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let velocity = self.motion.velocity_at(arm);
        let normal_force = ground.normal_force(depth, -velocity.z());
        let slip = R::Vec3::new(velocity.x(), velocity.y(), R::ZERO);
        // In the plane of the slip, as any law's.
        let rub = friction.force(normal_force, slip);
        R::Vec3::new(rub.x(), rub.y(), normal_force)
    }

    /// The load with more contacts: whole blocks first, then pairs, then one by one.
    #[inline(always)]
    fn with<G, F>(
        &self,
        mut load: Load<R>,
        laws: (&G, &F),
        contacts: &[ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> Load<R>
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let mut rest = contacts;
        if contacts.len() >= ABREAST {
            let motion = &{ *self.motion };
            let level = Level { motion, ..*self };
            (load, rest) = level.with_blocks(load, laws, contacts, arm_axes);
        }
        if HAS_LANES {
            rest = self.add_pairs(&mut load, laws, rest, arm_axes);
        }
        for contact in rest {
            let arm = self.motion.axes.to_world(contact.position);
            let depth = self.depth(arm);
            if depth > R::ZERO {
                let force = self.force(laws, arm, depth);
                let arm = arm_axes.map_or(arm, |axes| axes.to_world(contact.position));
                load.force += force;
                load.torque += arm.cross(force);
                load.touching += 1;
            }
        }
        load
    }

    /// As [`with`](Self::with), for the contacts behind the body's contact 0, to which a run seldom
    /// comes round.
    #[cold]
    #[inline(never)]
    fn with_tail<G, F>(
        &self,
        load: Load<R>,
        laws: (&G, &F),
        contacts: &[ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> Load<R>
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        self.with(load, laws, contacts, arm_axes)
    }

    /// Adds contacts in pairs up to the first that does not touch, and returns the rest.
    ///
    /// What a pair needs is written out twice and stored side by side: only so compilers see two
    /// lanes.
    #[inline(always)]
    fn add_pairs<'a, G, F>(
        &self,
        load: &mut Load<R>,
        laws: (&G, &F),
        mut contacts: &'a [ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> &'a [ContactPoint<R>]
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        while contacts.len() > 1 {
            let (mut forces, mut torques) = (Block::<R, FEW>::ZERO, Block::<R, FEW>::ZERO);
            let mut count = 0;
            while let Some(([first, second], rest)) = contacts.split_first_chunk() {
                let to_world = |axes: &Axes<R>| {
                    [
                        axes.to_world(first.position),
                        axes.to_world(second.position),
                    ]
                };
                let arms = to_world(&self.motion.axes);
                let depths = [self.depth(arms[0]), self.depth(arms[1])];
                let touch = depths[0] > R::ZERO && depths[1] > R::ZERO;
                // Both at once: a block that is full looks at the next pair in vain, but with a
                // branch for itself steps with fewer contacts take more instructions.
                if !touch || count + 1 >= FEW {
                    break;
                }
                let pushes = [
                    self.force(laws, arms[0], depths[0]),
                    self.force(laws, arms[1], depths[1]),
                ];
                let arms = arm_axes.map_or(arms, to_world);
                let turns = [arms[0].cross(pushes[0]), arms[1].cross(pushes[1])];
                torques.set_pair(count, turns);
                forces.set_pair(count, pushes);
                count += 2;
                contacts = rest;
            }
            // No root and no division had to wait for these sums.
            for i in 0..count.min(FEW) {
                load.force += forces.get(i);
                load.torque += torques.get(i);
            }
            load.touching += count;
            if count < FEW {
                break;
            }
        }
        contacts
    }

    /// The load with whole blocks abreast up to the first that does not touch all over, and the
    /// rest: a law is asked of contacts alone that touch.
    ///
    /// A run is as good as exact where a body can tell it, so that only its ends are left; where it
    /// cannot, one copy more of the laws here would be a tenth of a small device's program.
    #[inline(never)]
    fn with_blocks<'a, G, F>(
        &self,
        mut load: Load<R>,
        laws: (&G, &F),
        mut contacts: &'a [ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> (Load<R>, &'a [ContactPoint<R>])
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let (mut arms, mut forces) = (Block::<R, ABREAST>::ZERO, Block::<R, ABREAST>::ZERO);
        let (mut force, mut torque) = (Pairs::<R>::ZERO, Pairs::<R>::ZERO);
        let mut depths = [R::ZERO; ABREAST];
        while let Some((block, rest)) = contacts.split_first_chunk::<ABREAST>() {
            arms.put(|i| self.motion.axes.to_world(block[i].position));
            let mut touching = 0;
            for (i, depth) in depths.iter_mut().enumerate() {
                *depth = self.depth(arms.get(i));
                touching += usize::from(*depth > R::ZERO);
            }
            if touching < ABREAST {
                break;
            }
            contacts = rest;
            forces.put(|i| self.force(laws, arms.get(i), depths[i]));
            if let Some(axes) = arm_axes {
                arms.put(|i| axes.to_world(block[i].position));
            }
            arms.cross(&forces);
            force.add(&forces);
            torque.add(&arms);
            load.touching += ABREAST;
        }
        load.force += force.sum();
        load.torque += torque.sum();
        (load, contacts)
    }
}

/// A vector of each contact of a block, axis by axis.
#[derive(Clone, Copy)]
struct Block<R, const N: usize>([[R; N]; 3]);

impl<R: Real, const N: usize> Block<R, N> {
    const ZERO: Self = Self([[R::ZERO; N]; 3]);

    #[inline(always)]
    fn get(&self, i: usize) -> R::Vec3 {
        let [x, y, z] = &self.0;
        R::Vec3::new(x[i], y[i], z[i])
    }

    /// Its vector product with another one, in its own place: a block is a tenth of a small
    /// device's stack.
    #[inline(always)]
    fn cross(&mut self, other: &Self) {
        for i in 0..N {
            self.set(i, self.get(i).cross(other.get(i)));
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, vector: R::Vec3) {
        let [x, y, z] = &mut self.0;
        x[i] = vector.x();
        y[i] = vector.y();
        z[i] = vector.z();
    }

    #[inline(always)]
    fn set_pair(&mut self, i: usize, [first, second]: [R::Vec3; 2]) {
        let [x, y, z] = &mut self.0;
        (x[i], x[i + 1]) = (first.x(), second.x());
        (y[i], y[i + 1]) = (first.y(), second.y());
        (z[i], z[i + 1]) = (first.z(), second.z());
    }

    #[inline(always)]
    fn put(&mut self, vector: impl Fn(usize) -> R::Vec3) {
        for i in 0..N {
            self.set(i, vector(i));
        }
    }
}

/// Sums over contacts at even and at odd places of their blocks, axis by axis: two each, so that
/// they go abreast, and no more, so that their order is everywhere the same.
#[derive(Clone, Copy)]
struct Pairs<R>([[R; 2]; 3]);

impl<R: Real> Pairs<R> {
    const ZERO: Self = Self([[R::ZERO; 2]; 3]);

    #[inline(always)]
    fn add(&mut self, block: &Block<R, ABREAST>) {
        for (sum, values) in self.0.iter_mut().zip(&block.0) {
            for pair in values.chunks_exact(2) {
                sum[0] += pair[0];
                sum[1] += pair[1];
            }
        }
    }

    #[inline(always)]
    fn sum(self) -> R::Vec3 {
        let [x, y, z] = self.0.map(|[even, odd]| even + odd);
        R::Vec3::new(x, y, z)
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::load_with_arms;
    use crate::*;
    use glam::{DMat3, DVec3};

    /// The report's law, as a user would write it.
    struct Own;

    impl SlidingFriction for Own {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            slip * (-0.3 * normal_force / (slip.length() + 1e-3))
        }
    }

    /// A ring, or with `depth` above 0 two rings of `depth` on both sides of the yz plane: any
    /// number of bare contacts.
    struct Rings {
        contacts: [ContactPoint; 120],
        count: usize,
    }

    impl Rings {
        fn new(count: usize, depth: f64) -> Self {
            let place = |i: usize| {
                let (sin, cos) = (i as f64 * 0.37).sin_cos();
                let side = if i % 2 == 0 { depth } else { -depth };
                ContactPoint::bare(DVec3::new(side, 0.5 * cos, 0.5 * sin))
            };
            let contacts = core::array::from_fn(place);
            Self { contacts, count }
        }
    }

    impl RigidPointBody for Rings {
        fn mass(&self) -> f64 {
            1.0
        }
        fn inertia(&self) -> DMat3 {
            DMat3::from_diagonal(DVec3::new(0.25, 0.125, 0.125))
        }
        fn contacts(&self) -> &[ContactPoint] {
            &self.contacts[..self.count]
        }
    }

    /// Flat, tilted and upright, at several heights: all contacts touch, some, or none.
    fn states() -> impl Iterator<Item = State> {
        (0..60).map(|i| {
            let i = f64::from(i);
            State::at(DVec3::new(0.3, -0.2, 0.1 * (i % 7.0) - 0.5))
                .with_linear_velocity(DVec3::new(0.2, -0.1, 0.05 * (i % 5.0) - 0.1))
                .with_rotation_vector(DVec3::new(0.1 * i, 1.57 + 0.02 * (i % 4.0), 0.3))
                .with_angular_momentum(DVec3::new(0.02, -0.01, 0.03))
        })
    }

    #[test]
    fn contacts_that_go_abreast_load_the_body_as_they_do_one_by_one() {
        let ground = FlatGround::level(100.0, 0.5);
        let mut whole = 0;
        for (count, depth) in [
            (1, 0.0),
            (2, 0.0),
            (3, 0.0),
            (6, 0.0),
            (7, 0.1),
            (13, 0.0),
            (23, 0.0),
            (24, 0.1),
            (25, 0.0),
            (49, 0.1),
            (120, 0.0),
        ] {
            let scene = Scene::new(Rings::new(count, depth), ground, Own, NoGravity).unwrap();
            for state in states() {
                let motion = scene.motion(&state);
                let arm_axes = state
                    .with_rotation_vector(DVec3::new(0.3, -0.2, 0.1))
                    .rotation()
                    .axes();
                let run = scene.contacts_within(0.0, motion.position, &motion.axes);
                let load = load_with_arms(&scene, run, &motion, Some(&arm_axes));

                let (mut force, mut torque, mut touching) = (DVec3::ZERO, DVec3::ZERO, 0);
                let (mut forces, mut gaps) = (0.0, f64::MAX);
                scene.visit_run(run, &motion, |contact| {
                    let push = contact.force(&ground, &Own);
                    force += push;
                    torque += contact.arm_along(&arm_axes).cross(push);
                    touching += 1;
                    forces += push.length();
                    gaps = f64::min(gaps, contact.depth);
                });
                // Each depth, of some 0.5 m, is rounded a few times in either way, by which a
                // spring of 100 N/m feels it; then the sums.
                let rounding = (8.0 * 0.5 * 100.0 + forces) * count as f64 * f64::EPSILON;
                assert!(
                    (load.force - force).length() <= rounding,
                    "{count}: {force}"
                );
                assert!(
                    (load.torque - torque).length() <= rounding,
                    "{count}: {torque}"
                );
                assert!(load.touching == touching || gaps < 1e-15, "{touching}");
                whole += usize::from(touching == count);
            }
        }
        // Not only blocks that touch in part.
        assert!(whole > 50, "{whole}");
    }

    #[test]
    fn a_run_past_the_last_contact_loads_the_body_as_one_in_the_middle_does() {
        let ground = FlatGround::level(100.0, 0.5);
        let coulomb = Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        };
        let scene = Scene::new(Coin::ring(1.0, 0.5), ground, coulomb, NoGravity).unwrap();
        let mut lowest = [0, 0];
        // A ring that has turned by some of its 120 points is the same ring.
        for depth in [1e-3, 0.1, 0.4] {
            let load = |points: f64| {
                let state = State::at(DVec3::Z * (0.5 - depth))
                    .with_linear_velocity(DVec3::new(0.2, -0.1, -0.05))
                    .with_rotation_vector(DVec3::X * (points * core::f64::consts::TAU / 120.0));
                let motion = scene.motion(&state);
                let run = scene.contacts_within(0.0, motion.position, &motion.axes);
                let tail = run.parts(scene.body().contacts())[1].len();
                (scene.load(&motion), tail)
            };
            let (middle, none) = load(0.0);
            // Of each depth, 0.5 m at most, by some roundings of place and turn; twice, as they
            // bear on two loads, and once more for the rub.
            let rounding = 3.0 * 8.0 * 0.5 * 100.0 * middle.touching as f64 * f64::EPSILON;
            for points in 80..100 {
                let (turned, tail) = load(f64::from(points));
                let error = (turned.force - middle.force).length()
                    + (turned.torque - middle.torque).length();
                assert!(error <= rounding, "{points}: {error:e}");
                assert_eq!(turned.touching, middle.touching);
                lowest[usize::from(tail > 0)] += 1;
            }
            assert_eq!(none, 0);
        }
        assert!(lowest[0] > 10 && lowest[1] > 10, "{lowest:?}");
    }

    #[test]
    fn a_users_law_loads_a_body_to_the_last_bit_as_the_built_in_one_of_its_formula() {
        let (ground, coulomb) = (
            FlatGround::level(100.0, 0.5),
            Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            },
        );
        let built_in = Scene::new(Coin::ring(1.0, 0.5), ground, coulomb, NoGravity).unwrap();
        let coin: &dyn RigidPointBody = &Coin::ring(1.0, 0.5);
        let ground: &dyn SpringDamperGround = &ground;
        let own = Scene::new(coin, ground, Own, NoGravity).unwrap();
        for state in states() {
            let motion = built_in.motion(&state);
            assert_eq!(built_in.load(&motion), own.load(&motion));
        }
    }

    #[test]
    fn a_law_is_asked_of_contacts_alone_that_touch() {
        /// A ground whose law has no answer above it.
        struct Strict;
        impl SpringDamperGround for Strict {
            fn surface(&self, point: DVec3) -> Surface {
                Surface {
                    gap: point.z,
                    normal: DVec3::Z,
                }
            }
            fn spring_force(&self, depth: f64) -> f64 {
                assert!(depth > 0.0);
                100.0 * depth
            }
            fn spring_energy(&self, depth: f64) -> f64 {
                50.0 * depth * depth
            }
            fn normal_force(&self, depth: f64, _closing_speed: f64) -> f64 {
                self.spring_force(depth)
            }
            fn bounds(&self) -> GroundBounds {
                GroundBounds::Plane(Plane::level(0.0))
            }
        }
        let scene = Scene::new(Rings::new(120, 0.0), Strict, Own, NoGravity).unwrap();
        let touching = states().map(|state| scene.load(&scene.motion(&state)).touching);
        assert!(touching.filter(|count| (1..120).contains(count)).count() > 10);
    }
}
