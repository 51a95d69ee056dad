//! Energy in the springs of the ground under a body.

use super::model::ContactModel;
use super::point::Contact;
use super::rims;
use crate::body::RigidPointBody;
use crate::friction::SlidingFriction;
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::state::Motion;

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Energy in the springs, J, and the number of contacts that touch.
    #[inline]
    pub(crate) fn spring_energy(&self, motion: &Motion<R>) -> (R, usize) {
        let (mut energy, mut touching) = (R::ZERO, 0);
        let range = self.range_within(R::ZERO, motion.position, &motion.axes);
        self.visit_points(range, motion, &mut |contact: &Contact<R>| {
            let ground = OneSurface::of(self.ground, contact.surface);
            energy += ground.spring_energy(contact.depth);
            touching += 1;
        });
        if self.body.rims().is_empty() {
            return (energy, touching);
        }
        let (of_rims, places) = self.rims_energy(motion);
        (energy + of_rims, touching + places)
    }

    /// Energy in the springs under the rims, J, and the number of quadrature points that touch.
    ///
    /// The energy is evaluated for a body at rest in the same pose. The quadrature of the forces of
    /// a rim depends on the velocities, but an energy must depend on the pose only.
    pub(crate) fn rims_energy(&self, motion: &Motion<R>) -> (R, usize) {
        let (mut energy, mut touching) = (R::ZERO, 0);
        let at_rest = Motion {
            linear_velocity: R::Vec3::ZERO,
            angular_velocity: R::Vec3::ZERO,
            ..*motion
        };
        for surface in 0..self.surfaces() {
            let laws = self.laws_of(surface);
            for rim in self.body.rims() {
                let (stored, places) = rims::spring_energy((&laws.0, &laws.1), rim, &at_rest);
                energy += stored;
                touching += places;
            }
        }
        (energy, touching)
    }
}
