//! A million steps of 50 tosses, by `EnergyMomentum` in `f32`. Each step is tested.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tumble::EnergyMomentum;
use tumble::integrator::EnergyMomentumWorkspace;

coin_firmware::firmware!(
    many_tosses,
    f32,
    EnergyMomentum,
    EnergyMomentumWorkspace::new()
);
