//! Bare points on a level plane: what most scenes are, and the short way to their load.
//!
//! There, depth and velocity of a contact are linear in its place `p` in the body. With the body's axes `a_j`, place `x` and velocity `v` of its centre,
//! angular velocity `ω`, and a plane at the height `h`:
//!
//! ```text
//! depth = (h - x.z) - Σ_j a_j.z p_j        velocity = v + Σ_j (ω × a_j) p_j        slip = (velocity.x, velocity.y, 0)
//! ```
//! A force `f` at `p` has the torque `(Σ_j a_j p_j) × f`. So all contacts together need no arms, but the sums `F = Σ f` and `M_j = Σ p_j f`:
//!
//! ```text
//! force = F        torque = Σ_j a_j × M_j
//! ```
//! The same sums have the torque on a body with other axes.

use core::array;

use super::{Load, Motion};
use crate::body::ContactPoint;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Number of contacts that go abreast. Each stage of a block is a loop of this length over arrays, which the compiler makes operations on as many lanes as
/// the processor has; a shorter one it would unroll first, and then find no lanes. A divisor of the coin's 120.
const ABREAST: usize = 24;

/// The load of the contacts of `parts` on a body above the plane z = `height` (m), with the torque that it has with these `arm_axes`.
#[inline(always)]
pub(super) fn load<R: Real, G, F>(
    laws: (&G, &F),
    height: R,
    parts: [&[ContactPoint<R>]; 2],
    motion: &Motion<R>,
    arm_axes: &Axes<R>,
) -> Load<R>
where
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    let level = Level::<R>::new(motion, height);
    let mut moments = Moments::NONE;
    for contacts in parts {
        let rest = if contacts.len() < ABREAST {
            contacts
        } else {
            level.add_blocks(&mut moments, laws, contacts)
        };
        level.add_each(&mut moments, laws, rest);
    }
    moments.load(arm_axes)
}

/// Depth and velocity of every point of a body above a level plane.
struct Level<R: Real> {
    /// Depth of the centre of mass, m.
    depth: R,
    /// Rise for each metre along a body axis.
    rise: [R; 3],
    /// Velocity of the centre of mass, m/s.
    velocity: R::Vec3,
    /// Velocity about the centre for each metre along a body axis, 1/s.
    turning: [R::Vec3; 3],
}

impl<R: Real> Level<R> {
    #[inline(always)]
    fn new(motion: &Motion<R>, height: R) -> Self {
        let axes = columns(&motion.axes);
        Self {
            depth: height - motion.position.z(),
            rise: axes.map(|axis| axis.z()),
            velocity: motion.linear_velocity,
            turning: axes.map(|axis| motion.angular_velocity.cross(axis)),
        }
    }

    /// Depth of a place, m.
    #[inline(always)]
    fn depth(&self, place: [R; 3]) -> R {
        let ([x, y, z], rise) = (place, self.rise);
        self.depth - rise[0] * x - rise[1] * y - rise[2] * z
    }

    /// Force of the ground on a contact at a place and depth (m), N.
    #[inline(always)]
    fn force<G, F>(&self, (ground, friction): (&G, &F), place: [R; 3], depth: R) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let ([x, y, z], turning) = (place, self.turning);
        let velocity = self.velocity + turning[0] * x + turning[1] * y + turning[2] * z;
        let normal_force = ground.normal_force(depth, -velocity.z());
        let slip = R::Vec3::new(velocity.x(), velocity.y(), R::ZERO);
        let rub = friction.force(normal_force, slip);
        R::Vec3::new(rub.x(), rub.y(), rub.z() + normal_force)
    }

    /// Adds the contacts that touch, one after the other.
    #[inline(always)]
    fn add_each<G, F>(&self, moments: &mut Moments<R>, laws: (&G, &F), contacts: &[ContactPoint<R>])
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        for contact in contacts {
            let place = place(contact);
            let depth = self.depth(place);
            if depth > R::ZERO {
                moments.add(place, self.force(laws, place, depth));
            }
        }
    }

    /// Adds whole blocks abreast up to the first that does not touch all over, and returns the rest: a law is asked of contacts alone that touch.
    ///
    /// A run is as good as exact where a body can tell it, so that only its ends are left; where it cannot, one copy more of the laws here would be a tenth of a small
    /// device's program.
    #[inline(never)]
    fn add_blocks<'a, G, F>(
        &self,
        moments: &mut Moments<R>,
        laws: (&G, &F),
        mut contacts: &'a [ContactPoint<R>],
    ) -> &'a [ContactPoint<R>]
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let mut abreast = Abreast::NONE;
        let mut places = [[R::ZERO; ABREAST]; 3];
        let mut depths = [R::ZERO; ABREAST];
        let mut forces = [[R::ZERO; ABREAST]; 3];
        while let Some((block, rest)) = contacts.split_first_chunk() {
            if self.sink(block, &mut places, &mut depths) < ABREAST {
                break;
            }
            contacts = rest;
            for (i, &depth) in depths.iter().enumerate() {
                let force = self.force(laws, array::from_fn(|axis| places[axis][i]), depth);
                forces[0][i] = force.x();
                forces[1][i] = force.y();
                forces[2][i] = force.z();
            }
            abreast.add(&places, &forces);
            moments.touching += ABREAST;
        }
        moments.add_abreast(&abreast);
        contacts
    }

    /// Places of a block's contacts, axis by axis, and their depths (m). Returns how many touch.
    #[inline(always)]
    fn sink(
        &self,
        block: &[ContactPoint<R>; ABREAST],
        places: &mut [[R; ABREAST]; 3],
        depths: &mut [R; ABREAST],
    ) -> usize {
        let mut touching = 0;
        for (i, contact) in block.iter().enumerate() {
            let place = place(contact);
            let depth = self.depth(place);
            for (places, p) in places.iter_mut().zip(place) {
                places[i] = p;
            }
            depths[i] = depth;
            touching += usize::from(depth > R::ZERO);
        }
        touching
    }
}

/// The sums that force and torque are made of.
struct Moments<R: Real> {
    /// Σ f, N.
    force: R::Vec3,
    /// Σ p_j f for each axis of the body, N m.
    along: [R::Vec3; 3],
    /// Number of contacts that touch.
    touching: usize,
}

impl<R: Real> Moments<R> {
    const NONE: Self = Self {
        force: R::Vec3::ZERO,
        along: [R::Vec3::ZERO; 3],
        touching: 0,
    };

    /// One more contact that touches.
    #[inline(always)]
    fn add(&mut self, place: [R; 3], force: R::Vec3) {
        self.force += force;
        let [x, y, z] = place;
        self.along[0] += force * x;
        self.along[1] += force * y;
        self.along[2] += force * z;
        self.touching += 1;
    }

    /// The sums of contacts that went abreast.
    #[inline(always)]
    fn add_abreast(&mut self, sums: &Abreast<R>) {
        let [x, y, z] = sums.force.map(joined);
        self.force += R::Vec3::new(x, y, z);
        for (axis, along) in self.along.iter_mut().enumerate() {
            let [x, y, z] = sums.along.map(|moments| joined(moments[axis]));
            *along += R::Vec3::new(x, y, z);
        }
    }

    #[inline(always)]
    fn load(&self, axes: &Axes<R>) -> Load<R> {
        let terms = columns::<R>(axes).into_iter().zip(self.along);
        Load {
            force: self.force,
            torque: terms.fold(R::Vec3::ZERO, |torque, (axis, along)| {
                torque + axis.cross(along)
            }),
            touching: self.touching,
        }
    }
}

/// Sums over contacts at even and at odd places of their blocks: two each, so that they go abreast, and no more, so that their order is everywhere the same.
struct Abreast<R: Real> {
    /// Σ f, N, by world axis.
    force: [[R; 2]; 3],
    /// Σ p_j f, N m, by world axis and axis of the body.
    along: [[[R; 2]; 3]; 3],
}

impl<R: Real> Abreast<R> {
    const NONE: Self = Self {
        force: [[R::ZERO; 2]; 3],
        along: [[[R::ZERO; 2]; 3]; 3],
    };

    /// The contacts of one more block.
    #[inline(always)]
    fn add(&mut self, places: &[[R; ABREAST]; 3], forces: &[[R; ABREAST]; 3]) {
        let sums = self.force.iter_mut().zip(&mut self.along);
        for ((force, along), forces) in sums.zip(forces) {
            for (pair, f) in forces.chunks_exact(2).enumerate() {
                for lane in 0..2 {
                    force[lane] += f[lane];
                    for (sum, p) in along.iter_mut().zip(places) {
                        sum[lane] += f[lane] * p[2 * pair + lane];
                    }
                }
            }
        }
    }
}

/// The sum of both lanes.
#[inline(always)]
fn joined<R: Real>([even, odd]: [R; 2]) -> R {
    even + odd
}

/// A contact's place along the body's axes, m.
#[inline(always)]
fn place<R: Real>(contact: &ContactPoint<R>) -> [R; 3] {
    let p = contact.position;
    [p.x(), p.y(), p.z()]
}

/// The body's axes.
#[inline(always)]
fn columns<R: Real>(axes: &Axes<R>) -> [R::Vec3; 3] {
    [axes.x, axes.y, axes.z]
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

    /// A ring, or with `depth` above 0 two rings of `depth` on both sides of the yz plane: any number of bare contacts.
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
                .turned_by(DVec3::new(0.1 * i, 1.57 + 0.02 * (i % 4.0), 0.3))
                .with_angular_momentum(DVec3::new(0.02, -0.01, 0.03))
        })
    }

    #[test]
    fn contacts_that_go_abreast_load_the_body_as_they_do_one_by_one() {
        let ground = FlatGround::level(100.0, 0.5);
        let mut whole = 0;
        for (count, depth) in [
            (3, 0.0),
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
                    .turned_by(DVec3::new(0.3, -0.2, 0.1))
                    .rotation()
                    .axes();
                let run = scene.contacts_within(0.0, motion.position, &motion.axes);
                let load = load_with_arms(&scene, run, &motion, &arm_axes);

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
                // Each depth, of some 0.5 m, is rounded a few times in either way, by which a spring of 100 N/m feels it; then the sums.
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
            fn extent(&self) -> Extent {
                Extent::Plane(Plane::level(0.0))
            }
        }
        let scene = Scene::new(Rings::new(120, 0.0), Strict, Own, NoGravity).unwrap();
        let touching = states().map(|state| scene.load(&scene.motion(&state)).touching);
        assert!(touching.filter(|count| (1..120).contains(count)).count() > 10);
    }
}
