//! What the method keeps from step to step to save work.

use super::contacts::Contacts;
use super::touch::Touch;
use crate::energy::Energy;
use crate::integrator::interface::Step;
use crate::real::Real;
use crate::state::State;

/// Data that [`EnergyMomentum`](crate::EnergyMomentum) and
/// [`CompactEnergyMomentum`](crate::CompactEnergyMomentum) keep from step to step to save work: up
/// to `CONTACTS` contact points, the last energy, and the state that a step has left unchanged.
///
/// The workspace never changes a result: a new one gives the same bits. What it keeps of a state is
/// used for the same state only. It [belongs to one scene](crate::Integrator::Workspace).
#[derive(Clone, Debug)]
pub struct Workspace<R: Real = f64, const CONTACTS: usize = 128> {
    pub(super) contacts: Contacts<R, [Touch<R>; CONTACTS]>,
    memory: Memory<R>,
}

/// The last state of a workspace.
#[derive(Clone, Debug)]
pub(super) struct Memory<R: Real> {
    /// State after the last step, if it is known.
    known: Option<State<R>>,
    /// Energy of that state. A pair of both would be built on the stack and copied.
    energy: Energy<R>,
    /// Length of a step that has left that state unchanged, s, and the work of drives in it, J.
    rest: Option<[R; 2]>,
}

impl<R: Real, const CONTACTS: usize> Default for Workspace<R, CONTACTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<R: Real, const CONTACTS: usize> Workspace<R, CONTACTS> {
    /// Creates an empty workspace. It can be created at compile time and placed in a `static` if
    /// the stack is small.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(CONTACTS > 0, "a workspace stores at least one contact") };
        Self {
            contacts: Contacts::NONE,
            memory: Memory {
                known: None,
                energy: Energy {
                    translation: R::ZERO,
                    rotation: R::ZERO,
                    gravity: R::ZERO,
                    springs: R::ZERO,
                },
                rest: None,
            },
        }
    }

    /// Empties the workspace in place. The contacts stay, because each step collects them anew.
    #[inline]
    pub(in crate::integrator) fn clear(&mut self) {
        (self.memory.known, self.memory.rest) = (None, None);
    }

    /// The contacts, of which the step is compiled once for all numbers, and the last state.
    #[inline]
    pub(super) fn parts(&mut self) -> (&mut Contacts<R>, &mut Memory<R>) {
        (&mut self.contacts, &mut self.memory)
    }
}

impl<R: Real> Memory<R> {
    /// Returns the work of drives in a step of this length (J), if it is known to leave this state
    /// unchanged.
    #[inline]
    pub(super) fn work_at_rest(&self, state: &State<R>, seconds: R) -> Option<R> {
        let [length, work] = self.rest?;
        (length == seconds && self.energy(state).is_some()).then_some(work)
    }

    /// Energy of this state, if the last step has ended with this state.
    #[inline]
    pub(super) fn energy(&self, state: &State<R>) -> Option<Energy<R>> {
        (self.known.as_ref()? == state).then_some(self.energy)
    }

    /// Notes the states at the start and at the end of a step, the energy of the end, and the step.
    #[inline]
    pub(super) fn note(
        &mut self,
        [start, end]: [&State<R>; 2],
        energy: &Energy<R>,
        step: &Step<R>,
    ) {
        (self.known, self.energy) = (Some(*end), *energy);
        self.rest = (end == start).then_some([step.elapsed, step.drive_work]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page of `CompactEnergyMomentum` states these sizes.
    #[cfg(target_pointer_width = "64")]
    #[test]
    fn the_memory_of_a_workspace_is_as_stated() {
        let single = [size_of::<Workspace<f32, 12>>(), size_of::<Workspace<f32>>()];
        let double = [size_of::<Workspace<f64, 12>>(), size_of::<Workspace<f64>>()];
        let tenths_of_kilobytes = |bytes: usize| (bytes + 50) / 100;
        assert_eq!(single.map(tenths_of_kilobytes), [24, 215]);
        assert_eq!(double.map(tenths_of_kilobytes), [47, 427]);
    }

    /// A drive may do work on a body that it does not move. A new workspace would report that work.
    #[test]
    fn a_step_at_rest_has_the_work_of_its_drives() {
        let mut workspace = Workspace::<f64, 1>::new();
        let memory = &mut workspace.memory;
        let (state, energy) = (State::default(), memory.energy);
        let step = Step {
            drive_work: 0.25,
            ..Step::new(0.5, 0)
        };
        memory.note([&state, &state], &energy, &step);
        assert_eq!(memory.work_at_rest(&state, 0.5), Some(0.25));
        assert_eq!(memory.work_at_rest(&state, 1.0), None);
        let mut moved = state;
        moved.position.x = 1.0;
        memory.note([&state, &moved], &energy, &step);
        assert_eq!(memory.work_at_rest(&moved, 0.5), None);
    }
}
