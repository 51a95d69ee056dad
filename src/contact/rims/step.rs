//! Rims over an implicit step: what touches at its start or at its end.

use super::arcs;
use super::discontinuities::{Discontinuities, Velocities, discontinuities};
use crate::body::{Arc, Panels, Rim};
use crate::friction::SlidingFriction;
use crate::ground::{Plane, SpringDamperGround};
use crate::real::Real;
use crate::rotation::Axes;

/// Step of a body with rims above one surface of the ground.
pub(crate) struct RimStep<'a, R: Real, G, F, V> {
    /// Surface and friction law.
    pub(crate) laws: (&'a G, &'a F),
    /// The surface, if it is a plane.
    pub(crate) plane: Option<Plane<R>>,
    /// Position of the centre of mass (m) and axes of the body at the start and at the end.
    pub(crate) poses: [(R::Vec3, Axes<R>); 2],
    /// Mean velocity of the centre of mass, and that of the ground's material under the body, m/s.
    pub(crate) velocities: [R::Vec3; 2],
    /// Mean velocity that the rotations of body and ground add at an arm at the start (m, world
    /// axes), m/s.
    pub(crate) turning: V,
}

impl<R, G, F, V> RimStep<'_, R, G, F, V>
where
    R: Real,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    V: Fn(R::Vec3) -> R::Vec3,
{
    /// Number of rims that touch a plane at the start or at the end. On a surface of another shape,
    /// all of them count.
    #[inline]
    pub(crate) fn touching(&self, rims: &[Rim<R>]) -> usize {
        if self.plane.is_none() {
            return rims.len();
        }
        let touches = |rim: &&Rim<R>| {
            self.poses.iter().any(|(position, axes)| {
                let arcs = arcs::below(rim, self.laws.0, *position, axes);
                arcs.get().iter().any(|arc| *arc != Arc::Nothing)
            })
        };
        rims.iter().filter(touches).count()
    }

    /// Panels of a rim below the surface at the start or at the end, cut at the discontinuities of
    /// friction on the arcs of the time with the longer one.
    #[inline]
    pub(crate) fn panels(&self, rim: &Rim<R>) -> Panels<R> {
        let [(start, start_axes), (end, end_axes)] = &self.poses;
        let at_start = arcs::below(rim, self.laws.0, *start, start_axes);
        let at_end = arcs::below(rim, self.laws.0, *end, end_axes);
        let longer = if at_start.longest() < at_end.longest() {
            &at_end
        } else {
            &at_start
        };
        let cuts = |arc: Arc<R>| {
            let discontinuities = self.discontinuities(rim, &arc);
            discontinuities.places().map(move |u| arc.place(u))
        };
        Panels::of_all(
            [at_start.get(), at_end.get()],
            &mut longer.parts().flat_map(cuts),
        )
    }

    /// Positions on an arc at which the forces of the mean velocities have a discontinuity of their
    /// derivative.
    fn discontinuities(&self, rim: &Rim<R>, arc: &Arc<R>) -> Discontinuities<R> {
        let [(start, axes), _] = &self.poses;
        let turning = |v: R::Vec3| (self.turning)(axes.to_world(v));
        let [down, across] = rim.axes();
        let slopes = [turning(down * rim.radius()), turning(across * rim.radius())];
        let [velocity, drift] = self.velocities;
        let middle = velocity + turning(rim.centre()) - drift;
        let velocities = Velocities::along(arc, middle, slopes);
        let (ground, friction) = self.laws;
        let position = if friction.depends_on_position() {
            let [lowest, _] = rim.spokes(rim.axes(), arc.place(R::ZERO));
            *start + axes.to_world(rim.centre() + lowest)
        } else {
            *start
        };
        let normal = match &self.plane {
            Some(plane) => plane.normal,
            None => ground.surface(*start + axes.to_world(rim.centre())).normal,
        };
        discontinuities(self.laws, arc, [position, normal], &velocities)
    }
}
