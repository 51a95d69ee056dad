//! The coin, by `SymplecticEuler` in `f64`.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tumble::SymplecticEuler;
use tumble::body::ContactRange;

coin_firmware::firmware!(toss, f64, SymplecticEuler, ContactRange::NONE);
