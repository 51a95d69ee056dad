//! The coin, by `EnergyMomentum` in `f32`.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tumble::EnergyMomentum;
use tumble::integrator::EnergyMomentumWorkspace;

coin_firmware::firmware!(toss, f32, EnergyMomentum, EnergyMomentumWorkspace::new());
