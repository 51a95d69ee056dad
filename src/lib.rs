#![no_std]
//! One rigid body on a spring-damper ground.
