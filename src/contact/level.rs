//! Load of bare points on a level plane, which is the most frequent scene, by a shorter
//! computation.
//!
//! Let `r` be the arm of a contact, from the centre of mass, in world axes. The plane is at the
//! height `h`, and `x`, `v` and `ω` are the position, velocity and angular velocity of the body.
//! The ground pushes along z, and the slip has no z component:
//!
//! ```text
//! depth = (h - x.z) - r.z        velocity = v + ω × r        slip = (velocity.x, velocity.y, 0)
//! ```

use super::invariants;
use super::load::Load;
use crate::body::ContactPoint;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Number of contacts of a block, which are computed in lanes.
///
/// Each stage of a block is a loop of this length over arrays. The compiler vectorises it for the
/// lanes of the processor. It would unroll a shorter loop first, and then find no lanes. The number
/// is a divisor of the 120 points of the coin.
pub(super) const BLOCK_LEN: usize = 24;

/// Whether the processor computes on two numbers at once.
///
/// If so, a step with few contacts takes less time with the contacts in pairs. Otherwise it would
/// take more instructions. No bit of the result depends on it.
const HAS_LANES: bool = cfg!(any(
    target_feature = "sse2",
    target_feature = "neon",
    target_feature = "simd128"
));

/// Number of contacts whose forces are all computed, in pairs, before the first of them is added.
/// It is even, and a rolling body seldom touches with more contacts.
const FEW: usize = 6;

/// Load of the contacts of `parts` on a body above the plane z = `height` (m). With `arm_axes`, the
/// torque is that on a body with these axes.
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
        // Passing a reference would force `load` into memory, so a copy is passed and copied back
        // part by part.
        let motion = &{ *motion };
        let whole = Level { depth, motion }.with_tail(load, laws, tail, arm_axes);
        load.force = whole.force;
        load.torque = whole.torque;
        load.touching = whole.touching;
    }
    debug_assert!(invariants::is_sum_of(&load, head.len() + tail.len()));
    load
}

/// Body above a level plane.
pub(super) struct Level<'a, R: Real> {
    /// Penetration depth of the centre of mass, m.
    depth: R,
    motion: &'a Motion<R>,
}

impl<'a, R: Real> Level<'a, R> {
    /// Body with this motion above the plane z = `height` (m).
    #[inline(always)]
    pub(super) fn under(height: R, motion: &'a Motion<R>) -> Self {
        Self {
            depth: height - motion.position.z(),
            motion,
        }
    }

    /// Penetration depth at an arm, m.
    #[inline(always)]
    pub(super) fn depth(&self, arm: R::Vec3) -> R {
        self.depth - arm.z()
    }

    /// Force of the ground on a contact at an arm, with a penetration depth (m) above 0, N.
    #[inline(always)]
    pub(super) fn force<G, F>(
        &self,
        (ground, friction): (&G, &F),
        arm: R::Vec3,
        depth: R,
    ) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let velocity = self.motion.velocity_at(arm);
        let normal_force = ground.normal_force(depth, -velocity.z());
        let slip = R::Vec3::new(velocity.x(), velocity.y(), R::ZERO);
        // Component in the plane of the slip, where the force of any law lies.
        let position = self.motion.position + arm;
        let rub = friction.force_at(position, normal_force, slip);
        R::Vec3::new(rub.x(), rub.y(), normal_force)
    }

    /// Adds contacts to the load: whole blocks first, then pairs, then single contacts.
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
        if contacts.len() >= BLOCK_LEN {
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

    /// Adds the contacts after the wrap to contact 0, as [`with`](Self::with) does. A contact range
    /// seldom wraps.
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

    /// Adds contacts in pairs up to the first separated contact, and returns the rest.
    ///
    /// The computation of a pair is written out twice and stored side by side. Otherwise compilers
    /// do not use two lanes.
    #[inline(always)]
    fn add_pairs<'b, G, F>(
        &self,
        load: &mut Load<R>,
        laws: (&G, &F),
        mut contacts: &'b [ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> &'b [ContactPoint<R>]
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        while contacts.len() > 1 {
            let (mut forces, mut torques) = (Vectors::<R, FEW>::ZERO, Vectors::<R, FEW>::ZERO);
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
                // Both conditions in one branch: a full block evaluates the next pair in vain. With
                // a separate branch, steps with fewer contacts take more instructions.
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
            // No square root and no division had to wait for these sums.
            load.add_first(count, &forces, &torques);
            if count < FEW {
                break;
            }
        }
        contacts
    }

    /// Adds whole blocks up to the first block with a separated contact, and returns the rest.
    /// Force laws are evaluated for penetrating contacts only.
    ///
    /// If the body can compute an exact range, only its ends are left over. If it cannot, one more
    /// copy of the laws here would be a tenth of a small device's program.
    #[inline(never)]
    fn with_blocks<'b, G, F>(
        &self,
        mut load: Load<R>,
        laws: (&G, &F),
        mut contacts: &'b [ContactPoint<R>],
        arm_axes: Option<&Axes<R>>,
    ) -> (Load<R>, &'b [ContactPoint<R>])
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let (mut arms, mut forces) = (Vectors::<R, BLOCK_LEN>::ZERO, Vectors::<R, BLOCK_LEN>::ZERO);
        let (mut force, mut torque) = (Pairs::<R>::ZERO, Pairs::<R>::ZERO);
        let mut depths = [R::ZERO; BLOCK_LEN];
        while let Some((block, rest)) = contacts.split_first_chunk::<BLOCK_LEN>() {
            arms.put(|i| self.motion.axes.to_world(block[i].position));
            let mut touching = 0;
            for (i, depth) in depths.iter_mut().enumerate() {
                *depth = self.depth(arms.get(i));
                touching += usize::from(*depth > R::ZERO);
            }
            if touching < BLOCK_LEN {
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
            load.touching += BLOCK_LEN;
        }
        load.force += force.sum();
        load.torque += torque.sum();
        (load, contacts)
    }
}

impl<R: Real> Load<R> {
    /// Adds the first contacts of a block.
    #[inline(always)]
    fn add_first(&mut self, count: usize, forces: &Vectors<R, FEW>, torques: &Vectors<R, FEW>) {
        for i in 0..count.min(FEW) {
            self.force += forces.get(i);
            self.torque += torques.get(i);
        }
        self.touching += count;
    }
}

/// One vector for each contact of a block, stored axis by axis.
#[derive(Clone, Copy)]
struct Vectors<R, const N: usize>([[R; N]; 3]);

impl<R: Real, const N: usize> Vectors<R, N> {
    const ZERO: Self = Self([[R::ZERO; N]; 3]);

    #[inline(always)]
    fn get(&self, i: usize) -> R::Vec3 {
        let [x, y, z] = &self.0;
        R::Vec3::new(x[i], y[i], z[i])
    }

    /// Replaces each vector by its vector product with another one. It works in place, because a
    /// block is a tenth of a small device's stack.
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

/// Sums over contacts at even and at odd positions of their blocks, axis by axis. There are two
/// sums each, so that they are vectorised, and no more, so that their order is the same on every
/// platform.
#[derive(Clone, Copy)]
struct Pairs<R>([[R; 2]; 3]);

impl<R: Real> Pairs<R> {
    const ZERO: Self = Self([[R::ZERO; 2]; 3]);

    #[inline(always)]
    fn add(&mut self, block: &Vectors<R, BLOCK_LEN>) {
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
    use crate::*;
    use glam::{DMat3, DVec3};

    /// Coulomb's law of the coin report, as a user would write it.
    struct Own;

    impl SlidingFriction for Own {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            slip * (-0.3 * normal_force / (slip.length() + 1e-3))
        }
    }

    /// Ring of any number of bare contacts. With `depth` above 0, two rings at `depth` on both
    /// sides of the yz plane.
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

    /// Flat, tilted and upright poses at several heights, so that all contacts touch, some, or
    /// none.
    fn states() -> impl Iterator<Item = State> {
        (0..60).map(|i| {
            let i = f64::from(i);
            State::at(DVec3::new(0.3, -0.2, 0.1 * (i % 7.0) - 0.5))
                .with_linear_velocity(DVec3::new(0.2, -0.1, 0.05 * (i % 5.0) - 0.1))
                .with_rotation_vector(DVec3::new(0.1 * i, 1.57 + 0.02 * (i % 4.0), 0.3))
                .with_angular_momentum(DVec3::new(0.02, -0.01, 0.03))
        })
    }

    /// Numbers of contacts, and depths of their rings: with and without a rest, in blocks and
    /// pairs.
    const RINGS: [(usize, f64); 11] = [
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
    ];

    /// Sums over the contacts of a range, taken one by one.
    #[derive(Default)]
    struct Sums {
        force: DVec3,
        torque: DVec3,
        touching: usize,
        /// Sum of the magnitudes of the forces, N.
        forces: f64,
        /// Smallest penetration depth, m.
        depth: Option<f64>,
    }

    impl Sums {
        fn add(&mut self, contact: &Contact, push: DVec3, arm_axes: &crate::rotation::Axes) {
            self.force += push;
            self.torque += contact.arm_along(arm_axes).cross(push);
            self.touching += 1;
            self.forces += push.length();
            let depth = contact.depth;
            self.depth = Some(self.depth.map_or(depth, |least| least.min(depth)));
        }
    }

    #[test]
    fn contacts_in_blocks_load_the_body_as_they_do_one_by_one() {
        let ground = FlatGround::level(100.0, 0.5);
        let mut whole = 0;
        for (count, depth) in RINGS {
            let scene = Scene::new(Rings::new(count, depth), ground, Own, NoGravity).unwrap();
            for state in states() {
                let motion = scene.motion(&state);
                let arm_axes = state
                    .with_rotation_vector(DVec3::new(0.3, -0.2, 0.1))
                    .rotation()
                    .axes();
                let model = scene.contact_model();
                let range = model.range_within(0.0, motion.position, &motion.axes);
                let load = model.load_with_arms(range, &motion, Some(&arm_axes));
                let mut sums = Sums::default();
                model.visit_on(range, &motion, |contact: &Contact| {
                    sums.add(contact, contact.force(&ground, &Own), &arm_axes);
                });
                // Each penetration depth, of about 0.5 m, is rounded a few times up or down, which
                // a spring of 100 N/m converts into a force. Then the sums are rounded.
                let rounding = (8.0 * 0.5 * 100.0 + sums.forces) * count as f64 * f64::EPSILON;
                let off = load.force - sums.force;
                assert!(off.length() <= rounding, "{count}: {}", sums.force);
                let off = load.torque - sums.torque;
                assert!(off.length() <= rounding, "{count}: {}", sums.torque);
                let touching = sums.touching;
                let is_shallow = sums.depth.is_some_and(|depth| depth < 1e-15);
                assert!(load.touching == touching || is_shallow, "{touching}");
                whole += usize::from(touching == count);
            }
        }
        // Not only blocks that touch partly.
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
        // A ring that has rotated by some of its 120 points is the same ring.
        for depth in [1e-3, 0.1, 0.4] {
            let load = |points: f64| {
                let state = State::at(DVec3::Z * (0.5 - depth))
                    .with_linear_velocity(DVec3::new(0.2, -0.1, -0.05))
                    .with_rotation_vector(DVec3::X * (points * core::f64::consts::TAU / 120.0));
                let motion = scene.motion(&state);
                let model = scene.contact_model();
                let range = model.range_within(0.0, motion.position, &motion.axes);
                let tail = range.parts(scene.body().contacts())[1].len();
                (scene.load(&motion), tail)
            };
            let (middle, none) = load(0.0);
            // Rounding of each penetration depth, at most 0.5 m, by some roundings of position and
            // orientation. It counts twice because it affects two loads, and once more for the
            // friction.
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
        /// Ground whose law is not defined above it.
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
