//! Why a step failed: an invalid state, a law that breaks its contract, or the method itself.
//!
//! A step only tests that values are sound, and goes on. The reason is found afterwards, by the
//! same motion with a scene that examines every value.

use super::Stepper;
use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{Quantity, StepError};
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::{Integrator, Step};
use crate::real::Real;
use crate::scene::{DiagnosedScene, Dynamics, Record};
use crate::state::State;

impl<R, B, G, F, A, I, E> Stepper<B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    /// Result of a step that failed, or during which a value of a law failed a test. Returns the
    /// step if rounding explains the value. Otherwise returns an error and restores the state from
    /// before the step.
    #[cold]
    #[inline(never)]
    pub(super) fn examined(
        &self,
        outcome: Result<Step<R>, StepError>,
        limit: R,
        (before, state): (&State<R>, &mut State<R>),
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let covered = outcome.map_or(limit, |step| step.elapsed);
        let broken_law = self.broken_law(before, covered);
        let error = match (broken_law, outcome, state.not_finite()) {
            (None, Ok(step), None) if step.elapsed > R::ZERO => return Ok(step),
            (None, Ok(_), None) => StepError::Stalled,
            (Some(error), _, _) => {
                // The workspace may refer to a state that is no longer valid.
                self.integrator.clear(workspace);
                error
            }
            (None, Ok(_), Some(quantity)) => blame(before, quantity),
            // An invalid state can also cause an error of the energy, so the state is checked
            // first.
            (None, Err(error), _) => {
                (before.not_finite()).map_or(error, |quantity| before.error_of(quantity))
            }
        };
        *state = *before;
        Err(error)
    }

    /// Integrates the motion from `before` again for `seconds` and examines every value that a law
    /// returns. Returns the error of the first value that breaks the contract by more than
    /// rounding.
    ///
    /// A method that chooses its steps may take several, because its memory is not the same. If the
    /// step failed, `seconds` may be far more than the method has covered, so the work is limited.
    fn broken_law(&self, before: &State<R>, seconds: R) -> Option<StepError> {
        if self.scene.is_trusted() {
            return None;
        }
        let record = Record::new();
        let scene = DiagnosedScene::of(&self.scene, &record);
        let (mut state, mut workspace) = (*before, I::Workspace::default());
        let (mut left, mut evaluations) = (seconds, 0_u32);
        for _ in 0..MOST_STEPS {
            let integrator = &self.integrator;
            let Ok(step) = integrator.step(&scene, &mut state, left, &mut workspace) else {
                break;
            };
            left -= step.elapsed;
            evaluations = evaluations.saturating_add(step.evaluations);
            if left <= R::ZERO || evaluations >= MOST_EVALUATIONS || !record.is_empty() {
                break;
            }
        }
        broken_law(&self.scene, before, &record)
    }
}

/// Largest number of steps by which a step of an adaptive method is repeated to find a broken law.
const MOST_STEPS: u32 = 256;

/// Number of evaluations of the contact forces after which such a repetition ends: eight for each
/// of [`MOST_STEPS`] steps, more than an explicit pair needs. A step of `AdaptiveEnergyMomentum`
/// that has to be divided can take as many alone.
const MOST_EVALUATIONS: u32 = 2048;

/// Error for a step whose result is not finite: [`StepError::BadState`] if the state before it was
/// invalid, else [`StepError::Diverged`].
#[cold]
fn blame<R: Real>(before: &State<R>, after: Quantity) -> StepError {
    before.check().err().unwrap_or(StepError::Diverged(after))
}

/// Error for the value that broke the contract of a law during a step from the state `before`.
///
/// A negative spring energy may be rounding: of the energy of the body, which hides it, or of the
/// terms in the law's own formula. For example, `e^x - 1 - x` has a rounding error relative to 1 at
/// every x. Those terms are assumed to be as large as the energy at a penetration depth of 1 m.
fn broken_law<R: Real>(
    scene: &impl Dynamics<R>,
    before: &State<R>,
    record: &Record<R>,
) -> Option<StepError> {
    if record.is_empty() {
        return None;
    }
    let energy = Energy::of(scene, before);
    let terms = energy.translation
        + energy.rotation
        + energy.gravity.abs()
        + energy.springs.abs()
        + energy_at_a_metre_of_all(scene);
    let rounding = terms * (R::EPSILON * R::from_f64(LAW_ROUNDING));
    let (quantity, value) = record.violation(rounding)?;
    Some(StepError::BrokenLaw {
        quantity,
        value: value.to_f64(),
    })
}

/// Units in the last place of the sum of all terms below which a negative spring energy counts as
/// rounding.
const LAW_ROUNDING: f64 = 8.0;

/// Sum over the surfaces of the ground of [`energy_at_a_metre`], J.
fn energy_at_a_metre_of_all<R: Real>(scene: &impl Dynamics<R>) -> R {
    let model = scene.contact_model();
    (0..model.surfaces()).fold(R::ZERO, |sum, surface| {
        sum + energy_at_a_metre(&model.laws_of(surface).0)
    })
}

/// Spring energy of a contact at a penetration depth of 1 m, J. If it is not finite there, the
/// depth is halved until it is. The result is at least 0.
fn energy_at_a_metre<R: Real>(ground: &impl SpringDamperGround<R>) -> R {
    let mut depth = R::ONE;
    for _ in 0..64 {
        let energy = ground.spring_energy(depth);
        if energy.is_finite() {
            return energy.at_least(R::ZERO);
        }
        depth *= R::HALF;
    }
    R::ZERO
}
