//! How our lobes enter the laboratory: the example that every renderer follows.
//!
//! [`catalogue`] lists every case of every [`Kind`] in both precisions; the cases of lobes are in
//! `specimen/cases.rs`, those of stacks in `specimen/stacks.rs`, those of materials are the presets of
//! [`crate::material`], of which only the first of each material also runs in single precision. A lobe
//! without promises or without an arm there does not build; a kind without a case fails a test by name.

mod cases;
mod stacks;

use std::sync::Arc;
use std::time::{Duration, Instant};

use bxdf_tests::{
    Boundary, Claims, Direction, Energy, Examination, Family, Measure, Microsurface, Outcome, Parameter,
    Plan, Precision, Scale, Scatter, Suite, Transport, Verdict,
};
use rayon::prelude::*;

use crate::bxdf::{Bxdf, Pdf, TransportMode};
use crate::fresnel::{self, Fresnel, Polarized};
use crate::ior;
use crate::lobe::{
    DielectricSpecular, LayerError, Lobe, LobeKind, MicrofacetDielectric, MicrofacetReflection,
    OrenNayarModel,
};
use crate::material::{Material, MaterialError, Model, PRESETS, Preset};
use crate::microfacet::{Distribution, NoSmithForm, Shadowing, Shape};
use crate::parameter::OutOfRange;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::stack::Stack;

/// A BxDF of ours with its name and claims, as the laboratory sees it.
#[derive(Clone, Debug)]
pub struct BxdfSpecimen<F: Real> {
    name: String,
    bxdf: Arc<dyn Bxdf<F>>,
    claims: Claims,
    fresnel: Option<Fresnel<F>>,
    distribution: Option<Distribution<F>>,
    family: Option<LobeFamily<F>>,
}

impl<F: Real> BxdfSpecimen<F> {
    /// The specimen `name/precision` with the given claims.
    pub fn new(name: &str, bxdf: Arc<dyn Bxdf<F>>, claims: Claims) -> Self {
        let name = format!("{name}/{}", F::NAME);
        Self { name, bxdf, claims, fresnel: None, distribution: None, family: None }
    }

    /// The specimen `name/precision` of one of our lobes, with what the lobe promises.
    pub fn of_lobe(name: &str, lobe: impl Into<Lobe<F>>) -> Self {
        let lobe = lobe.into();
        let (fresnel, distribution) = terms(&lobe);
        let claims = promises(&lobe, fresnel);
        let family = LobeFamily::of(&lobe);
        Self { fresnel, distribution, family, ..Self::new(name, Arc::new(lobe), claims) }
    }

    /// The specimen `name/precision` of a stack, with what its components promise; about energy that says nothing.
    pub fn of_stack(name: &str, stack: Stack<F>, energy: Energy) -> Self {
        let parts: Vec<_> = stack.components().iter().map(|lobe| promises(lobe, None)).collect();
        let claims = Claims {
            two_sided: parts.iter().any(|part| part.two_sided),
            transmits: parts.iter().any(|part| part.transmits),
            isotropic: parts.iter().all(|part| part.isotropic),
            reciprocal: parts.iter().all(|part| part.reciprocal),
            energy: Some(energy),
            ..Claims::reflector(precision::<F>())
        };
        Self::new(name, Arc::new(stack), claims)
    }

    /// The specimen `name/precision` of a material, with what its lobes promise.
    pub fn of_material(name: &str, material: Material<F>) -> Self {
        let is_isotropic = material.is_isotropic();
        let specimen = match material.stack().components() {
            // What a lobe promises of its micro surface holds in the lobe's own frame.
            [lobe] if !material.is_turned() => Self::of_lobe(name, lobe.clone()),
            [Lobe::MicrofacetDielectric(single), Lobe::KullaContyDielectric(_)] if single.is_lossless() => {
                // Tables of 129 points, linear between them.
                Self::of_stack(name, material.stack().clone(), Energy::Lossless { within: 3e-3 })
            }
            _ => Self::of_stack(name, material.stack().clone(), Energy::Conserving),
        };
        let claims = Claims { isotropic: is_isotropic, ..specimen.claims };
        let claims =
            if rests_on_tables_alone(material.stack()) { Claims { energy: None, ..claims } } else { claims };
        Self { bxdf: Arc::new(material), claims, family: None, ..specimen }
    }

    /// The same specimen without the promise that turning it about the normal changes nothing.
    pub fn anisotropic(mut self) -> Self {
        self.family = None;
        self.claims.isotropic = false;
        self
    }

    /// The same specimen with another promise about energy.
    pub fn with_energy(mut self, energy: Energy) -> Self {
        self.family = None;
        self.claims.energy = Some(energy);
        self
    }
}

/// The lobes that differ from one in roughness and index only.
#[derive(Clone, Debug)]
struct LobeFamily<F: Real> {
    lobe: Lobe<F>,
    parameters: Vec<Parameter>,
}

/// From where single precision still resolves the lobe to the largest that the catalogue has.
const ALPHA: Parameter = Parameter { name: "alpha", low: 1e-3, high: 1.0, scale: Scale::Logarithmic };
/// From diamond seen from inside to diamond.
const ETA: Parameter = Parameter { name: "eta", low: 1.0 / 2.42, high: 2.42, scale: Scale::Logarithmic };

impl<F: Real> LobeFamily<F> {
    /// The family of a lobe, if it is natural to speak of one.
    fn of(lobe: &Lobe<F>) -> Option<Self> {
        let is_smith = |distribution: &Distribution<F>| distribution.shape() != Shape::Gaussian;
        let parameters = match lobe {
            Lobe::MicrofacetReflection(lobe) if is_smith(lobe.distribution()) => {
                vec![Parameter { name: "alpha_x", ..ALPHA }, Parameter { name: "alpha_y", ..ALPHA }]
            }
            Lobe::MicrofacetDielectric(lobe) if is_smith(lobe.distribution()) => vec![ALPHA, ETA],
            Lobe::DielectricSpecular(_) => vec![ETA],
            _ => return None,
        };
        Some(Self { lobe: lobe.clone(), parameters })
    }

    fn member(&self, values: &[f64]) -> Option<Lobe<F>> {
        let rough = |like: &Distribution<F>, [x, y]: [f64; 2]| {
            let rough = Distribution::new(like.shape(), F::from_f64(x), F::from_f64(y)).ok()?;
            rough.with_shadowing(like.shadowing()).ok()
        };
        Some(match (&self.lobe, values) {
            (Lobe::MicrofacetReflection(lobe), &[x, y]) => {
                MicrofacetReflection::new(rough(lobe.distribution(), [x, y])?, lobe.fresnel()).into()
            }
            // Where η − 1 has fewer than five digits, 1/η is no longer the inverse of η to the width of the lobe.
            (Lobe::MicrofacetDielectric(_), &[_, eta]) if (eta - 1.0).abs() < 1e5 * F::EPSILON.to_f64() => {
                return None;
            }
            (Lobe::MicrofacetDielectric(lobe), &[alpha, eta]) => {
                let distribution = rough(lobe.distribution(), [alpha, alpha])?;
                let [reflection, transmission] = lobe.tints();
                let lobe = MicrofacetDielectric::new(distribution, F::from_f64(eta)).ok()?;
                lobe.with_tints(reflection, transmission).ok()?.into()
            }
            (Lobe::DielectricSpecular(lobe), &[eta]) => {
                let [reflection, transmission] = lobe.tints();
                let lobe = DielectricSpecular::new(F::from_f64(eta)).ok()?;
                lobe.with_tints(reflection, transmission).ok()?.into()
            }
            _ => return None,
        })
    }
}

impl<F: Real> Family for LobeFamily<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn at(&self, values: &[f64]) -> Option<Box<dyn bxdf_tests::Specimen>> {
        Some(Box::new(BxdfSpecimen::of_lobe("member", self.member(values)?)))
    }
}

/// The floating-point type as the laboratory names it.
pub fn precision<F: Real>() -> Precision {
    if F::EPSILON.to_f64() == f64::EPSILON { Precision::F64 } else { Precision::F32 }
}

/// The Fresnel term and the micro surface that a lobe exposes.
fn terms<F: Real>(lobe: &Lobe<F>) -> (Option<Fresnel<F>>, Option<Distribution<F>>) {
    match lobe {
        Lobe::Lambertian(_)
        | Lobe::OrenNayar(_)
        | Lobe::Fabric(_)
        | Lobe::SpecularTransmission(_)
        | Lobe::ThinSheet(_)
        | Lobe::RefractiveLayer(_)
        | Lobe::KullaContyReflection(_)
        | Lobe::KullaContyDielectric(_) => (None, None),
        Lobe::SpecularReflection(lobe) => (Some(lobe.fresnel()), None),
        Lobe::DielectricSpecular(lobe) => (white_boundary(lobe.eta(), lobe.is_lossless()), None),
        Lobe::MicrofacetReflection(lobe) => (Some(lobe.fresnel()), rough(lobe.distribution())),
        Lobe::MicrofacetDielectric(lobe) => {
            (white_boundary(lobe.eta(), lobe.is_lossless()), rough(lobe.distribution()))
        }
    }
}

/// `true` where all orders of a metal add up to 1 in some channel but for the error of a table, 8e-4 up or
/// down: the red of gold that is fitted to sRGB.
fn rests_on_tables_alone<F: Real>(stack: &Stack<F>) -> bool {
    let [Lobe::MicrofacetReflection(single), Lobe::KullaContyReflection(_)] = stack.components() else {
        return false;
    };
    single.fresnel().reflectance(F::ONE).0.into_iter().any(|channel| channel > F::from_f64(0.999))
}

/// The distribution of a lobe unless the lobe is too smooth to be resolved.
fn rough<F: Real>(distribution: &Distribution<F>) -> Option<Distribution<F>> {
    (!distribution.is_smooth()).then_some(*distribution)
}

/// The Fresnel term of a boundary of dielectrics, as long as nothing is tinted.
fn white_boundary<F: Real>(eta: F, is_lossless: bool) -> Option<Fresnel<F>> {
    is_lossless.then_some(Fresnel::Dielectric { eta })
}

/// What a lobe promises.
fn promises<F: Real>(lobe: &Lobe<F>, fresnel: Option<Fresnel<F>>) -> Claims {
    let reflector = Claims::reflector(precision::<F>());
    let boundary = match fresnel {
        Some(Fresnel::Dielectric { eta }) => Some(Boundary { eta: [eta.to_f64(); 3], k: [0.0; 3] }),
        Some(Fresnel::Conductor { eta, k }) => Some(Boundary { eta: eta.to_f64(), k: k.to_f64() }),
        Some(Fresnel::Constant(_)) | None => None,
    };
    let lossless_if =
        |condition| Some(if condition { Energy::Lossless { within: 0.0 } } else { Energy::Conserving });
    match lobe {
        Lobe::Lambertian(_) => Claims { two_sided: true, invertible: true, ..reflector },
        Lobe::KullaContyReflection(_) => Claims { invertible: true, ..reflector },
        Lobe::KullaContyDielectric(_) => {
            Claims { two_sided: true, transmits: true, invertible: true, ..reflector }
        }
        Lobe::RefractiveLayer(_) => reflector,
        Lobe::OrenNayar(lobe) => {
            let largest = lobe.reflectance().to_f64().into_iter().fold(0.0, f64::max);
            let energy = match lobe.model() {
                OrenNayarModel::EnergyPreserving => lossless_if(lobe.reflectance() == Rgb::WHITE),
                // Where that is more than 1, roughness decides, and the model promises nothing.
                model => (largest * model.largest_albedo() <= 1.0).then_some(Energy::Conserving),
            };
            Claims { two_sided: true, energy, ..reflector }
        }
        Lobe::Fabric(lobe) => {
            let energy = lossless_if(lobe.reflectance() == Rgb::WHITE);
            Claims { two_sided: true, energy, ..reflector }
        }
        Lobe::SpecularReflection(_) => Claims { boundary, ..reflector },
        Lobe::DielectricSpecular(lobe) => {
            let energy = lossless_if(lobe.is_lossless());
            Claims { two_sided: true, transmits: true, energy, boundary, ..reflector }
        }
        Lobe::SpecularTransmission(lobe) => {
            let energy = lossless_if(lobe.transmittance() == Rgb::WHITE);
            Claims { two_sided: true, transmits: true, energy, ..reflector }
        }
        Lobe::ThinSheet(lobe) => {
            let energy = lossless_if(lobe.is_lossless());
            Claims { two_sided: true, transmits: true, energy, ..reflector }
        }
        Lobe::MicrofacetReflection(lobe) => {
            let isotropic = lobe.distribution().is_isotropic();
            let is_delta = lobe.flags().is_delta;
            let invertible = !is_delta && is_invertible(lobe.distribution());
            let least_cosine = if is_delta { 0.0 } else { least_cosine(lobe.distribution()) };
            Claims { isotropic, invertible, boundary, microfacet: !is_delta, least_cosine, ..reflector }
        }
        Lobe::MicrofacetDielectric(lobe) => {
            let is_delta = lobe.flags().is_delta;
            Claims {
                two_sided: true,
                transmits: true,
                isotropic: lobe.distribution().is_isotropic(),
                invertible: !is_delta && is_invertible(lobe.distribution()),
                energy: lossless_if(is_delta && lobe.is_lossless()),
                boundary,
                microfacet: !is_delta,
                ..reflector
            }
        }
    }
}

/// Below the cosine 16 ε / α the half vector of rounded directions, which is 2 cos θo long, is off by a thirtieth of the
/// lobe and more. That is 88.9° for α = 1e-4 in single precision; from α = 1e-3 on it is beyond every direction of the
/// laboratory's grid, and so it always is in double precision.
fn least_cosine<F: Real>(distribution: &Distribution<F>) -> f64 {
    let alpha = distribution.largest_alpha().to_f64();
    if alpha < ALPHA.low { 16.0 * F::EPSILON.to_f64() / alpha } else { 0.0 }
}

/// Whether a visible normal comes from one pair of uniforms, and the precision resolves the lobe about it. Of
/// a V-cavity it may be on either wall.
fn is_invertible<F: Real>(distribution: &Distribution<F>) -> bool {
    let is_resolved =
        precision::<F>() == Precision::F64 || distribution.smallest_alpha().to_f64() >= ALPHA.low;
    distribution.shadowing() != Shadowing::VCavity && is_resolved
}

fn mode(transport: Transport) -> TransportMode {
    match transport {
        Transport::Radiance => TransportMode::Radiance,
        Transport::Importance => TransportMode::Importance,
    }
}

impl<F: Real> bxdf_tests::Specimen for BxdfSpecimen<F> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn claims(&self) -> Claims {
        self.claims.clone()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.bxdf.eval(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi), mode(transport)).to_f64()
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.bxdf.pdf(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi), mode(transport)).to_f64()
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let [uc, u0, u1] = uniforms.map(F::from_f64);
        let sample = self.bxdf.sample(F::Vec3::from_f64(wo), uc, [u0, u1], mode(transport))?;
        Some(Scatter {
            wi: sample.wi.to_f64(),
            weight: sample.weight.to_f64(),
            density: match sample.pdf {
                Pdf::SolidAngle(density) => Measure::SolidAngle(density.to_f64()),
                Pdf::Discrete(probability) => Measure::Discrete(probability.to_f64()),
            },
            eta: sample.eta.to_f64(),
        })
    }

    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let cos_theta_i = F::from_f64(cos_theta_i);
        let pair = |Polarized { s, p }: Polarized<F>| [s.to_f64(), p.to_f64()];
        match self.fresnel? {
            Fresnel::Constant(_) => None,
            Fresnel::Dielectric { eta } => {
                let eta = if from_above { eta } else { F::ONE / eta };
                Some([pair(fresnel::dielectric(cos_theta_i, eta).reflectance); 3])
            }
            Fresnel::Conductor { eta, k } => Some(core::array::from_fn(|channel| {
                pair(fresnel::conductor(cos_theta_i, eta[channel], k[channel]).reflectance)
            })),
        }
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.distribution.as_ref().map(|distribution| distribution as &dyn Microsurface)
    }

    fn family(&self) -> Option<&dyn Family> {
        self.family.as_ref().map(|family| family as &dyn Family)
    }
}

impl<F: Real> Microsurface for Distribution<F> {
    fn d(&self, m: Direction) -> f64 {
        self.d(F::Vec3::from_f64(m)).to_f64()
    }
    fn lambda(&self, w: Direction) -> Option<f64> {
        self.lambda(F::Vec3::from_f64(w)).map(F::to_f64)
    }
    fn g1(&self, w: Direction, m: Direction) -> f64 {
        self.g1(F::Vec3::from_f64(w), F::Vec3::from_f64(m)).to_f64()
    }
    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        self.g2(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi), F::Vec3::from_f64(m)).to_f64()
    }
    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        self.samples_visible_normals()
            .then(|| self.visible_pdf(F::Vec3::from_f64(w), F::Vec3::from_f64(m)).to_f64())
    }
}

/// What the catalogue has cases of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A lobe by itself.
    Lobe(LobeKind),
    /// Several lobes as one BxDF.
    Stack,
    /// The presets of a material, the first of them in both precisions, the others in double precision.
    Material(Model),
    /// Every roughness with every material; not part of the catalogue, which has each of them somewhere.
    Grid,
}

impl Kind {
    /// The kinds that make the catalogue.
    pub fn catalogue() -> impl Iterator<Item = Self> {
        let lobes = LobeKind::ALL.iter().map(|&kind| Self::Lobe(kind));
        lobes.chain([Self::Stack]).chain(Model::ALL.iter().map(|&model| Self::Material(model)))
    }

    /// Its name, which means all its specimens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lobe(kind) => kind.name(),
            Self::Stack => "stack",
            Self::Material(model) => model.name(),
            Self::Grid => "grid",
        }
    }

    /// What it is, in one line.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Lobe(kind) => kind.summary(),
            Self::Stack => "several lobes as one BxDF",
            Self::Material(model) => model.summary(),
            Self::Grid => "rough conductors and dielectrics, every roughness with every index: the long form",
        }
    }

    /// How the names of its specimens begin: what stands before their `/case`.
    pub fn families(self) -> Vec<String> {
        let fixed: &[&str] = match self {
            Self::Lobe(kind) => match kind {
                LobeKind::Lambertian => &["lambertian"],
                LobeKind::OrenNayar => &["oren_nayar"],
                LobeKind::Fabric => &["fabric"],
                LobeKind::SpecularReflection => &["smooth_conductor", "ideal_mirror", "smooth_gloss"],
                LobeKind::DielectricSpecular => &["smooth_dielectric", "coloured_glass"],
                LobeKind::SpecularTransmission => &["ideal_transmission"],
                LobeKind::ThinSheet => &["thin_sheet"],
                LobeKind::MicrofacetReflection => {
                    &["rough_conductor", "rough_mirror", "smooth_limit", "rough_gloss"]
                }
                LobeKind::MicrofacetDielectric => &["rough_dielectric", "smooth_limit"],
                LobeKind::KullaContyReflection => &["higher_orders"],
                LobeKind::KullaContyDielectric => &["higher_orders_dielectric"],
                LobeKind::RefractiveLayer => &["coat"],
            },
            Self::Stack => &["stack"],
            Self::Material(model) => {
                let presets = PRESETS.iter().filter(|preset| preset.model == model);
                return presets.map(|preset| format!("material/{}", preset.name)).collect();
            }
            Self::Grid => &["grid"],
        };
        fixed.iter().map(|&family| family.to_owned()).collect()
    }

    /// Whether the name of one of its specimens may start so; none is built to find out.
    pub fn may_have(self, start: &str) -> bool {
        self.families().iter().any(|family| {
            family.starts_with(start)
                || start.strip_prefix(&**family).is_some_and(|case| case.starts_with('/'))
        })
    }

    fn cases<F: Real>(self) -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
        match self {
            Self::Lobe(kind) => cases::of_lobe(kind),
            Self::Stack => stacks::cases(),
            Self::Material(model) => presets(model),
            Self::Grid => cases::grid(),
        }
    }
}

/// The presets of a material: `material/preset`.
fn presets<F: Real>(model: Model) -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let presets = PRESETS.iter().filter(|preset| preset.model == model);
    let count = if precision::<F>() == Precision::F64 { usize::MAX } else { 1 };
    let specimen = |preset: &Preset| {
        Ok(BxdfSpecimen::of_material(&format!("material/{}", preset.name), preset.material()?))
    };
    presets.take(count).collect::<Vec<_>>().into_par_iter().map(specimen).collect()
}

/// Every case of every kind, in both precisions but for further presets of a material.
///
/// # Errors
/// Never for the parameters listed here; the constructors' errors are passed on rather than unwrapped.
pub fn catalogue() -> Result<Vec<Box<dyn bxdf_tests::Specimen>>, CatalogueError> {
    let kinds: Vec<_> = Kind::catalogue().collect();
    let kinds: Vec<_> = kinds.into_par_iter().map(specimens_of).collect::<Result<_, _>>()?;
    Ok(kinds.into_iter().flatten().collect())
}

/// Every case of one kind, in both precisions.
///
/// # Errors
/// As [`catalogue`].
pub fn specimens_of(kind: Kind) -> Result<Vec<Box<dyn bxdf_tests::Specimen>>, CatalogueError> {
    // Some lobes tabulate integrals when they are made.
    let (double, single) = rayon::join(|| kind.cases::<f64>(), || kind.cases::<f32>());
    let mut specimens: Vec<Box<dyn bxdf_tests::Specimen>> = Vec::new();
    specimens.extend(double?.into_iter().map(|case| Box::new(case) as _));
    specimens.extend(single?.into_iter().map(|case| Box::new(case) as _));
    Ok(specimens)
}

/// Runs the given suites, where they apply, on every specimen, in parallel; the verdicts are in the order of the
/// specimens.
///
/// `found` is called with each violated verdict at once, before anything is done to explain it; `finished` with the name
/// of each specimen that is done, and the time it took.
pub fn verify(
    specimens: &[Box<dyn bxdf_tests::Specimen>],
    suites: &[Suite],
    plan: &Plan,
    found: &(dyn Fn(&Verdict) + Sync),
    finished: &(dyn Fn(&str, Duration) + Sync),
) -> Vec<Verdict> {
    let verdicts: Vec<Vec<Verdict>> = specimens
        .par_iter()
        .with_max_len(1)
        .map(|specimen| {
            let start = Instant::now();
            let examination = Examination::new(&**specimen, plan);
            let verdicts = suites.iter().filter_map(|&suite| {
                let verdict = examination.verdict(suite)?;
                if verdict.outcome == Outcome::Violated {
                    found(&verdict);
                }
                Some(examination.explained(verdict))
            });
            let verdicts = verdicts.collect();
            finished(examination.name(), start.elapsed());
            verdicts
        })
        .collect();
    verdicts.into_iter().flatten().collect()
}

/// A case of the catalogue that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum CatalogueError {
    /// A parameter of a lobe is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// A coat that cannot be put on its base.
    #[error(transparent)]
    Layer(#[from] LayerError),
    /// A masking that the distribution does not have.
    #[error(transparent)]
    Shadowing(#[from] NoSmithForm),
    /// An optical constant is not to be had.
    #[error(transparent)]
    Ior(#[from] ior::IorError),
    /// A preset that is not a material.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_cases_in_both_precisions() {
        let is_material = |kind: &Kind| matches!(kind, Kind::Material(_));
        for kind in Kind::catalogue().chain([Kind::Grid]).filter(|kind| !is_material(kind)) {
            let single = kind.cases::<f32>().unwrap().len();
            assert!(single > 0, "{} has no cases", kind.name());
            assert_eq!(single, kind.cases::<f64>().unwrap().len());
        }
    }

    #[test]
    fn every_material_and_every_preset_is_examined() {
        let mut examined = Vec::new();
        for &model in Model::ALL {
            let [single, double] = [
                Kind::Material(model).cases::<f32>().unwrap().len(),
                Kind::Material(model).cases::<f64>().unwrap().len(),
            ];
            assert!(double > 0, "{} has no preset", model.name());
            assert_eq!(single, 1, "{} in single precision", model.name());
            examined.extend(specimens_of(Kind::Material(model)).unwrap().iter().map(|case| case.name()));
        }
        for preset in PRESETS {
            assert!(examined.contains(&format!("material/{}/f64", preset.name)), "{}", preset.name);
        }
    }

    #[test]
    fn names_are_unique_and_begin_as_their_kind_says() {
        let mut all = Vec::new();
        for kind in Kind::catalogue().chain([Kind::Grid]) {
            let names: Vec<_> = specimens_of(kind).unwrap().iter().map(|case| case.name()).collect();
            for name in &names {
                assert!(kind.may_have(name), "{name} of {}", kind.name());
            }
            for family in kind.families() {
                assert!(names.iter().any(|name| name.starts_with(&family)), "{family} of {}", kind.name());
            }
            all.extend(names);
        }
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
