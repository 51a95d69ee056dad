//! Force and torque of all contacts together.

use super::level;
use super::load::Load;
use super::model::ContactModel;
use super::point::Contact;
use super::rims::{self, Touching};
use super::visit::Visitor;
use crate::body::{ContactRange, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Sum of the forces of contacts on a body with the given axes.
struct Sum<'a, R: Real, G, F> {
    laws: (&'a G, &'a F),
    axes: &'a Axes<R>,
    load: &'a mut Load<R>,
}

impl<R: Real, G, F> Visitor<R> for Sum<'_, R, G, F>
where
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    // As a function of its own, which the compiler makes of it otherwise, it would keep the step
    // from being inlined into its loop.
    #[inline(always)]
    fn enter(&mut self, contact: &Contact<R>) {
        let force = contact.force(self.laws.0, self.laws.1);
        self.load.add_along(self.axes, contact, force);
    }
}

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Force and torque of all contacts, without gravity.
    ///
    /// The sums equal those of [`visit`](Self::visit) except for rounding, if friction lies in the
    /// surface. For bare points on a level plane a component across it is left out, and the torque
    /// is summed in another fixed order.
    #[inline(always)]
    #[must_use]
    pub fn load(&self, motion: &Motion<R>) -> Load<R> {
        let range = self.range_within(R::ZERO, motion.position, &motion.axes);
        self.load_on(range, motion)
    }

    /// Force and torque of the contacts in `range`, without gravity.
    ///
    /// Use it to evaluate the same pose again with other velocities.
    #[inline(always)]
    #[must_use]
    pub fn load_on(&self, range: ContactRange, motion: &Motion<R>) -> Load<R> {
        self.load_with_arms(range, motion, None)
    }

    /// Load of the contacts in `range`. With `arm_axes`, the torque is that of the same forces on a
    /// body with these axes.
    #[inline(always)]
    pub(crate) fn load_with_arms(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
        arm_axes: Option<&Axes<R>>,
    ) -> Load<R> {
        if range.count == 0 && (self.body.rims().is_empty() || self.is_aloft(motion)) {
            return Load::default();
        }
        let mut load = self.load_of_forces(range, motion, arm_axes);
        if let Some(torque) = self.turning_torque(range, motion) {
            load.torque += torque;
        }
        load
    }

    #[inline(always)]
    fn load_of_forces(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
        arm_axes: Option<&Axes<R>>,
    ) -> Load<R> {
        let laws = (self.ground, self.friction);
        let axes = arm_axes.unwrap_or(&motion.axes);
        let mut load = Load::default();
        if let Some(height) = self.height_under_bare_points() {
            return if self.ground_moves() {
                self.load_on_level(height, range, &self.seen(motion), arm_axes)
            } else {
                self.load_on_level(height, range, motion, arm_axes)
            };
        }
        self.visit_on(
            range,
            motion,
            Sum {
                laws,
                axes,
                load: &mut load,
            },
        );
        load
    }

    /// Load of a body of bare points, and of its rims, on a level plane at this height, for the
    /// motion as the ground sees it.
    #[inline(always)]
    fn load_on_level(
        &self,
        height: R,
        range: ContactRange,
        motion: &Motion<R>,
        arm_axes: Option<&Axes<R>>,
    ) -> Load<R> {
        let parts = range.parts(self.body.contacts());
        let laws = (self.ground, self.friction);
        let mut load = level::load(laws, height, parts, motion, arm_axes);
        if !self.body.rims().is_empty() {
            let axes = arm_axes.unwrap_or(&motion.axes);
            self.add_load_of_rims(motion, axes, &mut load);
        }
        load
    }

    /// Adds the load of the rims on a body with these axes.
    #[inline(never)]
    fn add_load_of_rims(&self, motion: &Motion<R>, axes: &Axes<R>, load: &mut Load<R>) {
        // Only a ground of one surface is a level plane.
        let laws = self.laws_of(0);
        let laws = (&laws.0, &laws.1);
        for rim in self.body.rims() {
            match Touching::of(laws, rim, motion) {
                Touching::Nothing => {}
                Touching::Arc(sweep) => {
                    sweep.load(laws, rim, [&motion.axes, axes], motion.position, load)
                }
                Touching::Any => rims::visit_any(laws, rim, motion, &mut |contact| {
                    load.add_along(axes, contact, contact.force(self.ground, self.friction));
                }),
            }
        }
    }

    /// Torque of rolling resistance of the contacts in `range`, N m. Returns `None` if the friction
    /// law has no rolling resistance.
    #[inline(always)]
    pub(super) fn turning_torque(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
    ) -> Option<R::Vec3> {
        self.friction.rolling_resistance(R::ZERO)?;
        let mut sum = R::Vec3::ZERO;
        let turning = self.seen(motion).angular_velocity;
        self.visit_on(range, motion, |contact: &Contact<R>| {
            sum += contact.turning_torque(self.ground, self.friction, turning);
        });
        Some(sum)
    }
}
