//! Ensembles and the merge of their parts.

#[path = "../../ensemble.rs"]
mod ensemble;
