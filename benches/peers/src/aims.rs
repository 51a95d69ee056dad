//! The figures that the project aims at, each beside what is measured.
//!
//! Every aim is an upper bound. A figure is a ratio of one run where that is possible.

mod alone;
mod beside;
mod stored;

/// A figure with the bound that it is to keep.
pub(crate) struct Aim {
    pub(crate) what: String,
    pub(crate) at_most: f64,
    /// `None` if no setting that was tried has the accuracy that is asked.
    pub(crate) measured: Option<f64>,
    pub(crate) unit: &'static str,
}

impl Aim {
    fn new(what: impl Into<String>, at_most: f64, measured: Option<f64>) -> Self {
        Self {
            what: what.into(),
            at_most,
            measured,
            unit: "",
        }
    }

    fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    pub(crate) fn is_reached(&self) -> bool {
        self.measured
            .is_some_and(|measured| measured <= self.at_most)
    }
}

/// Measures all of them. It takes some five minutes.
pub(crate) fn measure(turns: usize) -> Result<Vec<Aim>, String> {
    let mut aims = Vec::from(beside::of_one_tolerance(turns)?);
    aims.extend(beside::of_loose_tolerances(turns)?);
    aims.extend(beside::of_free_rotation(turns)?);
    aims.extend(beside::of_stick(turns)?);
    aims.extend(alone::of_contacts()?);
    aims.push(alone::of_long_steps()?);
    aims.push(alone::of_rest()?);
    aims.extend(alone::of_single_precision()?);
    aims.extend(stored::of_round_edges()?);
    aims.extend(stored::of_tosses()?);
    Ok(aims)
}
