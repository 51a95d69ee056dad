//! What tells one scene from another, for a workspace that may go from stepper to stepper.

use crate::body::RigidPointBody;
use crate::ground::{SpringDamperGround, Surface};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// What tells the energies of one scene from another's: mass, moments, reach, how many contacts and
/// how many points its rim stands for, gravity, the surface as seen from the body, and the springs
/// at a depth of its reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fingerprint<R: Real> {
    body: [R; 2],
    moments: R::Vec3,
    contacts: usize,
    rim: R,
    gravity: R::Vec3,
    surface: Surface<R>,
    spring: [R; 2],
}

impl<R: Real> Fingerprint<R> {
    #[inline]
    pub(super) fn of<D: Dynamics<R>>(scene: &D, state: &State<R>) -> Self {
        let (ground, bounding_radius) = (scene.ground(), scene.bounding_radius());
        Self {
            body: [scene.inertia_properties().mass(), bounding_radius],
            moments: scene.inertia_properties().moments(),
            contacts: scene.body().contacts().len(),
            rim: (scene.body().rims().first()).map_or(R::ZERO, |rim| rim.points()),
            gravity: scene.gravity(),
            surface: scene.probe(|| ground.surface(state.position)),
            spring: scene.probe(|| {
                [
                    ground.spring_force(bounding_radius),
                    ground.spring_energy(bounding_radius),
                ]
            }),
        }
    }
}
