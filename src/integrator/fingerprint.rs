//! Fingerprint of a scene, for a workspace that may be passed from one stepper to another.

use crate::body::RigidPointBody;
use crate::force::Force;
use crate::ground::{SpringDamperGround, Surface};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Numbers that distinguish the energies of one scene from those of another.
///
/// The numbers belong to the body, the gravity and the ground:
/// - mass, moments and bounding radius
/// - number of contacts, and number of points that the rims represent
/// - gravity with the applied force and with the motion of the ground, and the surface relative to
///   the body
/// - force and energy of a spring at a penetration depth of the bounding radius
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) struct Fingerprint<R: Real> {
    body: [R; 2],
    moments: R::Vec3,
    contacts: usize,
    rims: R,
    gravity: R::Vec3,
    surface: Surface<R>,
    spring: [R; 2],
}

impl<R: Real> Fingerprint<R> {
    #[inline]
    pub(in crate::integrator) fn of<D: Dynamics<R>>(scene: &D, state: &State<R>) -> Self {
        let bounding_radius = scene.bounding_radius();
        let (surface, spring) = scene.probe(|| sums_of_surfaces(scene, state.position));
        Self {
            body: [scene.inertia_properties().mass(), bounding_radius],
            moments: scene.inertia_properties().moments(),
            contacts: scene.body().contacts().len(),
            rims: (scene.body().rims().iter()).fold(R::ZERO, |sum, rim| sum + rim.points()),
            gravity: accelerated(scene, state),
            surface,
            spring,
        }
    }
}

/// Sums over the surfaces of the ground: gap and normal at the body, and force and energy of a
/// spring at a penetration depth of the bounding radius.
#[inline]
fn sums_of_surfaces<R: Real, D: Dynamics<R>>(scene: &D, position: R::Vec3) -> (Surface<R>, [R; 2]) {
    let (model, depth) = (scene.contact_model(), scene.bounding_radius());
    let of_surface = |index| {
        let ground = model.laws_of(index).0;
        let spring = [ground.spring_force(depth), ground.spring_energy(depth)];
        (ground.surface(position), spring)
    };
    let (mut sum, [mut force, mut energy]) = of_surface(0);
    // A ground of one surface adds nothing, not even zeros.
    for index in 1..model.surfaces() {
        let (surface, spring) = of_surface(index);
        sum.gap += surface.gap;
        sum.normal += surface.normal;
        force += spring[0];
        energy += spring[1];
    }
    (sum, [force, energy])
}

/// Acceleration by gravity, with the applied force at the state. Its torque is added as the
/// acceleration at a lever arm of the radius of gyration, whatever the direction. The motion of the
/// ground is added as numbers, so that a body does not sleep on when the ground begins to move.
#[inline]
fn accelerated<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> R::Vec3 {
    let mut gravity = scene.gravity();
    if let Some(ground) = scene.ground().motion() {
        gravity += ground.velocity + ground.angular_velocity;
    }
    if !scene.force().acts() {
        return gravity;
    }
    let applied = scene.probe(|| scene.force().wrench(&scene.motion(state)));
    let properties = scene.inertia_properties();
    let per_torque = properties.largest_inverse_moment() * properties.radius_of_gyration();
    gravity + applied.force * properties.inverse_mass() + applied.torque * per_torque
}
