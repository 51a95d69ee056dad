//! Steppers as plain data, with the feature `serde`. A loaded stepper is checked again.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::body::RigidPointBody;
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::Integrator;
use crate::real::Real;
use crate::scene::{Dynamics, Scene};
use crate::stepper::Stepper;

#[derive(Serialize, Deserialize)]
#[serde(rename = "Stepper")]
struct Parts<S, I> {
    scene: S,
    integrator: I,
}

impl<B, G, F, A, I, R, E> Serialize for Stepper<B, G, F, A, I, R, E>
where
    Scene<B, G, F, A, R, E>: Serialize,
    I: Serialize,
    R: Real,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Parts {
            scene: &self.scene,
            integrator: &self.integrator,
        }
        .serialize(serializer)
    }
}

impl<'de, B, G, F, A, I, R, E> Deserialize<'de> for Stepper<B, G, F, A, I, R, E>
where
    B: Deserialize<'de> + RigidPointBody<R>,
    G: Deserialize<'de> + SpringDamperGround<R>,
    F: Deserialize<'de> + SlidingFriction<R>,
    A: Deserialize<'de> + Gravity<R>,
    I: Deserialize<'de> + Integrator<R>,
    R: Real,
    E: Deserialize<'de> + Force<R>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let parts = Parts::<Scene<B, G, F, A, R, E>, I>::deserialize(deserializer)?;
        let integrator = &parts.integrator;
        (integrator
            .check()
            .and_then(|()| integrator.check_body(parts.scene.body())))
        .map_err(D::Error::custom)?;
        Ok(Self {
            scene: parts.scene,
            integrator: parts.integrator,
        })
    }
}
