//! Scenes as plain data, with the feature `serde`. A loaded scene is composed, and checked, again.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Scene;
use crate::body::RigidPointBody;
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::real::Real;

#[derive(Serialize, Deserialize)]
#[serde(rename = "Scene")]
struct Parts<B, G, F, A, E> {
    body: B,
    ground: G,
    friction: F,
    gravity: A,
    force: E,
}

impl<B, G, F, A, R, E> Serialize for Scene<B, G, F, A, R, E>
where
    B: Serialize,
    G: Serialize,
    F: Serialize,
    A: Serialize,
    E: Serialize,
    R: Real,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Parts {
            body: &self.body,
            ground: &self.ground,
            friction: &self.friction,
            gravity: &self.gravity,
            force: &self.force,
        }
        .serialize(serializer)
    }
}

impl<'de, B, G, F, A, R, E> Deserialize<'de> for Scene<B, G, F, A, R, E>
where
    B: Deserialize<'de> + RigidPointBody<R>,
    G: Deserialize<'de> + SpringDamperGround<R>,
    F: Deserialize<'de> + SlidingFriction<R>,
    A: Deserialize<'de> + Gravity<R>,
    E: Deserialize<'de> + Force<R>,
    R: Real,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let parts = Parts::deserialize(deserializer)?;
        Scene::new(parts.body, parts.ground, parts.friction, parts.gravity)
            .and_then(|scene| scene.with_force(parts.force))
            .map_err(D::Error::custom)
    }
}
