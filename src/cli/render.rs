//! `gonio render`: pictures of scenes, pass by pass.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use gonio::file;
use gonio::material::file::{Syntax, text_of};
use gonio::message::Severity;
use gonio::render::image::{self, Largest, Layers, Picture};
use gonio::render::scene_file::{self, BUILTIN, Rendering};
use gonio::render::{Camera, Film, render};
use maud::{DOCTYPE, html};

use super::snippet::{self, Lines};
use super::{Failure, General, print};

/// How long a pass is meant to take: one can wait for it, and passes cost nothing.
const PASS: Duration = Duration::from_secs(2);
/// How often files are written while samples are added.
const WRITTEN_EVERY: Duration = Duration::from_secs(10);
/// Share of paths that may end inside of something: rounding at edges does that.
const LOST: f64 = 1e-4;

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Scene files, TOML or JSON, or names of the scenes that come with gonio; --scenes lists them
    #[arg(required_unless_present = "scenes")]
    files: Vec<PathBuf>,
    /// Lists the scenes that come with gonio
    #[arg(long)]
    scenes: bool,
    /// The folder that pictures go to, as SCENE.png and SCENE.exr
    #[arg(short, long, default_value = ".", value_name = "FOLDER")]
    output: PathBuf,
    /// Samples per pixel, in place of those of the file
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    spp: Option<u32>,
    /// Ends after so many seconds, at the pass that is done then
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time: Option<f64>,
    /// Ends when the standard error of the picture is this share of its mean
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    noise: Option<f64>,
    /// Width and height in place of those of the file
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[usize; 2]>,
    /// Seed in place of that of the file
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Brightens the PNG by so many stops; the EXR is as it is
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: f32,
    /// In uniform light of radiance 1 and no other: what loses nothing vanishes
    #[arg(long)]
    furnace: bool,
    /// Keeps SCENE.checkpoint beside the picture, and goes on from it if it is there
    #[arg(long)]
    resume: bool,
    /// Compares with a picture, .exr or .png, and writes SCENE-error.png
    #[arg(long, value_name = "IMAGE")]
    compare: Option<PathBuf>,
    /// Writes FOLDER/index.html: a sheet of all pictures of this command
    #[arg(long)]
    sheet: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err(format!("{text} is not > 0")) }
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let parts = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    parts
        .filter(|size| size.iter().all(|side| (1..=65_536).contains(side)))
        .ok_or_else(|| format!("`{text}` is no size: expected WIDTHxHEIGHT, 1 to 65536 each"))
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    if options.scenes {
        let width = BUILTIN.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
        let lines = BUILTIN.iter().map(|scene| format!("{:<width$}  {}\n", scene.name, scene.summary));
        print(&lines.collect::<String>())?;
        return Ok(ExitCode::SUCCESS);
    }
    let stop = interruption()?;
    let mut shown = Vec::new();
    for file in &options.files {
        let Some(picture) = one(file, options, general, &stop)? else { return Ok(ExitCode::from(2)) };
        shown.push(picture);
        if stop.load(Ordering::Relaxed) {
            break;
        }
    }
    if options.sheet {
        let path = options.output.join("index.html");
        file::write(&path, sheet(&shown).as_bytes())?;
        print(&format!("{}\n", path.display()))?;
    }
    // What a shell says of an interrupted command.
    Ok(if stop.load(Ordering::Relaxed) { ExitCode::from(130) } else { ExitCode::SUCCESS })
}

/// A picture as the sheet shows it.
struct Shown {
    name: String,
    size: [usize; 2],
    /// What the first line of its file says.
    summary: String,
    samples: u32,
}

/// A page that shows pictures of its own folder.
fn sheet(shown: &[Shown]) -> String {
    const STYLE: &str = "body { margin: 2rem auto; max-width: 110rem; padding: 0 1rem; background: #1d1f21; \
        color: #e8e8e8; font: 15px/1.45 system-ui, sans-serif } \
        main { display: flex; flex-wrap: wrap; gap: 1.5rem } figure { margin: 0; flex: 0 1 auto } \
        img { display: block; height: 18rem; width: auto; max-width: 100%; object-fit: contain } \
        figcaption { max-width: 22rem; padding-top: .4rem; color: #b9bcc0 } b { color: #fff }";
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "Scenes" }
                style { (STYLE) }
            }
            body {
                main {
                    @for Shown { name, size: [width, height], summary, samples } in shown {
                        figure {
                            img src=(format!("{name}.png")) width=(width) height=(height) alt=(summary);
                            figcaption { b { (name) } " " (summary) " " (samples) " samples per pixel." }
                        }
                    }
                }
            }
        }
    }
    .into_string()
}

/// Set at the first interrupt; the second one ends the program at once.
fn interruption() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("interrupted: writing what there is; once more ends at once");
    })?;
    Ok(stop)
}

/// The rendering that a file or a name means; what is wrong is told.
fn rendering(file: &Path) -> Result<Option<(Rendering, String)>, Failure> {
    let builtin = file.to_str().and_then(|name| BUILTIN.iter().find(|scene| scene.name == name));
    let (text, syntax) = match builtin {
        Some(scene) if !file.exists() => (scene.text.to_owned(), Syntax::Toml),
        _ => match text_of(file) {
            Ok(text) => (text, Syntax::of(file)),
            Err(finding) => {
                let names: Vec<&str> = BUILTIN.iter().map(|scene| scene.name).collect();
                return Err(
                    format!("{}; scenes that come with gonio: {}", finding.text, names.join(", ")).into()
                );
            }
        },
    };
    let (rendering, findings) = scene_file::read(&text, syntax, file.parent().unwrap_or(Path::new("")));
    let lines = Lines::of(&text);
    for finding in &findings {
        if finding.code.severity() != Severity::Note {
            eprintln!("{}\n", snippet::render(finding, &file.display().to_string(), &lines));
        }
    }
    Ok(rendering.map(|rendering| (rendering, text)))
}

fn one(
    file: &Path,
    options: &Options,
    general: &General,
    stop: &AtomicBool,
) -> Result<Option<Shown>, Failure> {
    let Some((mut rendering, text)) = rendering(file)? else { return Ok(None) };
    if options.furnace {
        rendering.scene = rendering.scene.in_furnace();
    }
    if let Some(size) = options.size {
        rendering.camera = rendering.camera.with_size(size)?;
    }
    rendering.settings.seed = options.seed.unwrap_or(rendering.settings.seed);
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let path = |ending: &str| options.output.join(format!("{stem}{ending}"));
    let identity = identity(&text, &rendering, options.furnace)?;
    let mut film = begin(&path(".checkpoint"), identity, &rendering.camera, options.resume)?;
    let reference = options.compare.as_deref().map(image::read).transpose()?;
    let wanted = options.spp.unwrap_or(rendering.samples);
    let begun = Instant::now();
    let (mut written, mut per_pass, mut lost) = (Instant::now(), 1, 0);
    let before = film.samples();
    let limit = options.time.map(Duration::from_secs_f64);
    loop {
        let left = wanted.saturating_sub(film.samples());
        if left == 0 {
            break;
        }
        let pass = Instant::now();
        let Rendering { scene, camera, settings, .. } = &rendering;
        lost += render(scene, camera, settings, &mut film, per_pass.min(left), stop).lost_paths;
        if stop.load(Ordering::Relaxed) {
            // The pass is not on the film, which may have no new sample to tell the time that is left from.
            break;
        }
        let (took, spent) = (pass.elapsed(), begun.elapsed());
        let is_quiet = options.noise.is_some_and(|noise| film.samples() > 1 && film.noise() <= noise);
        if is_quiet || limit.is_some_and(|limit| spent >= limit) {
            break;
        }
        if took < PASS / 2 {
            per_pass = per_pass.saturating_mul(2);
        }
        if let Some(limit) = limit {
            // The next pass ends in time.
            let rate = f64::from(film.samples() - before) / spent.as_secs_f64();
            per_pass = per_pass.min(((limit - spent).as_secs_f64() * rate).ceil().max(1.0) as u32);
        }
        if written.elapsed() >= WRITTEN_EVERY && film.samples() < wanted {
            write(&film, &path, options, identity)?;
            written = Instant::now();
            if !general.quiet {
                let left =
                    spent.mul_f64(f64::from(wanted - film.samples()) / f64::from(film.samples() - before));
                let noise = 100.0 * film.noise();
                let seconds = limit.map_or(left, |limit| left.min(limit.saturating_sub(spent))).as_secs();
                eprintln!(
                    "{stem}: {} of {wanted} samples, noise {noise:.2} %, {seconds} s left",
                    film.samples()
                );
            }
        }
    }
    if film.samples() == 0 {
        return Err("interrupted before the first pass was done: no picture".into());
    }
    let picture = write(&film, &path, options, identity)?;
    let paths = film.size()[0] as f64 * film.size()[1] as f64 * f64::from(film.samples() - before);
    if lost as f64 > LOST * paths {
        eprintln!(
            "warning: {lost} of {paths} paths of {stem} ended inside of something: a surface has a hole, normals point \
             inside, or the camera is in glass"
        );
    }
    print(&format!(
        "{}  {} samples, noise {:.2} %, {:.1} s\n",
        path(".png").display(),
        film.samples(),
        100.0 * film.noise(),
        begun.elapsed().as_secs_f64()
    ))?;
    if let Some(reference) = reference {
        let comparison = image::compare(&picture, &reference)?;
        let error = path("-error.png");
        // A black picture has an error, too.
        let scale = (comparison.largest.error.abs() as f32).max(f32::MIN_POSITIVE);
        file::write(&error, &comparison.map.false_color(scale)?.to_png_clipped()?)?;
        let Largest { error: largest, x, y, .. } = comparison.largest;
        print(&format!(
            "mean error {:+.3e}, rms {:.3e}, relative mean square {:.3e}, FLIP {:.4}, largest {largest:+.3e} at ({x}, {y})\n\
             {}  0 is black, {scale:.1e} is white\n",
            comparison.mean_error,
            comparison.rms,
            comparison.relative_mse,
            comparison.flip_mean,
            error.display()
        ))?;
    }
    let summary = text.lines().next().and_then(|line| line.strip_prefix('#')).unwrap_or_default().trim();
    Ok(Some(Shown {
        name: stem.into_owned(),
        size: film.size(),
        summary: summary.to_owned(),
        samples: film.samples(),
    }))
}

/// An empty film, or the one that is to be gone on with.
fn begin(checkpoint: &Path, identity: u64, camera: &Camera, resume: bool) -> Result<Film, Failure> {
    if !resume || !checkpoint.exists() {
        return Ok(Film::new(camera.size()));
    }
    let shown = checkpoint.display();
    let bytes = fs::read(checkpoint).map_err(|error| format!("cannot read {shown}: {error}"))?;
    Film::resumed(&bytes, identity, camera.size()).map_err(|error| format!("{shown}: {error}").into())
}

/// A number that is another one for another scene, other settings or other files.
fn identity(text: &str, rendering: &Rendering, is_furnace: bool) -> Result<u64, Failure> {
    let mut hash = Fnv::new();
    hash.add(text.as_bytes());
    hash.add(format!("{:?} {:?} {is_furnace}", rendering.settings, rendering.camera).as_bytes());
    for file in &rendering.files {
        let metadata =
            fs::metadata(file).map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        hash.add(format!("{} {:?}", metadata.len(), metadata.modified().ok()).as_bytes());
    }
    Ok(hash.0)
}

/// FNV-1a (Fowler, Noll & Vo), 64 bits: the same on every machine.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Writes the picture, its layers and, if asked for, the checkpoint.
fn write(
    film: &Film,
    path: &dyn Fn(&str) -> PathBuf,
    options: &Options,
    identity: u64,
) -> Result<Picture, Failure> {
    let layers = Layers::of(film)?;
    file::write(&path(".png"), &layers.color.to_png(options.exposure)?)?;
    file::write(&path(".exr"), &layers.to_exr()?)?;
    if options.resume {
        file::write(&path(".checkpoint"), &film.checkpoint(identity))?;
    }
    Ok(layers.color)
}
