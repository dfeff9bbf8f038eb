//! A scene: objects, lights, surroundings, and the nearest object along a ray.

use core::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};

use super::light::{Arrival, Light, require_light};
use super::shape::{Bounds, Emission, Hit, Ray, Shape, Surface};
use crate::material::Material;
use crate::parameter::OutOfRange;
use crate::rgb::Rgb;

/// A shape with what it is made of.
#[derive(Debug)]
pub struct Object {
    /// Where it is.
    pub shape: Box<dyn Shape>,
    /// Its material; without one it is black.
    pub material: Option<usize>,
    /// What each point of it emits, on the side of its normal, per channel \[W/(m² sr)\].
    pub emission: Rgb<f32>,
}

/// What is around everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// Radiance from every direction, which lights the scene.
    pub radiance: Rgb<f32>,
    /// What the camera sees in its place, where it sees nothing else.
    pub background: Option<Rgb<f32>>,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self { radiance: Rgb::BLACK, background: None }
    }
}

/// Why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A number that a light does not take.
    #[error(transparent)]
    Light(#[from] OutOfRange),
    /// An object names a material that is not there.
    #[error("object {object} names material {material}, and there are {materials}")]
    NoSuchMaterial {
        /// Which object, from 0.
        object: usize,
        /// What it names.
        material: usize,
        /// How many there are.
        materials: usize,
    },
    /// Glass without an inside: light that goes in would never come out.
    #[error("object {object} is not closed, and `{model}` needs an inside: close it, or use thin_glass")]
    NotClosed {
        /// Which object, from 0.
        object: usize,
        /// What fills it.
        model: &'static str,
    },
}

/// Up to so many objects a ray asks each: no hierarchy is faster.
const FEW: usize = 4;

/// Everything that light meets.
#[derive(Debug)]
pub struct Scene {
    objects: Vec<Object>,
    materials: Vec<Material<f32>>,
    surroundings: Surroundings,
    lights: Vec<Source>,
    hierarchy: Option<Hierarchy>,
    /// What the camera is in.
    medium: Option<Medium>,
}

/// One side of the surface of an object, which may absorb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Medium {
    pub(super) material: usize,
    pub(super) is_inside: bool,
}

struct Hierarchy(Bvh2);

impl core::fmt::Debug for Hierarchy {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "hierarchy of {} nodes", self.0.nodes.len())
    }
}

/// Something that next-event estimation can pick, with its probability.
#[derive(Clone, Copy, Debug)]
struct Source {
    kind: SourceKind,
    probability: f32,
}

#[derive(Clone, Copy, Debug)]
enum SourceKind {
    Light(Light),
    Object(usize),
}

struct Boxed(Aabb);

impl Boundable for Boxed {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Scene {
    /// A scene of objects, the materials that they name by index, and lights.
    ///
    /// # Errors
    /// If an object names a material that is not there or fills an open shape with glass, or a light is no light.
    pub fn new(
        objects: Vec<Object>,
        materials: Vec<Material<f32>>,
        lights: Vec<Light>,
        surroundings: Surroundings,
    ) -> Result<Self, SceneError> {
        for (index, object) in objects.iter().enumerate() {
            require_light("emission", object.emission)?;
            let Some(material) = object.material else { continue };
            let Some(of_object) = materials.get(material) else {
                let materials = materials.len();
                return Err(SceneError::NoSuchMaterial { object: index, material, materials });
            };
            if of_object.has_inside() && !object.shape.is_closed() {
                let model = of_object.description().model().name();
                return Err(SceneError::NotClosed { object: index, model });
            }
        }
        require_light("radiance", surroundings.radiance)?;
        require_light("background", surroundings.background.unwrap_or(Rgb::BLACK))?;
        let hierarchy = (objects.len() > FEW).then(|| {
            let boxes: Vec<_> = objects.iter().map(|object| boxed(object.shape.bounds())).collect();
            let parameters = BvhBuildParams::medium_build();
            Hierarchy(build_bvh2(&boxes, parameters, &mut Duration::default()))
        });
        let lights = sources(&objects, &lights);
        Ok(Self { objects, materials, surroundings, lights, hierarchy, medium: None })
    }

    /// The same scene with the camera inside of a material.
    #[must_use]
    pub fn seen_from_inside(self, material: usize) -> Self {
        let medium = Medium { material, is_inside: true };
        Self { medium: (material < self.materials.len()).then_some(medium), ..self }
    }

    /// The same objects in uniform light of radiance 1 and no other: what loses nothing cannot be seen.
    #[must_use]
    pub fn in_furnace(mut self) -> Self {
        self.lights.clear();
        self.objects.iter_mut().for_each(|object| object.emission = Rgb::BLACK);
        self.surroundings = Surroundings { radiance: Rgb::WHITE, background: None };
        self
    }

    /// Its objects.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    pub(super) fn medium(&self) -> Option<Medium> {
        self.medium
    }

    /// What a medium leaves of light over a distance.
    #[inline]
    pub(super) fn transmittance(&self, medium: Option<Medium>, distance: f32) -> Rgb<f32> {
        medium.map_or(Rgb::WHITE, |Medium { material, is_inside }| {
            self.materials[material].transmittance(distance, is_inside)
        })
    }

    pub(super) fn material(&self, index: usize) -> &Material<f32> {
        &self.materials[index]
    }

    pub(super) fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    pub(super) fn has_lights(&self) -> bool {
        !self.lights.is_empty()
    }

    /// The first object along a ray.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<(usize, Hit)> {
        let mut nearest = None;
        let mut limit = f32::INFINITY;
        let mut meet = |index: usize, limit: f32| {
            let hit = self.objects[index].shape.intersect(ray, limit)?;
            nearest = Some((index, hit));
            Some(hit.distance)
        };
        match &self.hierarchy {
            None => (0..self.objects.len()).for_each(|index| limit = meet(index, limit).unwrap_or(limit)),
            Some(Hierarchy(hierarchy)) => {
                let query = obvhs::ray::Ray::new_inf(ray.origin.into(), ray.direction.into());
                hierarchy.ray_traverse(query, &mut RayHit::none(), |query, leaf| {
                    let index = hierarchy.primitive_indices[leaf] as usize;
                    meet(index, query.tmax).unwrap_or(f32::INFINITY)
                });
            }
        }
        nearest
    }

    /// Does anything stand in the way of a ray, up to a distance?
    #[inline]
    fn occludes(&self, ray: &Ray, distance: f32) -> bool {
        match &self.hierarchy {
            None => self.objects.iter().any(|object| object.shape.occludes(ray, distance)),
            Some(Hierarchy(hierarchy)) => {
                let (origin, direction) = (ray.origin.into(), ray.direction.into());
                let query = obvhs::ray::Ray::new(origin, direction, 0.0, distance);
                !hierarchy.ray_traverse_miss(query, |_, leaf| {
                    let index = hierarchy.primitive_indices[leaf] as usize;
                    let is_met = self.objects[index].shape.occludes(ray, distance);
                    if is_met { 0.0 } else { f32::INFINITY }
                })
            }
        }
    }

    /// Light from one of the sources, its probability included; whether it gets here is another question.
    pub(super) fn sample_light(&self, from: Vec3, uc: f32, u: [f32; 2]) -> Option<Arrival> {
        let mut rest = uc;
        let picked = self.lights.iter().find(|source| {
            let is_picked = rest < source.probability;
            rest -= source.probability;
            is_picked
        });
        let Source { kind, probability } = picked.or(self.lights.last())?;
        let arrival = match kind {
            SourceKind::Light(light) => light.sample(from, u)?,
            SourceKind::Object(index) => {
                let object = &self.objects[*index];
                let Emission { direction, distance, pdf } = object.shape.sample(from, u)?;
                Arrival { direction, distance, weight: object.emission / pdf, pdf: Some(probability * pdf) }
            }
        };
        Some(Arrival { weight: arrival.weight / *probability, ..arrival })
    }

    /// Does light arrive at a surface?
    pub(super) fn arrives(&self, surface: &Surface, arrival: &Arrival) -> bool {
        !self.occludes(&surface.leave(arrival.direction), arrival.distance)
    }

    /// Density \[sr⁻¹\] with which [`Self::sample_light`] finds the point of an emitting object that a ray has met.
    pub(super) fn light_pdf(&self, object: usize, from: Vec3, surface: &Surface) -> f32 {
        let is_it = |source: &&Source| matches!(source.kind, SourceKind::Object(index) if index == object);
        self.lights
            .iter()
            .find(is_it)
            .map_or(0.0, |source| source.probability * self.objects[object].shape.pdf(from, surface))
    }
}

fn boxed(Bounds { low, high }: Bounds) -> Boxed {
    Boxed(Aabb::new(Vec3A::from(low), Vec3A::from(high)))
}

/// Lights and emitting objects, picked by their power.
fn sources(objects: &[Object], lights: &[Light]) -> Vec<Source> {
    let of_objects = objects.iter().enumerate().map(|(index, object)| {
        let power = core::f32::consts::PI * object.shape.area() * object.emission.luminance();
        (SourceKind::Object(index), power)
    });
    let of_lights = lights.iter().map(|light| (SourceKind::Light(*light), light.power()));
    let all: Vec<_> = of_objects.chain(of_lights).filter(|&(_, power)| power > 0.0).collect();
    let sum: f64 = all.iter().map(|&(_, power)| f64::from(power)).sum();
    all.into_iter()
        .map(|(kind, power)| Source { kind, probability: (f64::from(power) / sum) as f32 })
        .collect()
}
