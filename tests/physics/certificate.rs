//! The inequality of the certificate, proven for random hulls in interval arithmetic.
//!
//! To leave a facet, the direction that points down must cross the facet's boundary. There, at
//! every height of the body, the potential energy of weight and springs must be at least the
//! barrier. The tests in `outcome.rs` search for the least energy. Here each edge of the facet and
//! each penetration depth is covered by intervals, and the energy of all contacts over an interval
//! has a lower bound. Nothing between two samples is left out.
//!
//! `TUMBLE_OUTCOMES=100000 cargo test --test physics certificate::` proves more facets.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
#![allow(
    clippy::std_instead_of_alloc,
    reason = "a test has the standard library"
)]
// The tests need a newer compiler than the library.
#![allow(clippy::incompatible_msrv)]

use crate::outcome::decided_states::{Draw, GRAVITY};
use core::ops::{Add, Mul, Sub};
use std::collections::VecDeque;
use tumble::glam::DVec3;
use tumble::{
    ContactPoint, Faces, FlatGround, MassProperties, RigidPointBody, Solid, Stepper, UniformGravity,
};

/// Numbers from `low` to `high`. An operation rounds outwards, by one unit in the last place more
/// than the nearest number.
#[derive(Clone, Copy, Debug)]
struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    const fn of(value: f64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }
    fn outward(low: f64, high: f64) -> Self {
        Self {
            low: low.next_down(),
            high: high.next_up(),
        }
    }
    fn sqrt(self) -> Self {
        Self::outward(self.low.max(0.0).sqrt(), self.high.sqrt())
    }
    /// Smallest square and largest square.
    fn square(self) -> Self {
        let (low, high) = (self.low.abs(), self.high.abs());
        let least = if self.low <= 0.0 && self.high >= 0.0 {
            0.0
        } else {
            low.min(high)
        };
        let most = low.max(high);
        Self::outward(least * least, most * most)
    }
    fn max(self, other: Self) -> Self {
        Self {
            low: self.low.max(other.low),
            high: self.high.max(other.high),
        }
    }
    /// For a divisor above 0.
    fn over(self, divisor: Self) -> Self {
        let quotients = [self.low, self.high].map(|a| [a / divisor.low, a / divisor.high]);
        let [[a, b], [c, d]] = quotients;
        Self::outward(a.min(b).min(c).min(d), a.max(b).max(c).max(d))
    }
    fn width(self) -> f64 {
        self.high - self.low
    }
    fn halves(self) -> [Self; 2] {
        let middle = 0.5 * (self.low + self.high);
        [
            Self {
                high: middle,
                ..self
            },
            Self {
                low: middle,
                ..self
            },
        ]
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b] = [self.low * other.low, self.low * other.high];
        let [c, d] = [self.high * other.low, self.high * other.high];
        Self::outward(a.min(b).min(c).min(d), a.max(b).max(c).max(d))
    }
}

/// Result of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Proof {
    /// No energy is below the barrier.
    Holds,
    /// Some energy is below the barrier.
    Refuted,
}

/// An edge of a facet, and the contacts of the body.
struct Edge<'a> {
    contacts: &'a [ContactPoint],
    ends: [DVec3; 2],
    weight: f64,
    stiffness: f64,
}

impl Edge<'_> {
    /// Potential energy, J, for the directions to a part of the edge and for some depths of the
    /// lowest contact, m: `m g (h - d) + Σ k/2 (sᵢ - h + d)²` over the contacts that penetrate. The
    /// support of contact i is `sᵢ = u · pᵢ + ρᵢ`, and h is the largest one.
    fn energy(&self, part: Interval, depth: Interval) -> Interval {
        let [start, end] = self.ends.map(|end| end.to_array());
        let point: [Interval; 3] = core::array::from_fn(|axis| {
            let (from, to) = (Interval::of(start[axis]), Interval::of(end[axis]));
            from * (Interval::of(1.0) - part) + to * part
        });
        let length = (point.map(Interval::square).into_iter())
            .reduce(Add::add)
            .unwrap()
            .sqrt();
        let supports = self.contacts.iter().map(|contact| {
            let along = (contact.position.to_array().into_iter().zip(point))
                .map(|(position, point)| Interval::of(position) * point)
                .reduce(Add::add)
                .unwrap();
            along.over(length) + Interval::of(contact.radius)
        });
        let supports: Vec<_> = supports.collect();
        let top = supports.iter().copied().reduce(Interval::max).unwrap();
        let half = Interval::of(0.5 * self.stiffness);
        let springs = supports.iter().map(|&support| {
            let depth = (support - top + depth).max(Interval::of(0.0));
            half * depth.square()
        });
        // The lowest contact has the depth itself. Its square is not taken of a difference.
        let lowest = half * depth.square();
        let all = springs.reduce(Add::add).unwrap();
        let springs = all.max(Interval {
            low: lowest.low,
            high: all.high,
        });
        Interval::of(self.weight) * (top - depth) + springs
    }

    /// Proves or refutes that the energy is at least `barrier` on the whole edge, at all depths up
    /// to `deepest`. `None` if intervals of a 10^5th do not decide it.
    fn prove(&self, barrier: f64, deepest: f64) -> Option<Proof> {
        let part = Interval {
            low: 0.0,
            high: 1.0,
        };
        let depth = Interval {
            low: 0.0,
            high: deepest,
        };
        // The larger ones first, so that an energy below the barrier is found without a search
        // along the curve on which the energy equals it.
        let mut open = VecDeque::from([[part, depth]]);
        while let Some([part, depth]) = open.pop_front() {
            let energy = self.energy(part, depth);
            if energy.low >= barrier {
                continue;
            }
            if energy.high < barrier {
                return Some(Proof::Refuted);
            }
            let (of_part, of_depth) = (part.width(), depth.width() / deepest);
            if of_part.max(of_depth) < 1e-5 {
                return None;
            }
            let divided = if of_part > of_depth {
                part.halves().map(|part| [part, depth])
            } else {
                depth.halves().map(|depth| [part, depth])
            };
            open.extend(divided);
        }
        Some(Proof::Holds)
    }
}

/// A hull with its centre of mass off the middle. Every second one has round corners, all of one
/// radius.
fn hull(draw: &mut Draw, number: u64) -> Option<Solid<f64, Vec<ContactPoint>>> {
    let corners = draw.corners();
    let load = MassProperties::hull(1.0, &corners).ok()?;
    let centre_of_mass = load.centre_of_mass + draw.direction() * draw.between(0.0, 0.1);
    let load = MassProperties {
        centre_of_mass,
        ..load
    };
    let radius = if number % 2 == 0 {
        0.0
    } else {
        draw.between(0.01, 0.2)
    };
    let contact = |position: DVec3| ContactPoint { position, radius };
    Solid::new(load, corners.into_iter().map(contact).collect()).ok()
}

/// A facet below a random direction, with its barrier.
struct Facet {
    contacts: Vec<ContactPoint>,
    corners: [DVec3; 3],
    weight: f64,
    /// Penetration depth at which a spring carries the weight, m.
    balanced: f64,
    barrier: f64,
}

impl Facet {
    /// Returns `None` if the centre of mass is outside the hull. The facet is a triangle, because
    /// the corners are random.
    fn drawn(number: u64) -> Option<Self> {
        let mut draw = Draw::of(81, number);
        let body = hull(&mut draw, number)?;
        let weight = body.mass() * GRAVITY;
        let balanced = draw.log_between(0.003, 0.1);
        let stepper = Stepper::new(body)
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(weight / balanced, 0.0)))
            .unwrap();
        let basin = stepper.body().basin(draw.direction())?;
        let contacts = stepper.body().contacts().to_vec();
        Some(Self {
            corners: (basin.face.contacts).map(|number| contacts[number].position),
            barrier: stepper.barriers()?.barrier(&basin),
            contacts,
            weight,
            balanced,
        })
    }

    fn edges(&self) -> [Edge<'_>; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]].map(|ends| Edge {
            contacts: &self.contacts,
            ends,
            weight: self.weight,
            stiffness: self.weight / self.balanced,
        })
    }

    /// Proofs for the three edges. At depths above twice the balanced one, a spring alone stores
    /// more than the weight has given: `k d²/2 >= m g d`.
    fn prove(&self, barrier: f64) -> [Option<Proof>; 3] {
        self.edges()
            .map(|edge| edge.prove(barrier, 2.0 * self.balanced))
    }

    /// Energy, J, that intervals resolve. They decide an inequality and not an equality: at a
    /// corner next to the centre of mass, the barrier is the least energy itself.
    fn resolved(&self) -> f64 {
        1e-3 * self.weight
    }
}

/// The facets among a number of hulls.
fn facets() -> Vec<Facet> {
    let asked = std::env::var("TUMBLE_OUTCOMES").ok();
    let count = asked.map_or(1_000, |count| count.parse().unwrap()) / 50;
    let facets: Vec<_> = (0..count).filter_map(Facet::drawn).collect();
    // The centre of mass of a flat hull is outside of it.
    assert!(facets.len() as u64 * 10 >= count * 8, "{}", facets.len());
    facets
}

#[test]
fn the_energy_on_the_boundary_of_a_facet_is_proven_to_be_at_least_the_barrier() {
    let facets = facets();
    for (number, facet) in facets.iter().enumerate() {
        let proofs = facet.prove(facet.barrier - facet.resolved());
        assert_eq!(proofs, [Some(Proof::Holds); 3], "facet {number}");
    }
    println!("proven: {} facets", facets.len());
}

/// A barrier that is above the energy of one state on the boundary by what intervals resolve.
#[test]
fn a_barrier_above_an_energy_on_the_boundary_is_refuted() {
    for (number, facet) in facets().iter().enumerate() {
        let sampled = facet.edges().map(|edge| {
            let middle = edge.energy(Interval::of(0.5), Interval::of(facet.balanced));
            middle.high
        });
        let least = sampled.into_iter().fold(f64::INFINITY, f64::min);
        let proofs = facet.prove(least + facet.resolved());
        assert!(
            proofs.contains(&Some(Proof::Refuted)),
            "facet {number}: {proofs:?}"
        );
    }
}
