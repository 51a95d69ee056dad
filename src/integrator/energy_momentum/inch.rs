//! The last resort: a step that always exists.

use super::ratchet;
use crate::energy::Energy;
use crate::integrator::Step;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// A semi-implicit Euler step under the forces of the start, for `seconds`, a quarter of them, a sixteenth, ... until its energy is not above the one before.
///
/// Such a length exists wherever forces act: velocities first, then places, so that a body at rest loses `(h F)²/m` of potential and gains half of it. The
/// time that is not used passes all the same: such a step is stable, not accurate. `None` where not even the smallest motion that numbers can hold lowers the energy.
pub(super) fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    energy: Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) -> Option<(State<R>, Energy<R>)> {
    let motion = scene.motion(start);
    let load = scene.load(&motion);
    let properties = scene.mass_properties();
    let acceleration = load.force * properties.inverse_mass() + scene.gravity();
    let rotation = start.rotation();
    let mut length = seconds;
    // 4⁻⁶⁰ = 2⁻¹²⁰ of a step.
    for _ in 0..60 {
        let linear_velocity = start.linear_velocity + acceleration * length;
        let angular_momentum =
            properties.without_dead_spin(rotation, start.angular_momentum + load.torque * length);
        let end = State {
            position: start.position + linear_velocity * length,
            linear_velocity,
            orientation: properties
                .turn_freely(rotation, &motion.axes, angular_momentum, length)
                .to_quat(),
            angular_momentum,
        };
        // Too short for numbers to hold: it will not be lower than where it began.
        if end.position == start.position && end.orientation == start.orientation {
            return None;
        }
        if end.not_finite().is_none() {
            let (end_energy, touching) = Energy::with_touching(scene, &end);
            if let Some(kept) = ratchet::hold(scene, start, energy, end, end_energy, touching, step)
            {
                return Some(kept);
            }
        }
        length *= R::from_f64(0.25);
    }
    None
}
