//! Rims on the ground: the arc that touches.
//!
//! A Gauss rule is accurate for smooth functions. So the arc is cut at the discontinuities of its
//! forces ([`discontinuities`](mod@discontinuities)). Quadrature points are concentrated near
//! points at which friction reverses ([`turning_rules`]).
//!
//! On a level plane, penetration depth and velocity are linear in sine and cosine along the arc,
//! and a short arc is evaluated as a [`Sweep`]. Any other arc is evaluated point by point
//! ([`visit_any`]).

mod arcs;
mod discontinuities;
mod step;
mod sweep;
mod turning_rules;

use arcs::Placed;
use discontinuities::{Discontinuities, Velocities, discontinuities_over};
pub(crate) use step::RimStep;
use sweep::{Sweep, visit_between};

use super::invariants;
use super::point::Contact;
use crate::body::{Arc, ContactPoint, Panel, Panels, QUARTER, Rim, SHORT};
use crate::friction::SlidingFriction;
use crate::ground::{GroundBounds, OneSurface, Plane, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Lowest point of a rim, m, body axes.
pub(super) fn lowest<R: Real, G: SpringDamperGround<R>>(
    rim: &Rim<R>,
    ground: &G,
    position: R::Vec3,
    axes: &Axes<R>,
) -> R::Vec3 {
    match ground.bounds() {
        GroundBounds::Plane(plane) => rim.support_point(axes.to_body(-plane.normal)),
        _ => rim.place(arcs::lowest(&Placed::new(rim, ground, position, axes))),
    }
}

/// Part of a rim that touches.
pub(super) enum Touching<R: Real> {
    Nothing,
    /// Short arc below a level plane.
    Arc(Sweep<R>),
    /// More than a quarter of the circle, or an arc on another ground.
    Any,
}

impl<R: Real> Touching<R> {
    #[inline(always)]
    pub(super) fn of<G: SpringDamperGround<R>, F: SlidingFriction<R>>(
        laws: (&G, &F),
        rim: &Rim<R>,
        motion: &Motion<R>,
    ) -> Self {
        match laws.0.bounds() {
            GroundBounds::Plane(plane) if plane == Plane::level(plane.height) => {
                Self::above(laws, plane.height, rim, motion)
            }
            _ => Self::Any,
        }
    }

    #[inline(always)]
    fn above<G: SpringDamperGround<R>, F: SlidingFriction<R>>(
        laws: (&G, &F),
        height: R,
        rim: &Rim<R>,
        motion: &Motion<R>,
    ) -> Self {
        let centre = motion.axes.to_world(rim.centre());
        let axes = motion.axes.both_to_world(rim.axes());
        let gap = motion.position.z() + centre.z() - height;
        match rim.arc_of([axes[0].z(), axes[1].z()], gap) {
            Arc::Nothing => Self::Nothing,
            Arc::Part {
                lowest,
                chord,
                extent,
            } if chord <= R::from_f64(QUARTER) => {
                let spokes = rim.spokes(axes, lowest);
                let velocities = Velocities::of_spokes(motion, centre, spokes);
                let position = if laws.1.depends_on_position() {
                    motion.position + (centre + spokes[0])
                } else {
                    motion.position
                };
                let sweep = Sweep::of(laws, rim, velocities, [chord, extent], lowest, position);
                Self::Arc(sweep)
            }
            _ => Self::Any,
        }
    }
}

/// Energy of the springs under a rim, J, and the number of quadrature points that touch.
#[inline]
pub(super) fn spring_energy<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    laws: (&OneSurface<'_, G>, &F),
    rim: &Rim<R>,
    at_rest: &Motion<R>,
) -> (R, usize) {
    let (mut energy, mut touching) = (R::ZERO, 0);
    match Touching::of(laws, rim, at_rest) {
        Touching::Nothing => {}
        Touching::Arc(sweep) => (energy, touching) = sweep.spring_energy(laws.0),
        Touching::Any => visit_any(laws, rim, at_rest, &mut |contact| {
            energy += laws.0.spring_energy(contact.depth) * contact.weight;
            touching += 1;
        }),
    }
    (energy, touching)
}

/// Discontinuities of the forces on a panel. They are computed for the plane under its middle, with
/// the penetration depths of the actual ground.
fn discontinuities_of<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    laws: (&G, &F),
    rim: &Rim<R>,
    motion: &Motion<R>,
    panel: Panel<R>,
) -> Discontinuities<R> {
    let (ground, axes) = (laws.0, &motion.axes);
    let under = |s: R| ground.surface(motion.position + axes.to_world(rim.place_on(panel, s)));
    let [down, across] = rim.spokes(axes.both_to_world(rim.axes()), panel.middle());
    let spin = motion.angular_velocity;
    let velocities = Velocities::of_slopes(
        motion.velocity_at(axes.to_world(rim.centre())),
        [spin.cross(down), spin.cross(across)],
    );
    let chord = panel.chord();
    let middle = motion.position + axes.to_world(rim.place_on(panel, R::ZERO));
    let normal = ground.surface(middle).normal;
    let depth = |u: R| -under(u * chord).gap;
    let mut discontinuities =
        discontinuities_over(laws, chord, [middle, normal], &velocities, &depth);
    // The energy needs the same number of points.
    discontinuities.add_points(if chord <= R::from_f64(SHORT) { 6 } else { 8 });
    discontinuities
}

/// Calls `visit` with each quadrature point of a rim. This is the general method, valid for every
/// arc and ground.
#[inline(never)]
pub(super) fn visit_any<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    laws: (&OneSurface<'_, G>, &F),
    rim: &Rim<R>,
    motion: &Motion<R>,
    visit: &mut dyn FnMut(&Contact<R>),
) {
    let arcs = arcs::below(rim, laws.0, motion.position, &motion.axes);
    let density = rim.points() * R::from_f64(core::f64::consts::FRAC_1_PI);
    let panels = |arc: Arc<R>| Panels::of(arc, core::iter::empty());
    for panel in arcs.get().iter().flat_map(|arc| panels(*arc).into_iter()) {
        let discontinuities = discontinuities_of(laws, rim, motion, panel);
        visit_between(
            &discontinuities,
            panel.chord(),
            [-R::ONE, R::ONE],
            |s, length| {
                let point = ContactPoint::bare(rim.place_on(panel, s));
                // dθ = 2 ds/√(1 - s²)
                let weight = density * length / ((R::ONE - s) * (R::ONE + s)).sqrt();
                if let Some(contact) = Contact::of(laws.0, motion, &point, weight) {
                    debug_assert!(invariants::touches(&contact, laws.0.index() + 1));
                    visit(&contact);
                }
            },
        );
    }
}
