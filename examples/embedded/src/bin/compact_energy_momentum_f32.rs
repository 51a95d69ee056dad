//! The coin, by `CompactEnergyMomentum` in `f32`, with memory for 16 contacts.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tumble::integrator::EnergyMomentumWorkspace;

type Compact<R> = tumble::CompactEnergyMomentum<16, R>;

coin_firmware::firmware!(toss, f32, Compact, EnergyMomentumWorkspace::new());
