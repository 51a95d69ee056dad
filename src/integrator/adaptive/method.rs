//! What adaptive Runge-Kutta methods have in common: their parameters, and the interface to their
//! pair.

/// Implements an adaptive method by the `PAIR` of its file. The method is a struct with the fields
/// `tolerance`, `longest_step` and `budget`.
macro_rules! adaptive_method {
    ($method:ident, order $order:literal) => {
        impl<R: crate::real::Real> $method<R> {
            /// Creates the method for a tolerance (m), with steps of at most 0.1 s and a budget of
            /// a million steps.
            #[must_use]
            pub fn new(tolerance: R) -> Self {
                Self {
                    tolerance,
                    longest_step: R::from_f64(0.1),
                    budget: 1_000_000,
                }
            }

            fn settings(&self) -> crate::integrator::adaptive::embedded_pair::Settings<R> {
                crate::integrator::adaptive::embedded_pair::Settings {
                    tolerance: self.tolerance,
                    longest_step: self.longest_step,
                    budget: self.budget,
                }
            }
        }

        const _: () = {
            use crate::error::{SceneError, StepError};
            use crate::integrator::adaptive::embedded_pair::{self, Workspace};
            use crate::integrator::interface::{Integrator, Step, StepControl};
            use crate::real::Real;
            use crate::scene::Dynamics;
            use crate::state::State;

            impl<R: Real> Integrator<R> for $method<R> {
                type Workspace = Workspace<R>;

                const ADAPTIVE: bool = true;

                fn step<D: Dynamics<R>>(
                    &self,
                    scene: &D,
                    state: &mut State<R>,
                    limit: R,
                    workspace: &mut Workspace<R>,
                ) -> Result<Step<R>, StepError> {
                    embedded_pair::step((&PAIR, &self.settings()), scene, state, limit, workspace)
                }

                fn order(&self) -> u32 {
                    $order
                }

                #[inline]
                fn step_control(
                    &self,
                    workspace: &Self::Workspace,
                    state: &State<R>,
                ) -> Option<StepControl<R>> {
                    Some(workspace.step_control(state))
                }

                #[inline]
                fn set_step_control(
                    &self,
                    workspace: &mut Self::Workspace,
                    control: StepControl<R>,
                ) {
                    workspace.set_step_control(control);
                }

                fn check(&self) -> Result<(), SceneError> {
                    self.settings().check()
                }
            }
        };
    };
}

pub(super) use adaptive_method;
