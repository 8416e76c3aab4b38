//! `gingerbread render`: pictures and films of the stage, without a window or a display.
//!
//! Frames are taken at equal intervals of simulated time, so that a slow computer records as smoothly as a fast one.

use crate::{
    app::{FilmFormat, Options, Stage},
    command::Command,
    elements::Field,
    files,
    headless::{
        Ending, HeadlessError, Interrupt, Outputs, Overrides, Progress, ProgressOptions, inputs, read, seconds,
    },
    level::Level,
    link,
    picture::Picture,
    sandbox::Sandbox,
    snapshot::Snapshot,
};
use std::path::PathBuf;

/// What to draw and where.
#[derive(Clone, Debug, clap::Args)]
pub struct Render {
    /// A level file, or the name of a built-in level.
    pub level: PathBuf,
    /// Write the picture here: a film if it ends in .mp4 or .gif, the last frame if it ends in .png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Simulated time \[s\].
    #[arg(long, default_value = "3", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Settings that replace the level's own.
    #[command(flatten)]
    pub overrides: Overrides,
    /// Width and height \[pixels\], each in \[16, 4096\]; those of an MP4 film are even.
    #[arg(long, default_value = "480x480", value_parser = size)]
    pub size: [usize; 2],
    /// Frames per second of simulated time, and of a film, in \[1, 60\]; at most 50 in a GIF.
    #[arg(long, default_value = "25", value_parser = clap::value_parser!(u32).range(1..=60))]
    pub rate: u32,
    /// Colours of the stage.
    #[arg(long, value_enum, default_value = "dark")]
    pub theme: Theme,
    /// What colours the triangles.
    #[arg(long, value_enum, default_value = "plain")]
    pub colour: Colouring,
    /// Holds the ends of the colour scale at this distance from the value at rest, in the unit of the field, instead of following the values.
    #[arg(long, value_parser = positive, requires = "colour")]
    pub range: Option<f64>,
    /// Draw the edges of triangles.
    #[arg(long)]
    pub wireframe: bool,
    /// From where it is seen, as `camera` in a link: X,Y,SCALE in the plane, and X,Y,Z,RADIUS,YAW,PITCH in space. If not given, as the link says, or the whole.
    #[arg(long, value_name = "NUMBERS", value_parser = camera, allow_hyphen_values = true)]
    pub camera: Option<link::Camera>,
    /// How progress is shown.
    #[command(flatten)]
    pub progress_options: ProgressOptions,
}

/// Theme of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Theme {
    /// By night.
    Dark,
    /// By day.
    Light,
}

/// What colours the triangles of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Colouring {
    /// Nothing.
    Plain,
    /// Elastic energy density.
    Energy,
    /// Von Mises stress.
    VonMises,
    /// Ratio of areas, det F.
    J,
    /// Greater principal stretch.
    Stretch,
    /// Greater principal Cauchy stress.
    PrincipalStress,
    /// Pressure.
    Pressure,
    /// Speed.
    Speed,
    /// Displacement from the start.
    Displacement,
    /// Share in the estimated error of the stress.
    StressError,
}

impl Colouring {
    const fn field(self) -> Field {
        match self {
            Self::Plain => Field::None,
            Self::Energy => Field::EnergyDensity,
            Self::VonMises => Field::VonMises,
            Self::J => Field::Volume,
            Self::Stretch => Field::Stretch,
            Self::PrincipalStress => Field::PrincipalStress,
            Self::Pressure => Field::Pressure,
            Self::Speed => Field::Speed,
            Self::Displacement => Field::Displacement,
            Self::StressError => Field::StressError,
        }
    }
}

/// Draws a level while it runs. Shows progress. A signal stops it early; what was drawn is written then.
///
/// # Errors
/// [`HeadlessError`] if the level, the format or the file is not usable.
pub fn render(request: &Render) -> Result<Ending, HeadlessError> {
    let refuse = |why: String| {
        HeadlessError::File(files::FileError::Access { file: format!("--out {}", request.out.display()), why })
    };
    let ending = request.out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let format = ending.as_deref().and_then(FilmFormat::of_extension);
    if format.is_none() && ending.as_deref() != Some("png") {
        return Err(refuse("the name must end in .mp4, .gif or .png".to_owned()));
    }
    if let Some(format) = format {
        format.check(request.size, request.rate).map_err(refuse)?;
        let (frames, most) = (request.seconds * f64::from(request.rate), FilmFormat::MOST_FRAMES);
        if frames > most as f64 {
            return Err(refuse(format!("{frames:.0} frames are too many for a film; at most {most}")));
        }
    }
    let mut level = read(&request.level)?;
    request.overrides.apply(&mut level, &request.level)?;
    let mut outputs = Outputs::new(&[("--out", Some(&request.out))], &inputs(&request.level, &level))?;
    let mut take = Take::new(request, level)?;
    Interrupt::watch();
    let (bytes, taken, wanted) = take.taken(request, format).map_err(refuse)?;
    let stopped = Interrupt::seen().filter(|_| taken < wanted);
    let ([width, height], kilobytes) = (request.size, bytes.len() / 1000);
    let partial = stopped
        .map_or(String::new(), |signal| format!("Partial: stopped by {signal} after {taken} of {wanted} frames\n"));
    let frames = if format.is_some() { taken } else { 1 };
    let noun = if frames == 1 { "frame" } else { "frames" };
    let time = take.snapshot.time;
    let text = format!(
        "{partial}{frames} {noun} of {width} x {height} pixels, {kilobytes} kB, to {time:.3} s of simulated time"
    );
    outputs.write("--out", |_| Ok(bytes));
    let fault = take.snapshot.fault.as_ref().map(ToString::to_string);
    let mut ending = Ending::new(text, outputs, u8::from(fault.is_some()), stopped);
    ending.remarks.splice(0..0, fault);
    Ok(ending)
}

/// A running level and its stage.
struct Take {
    sandbox: Sandbox,
    stage: Stage,
    snapshot: Snapshot,
    field: Field,
    /// Steps that the level had taken when it was saved.
    before: u64,
}

impl Take {
    fn new(request: &Render, level: Level) -> Result<Self, HeadlessError> {
        let fail = |why| HeadlessError::Level { file: request.level.display().to_string(), why };
        let mode = level.mode;
        let mut sandbox = Sandbox::new(level, Box::new(files::Disk)).map_err(fail)?;
        sandbox.apply(Command::SetMode(mode.into())).map_err(fail)?;
        let dimension = sandbox.simulation().scene().dimension;
        if request.camera.is_some_and(|camera| camera.dimension() != dimension) {
            let wanted = if dimension == 2 { "three numbers X,Y,SCALE" } else { "six numbers X,Y,Z,RADIUS,YAW,PITCH" };
            let why = format!("this scene takes {wanted}");
            return Err(HeadlessError::File(files::FileError::Access { file: "--camera".to_owned(), why }));
        }
        let view = request.level.to_str().map(link::view).unwrap_or_default();
        let field = request.colour.field();
        let held = request.range.map(|end| (field, end));
        let options = Options { field, held, wireframe: request.wireframe || view.wireframe, ..Options::default() };
        let before = sandbox.simulation().state().steps;
        let mut stage = Stage::new((request.size, 1), request.theme == Theme::Dark, options);
        if let Some(camera) = request.camera.or(view.camera) {
            stage.look_from(camera);
        }
        Ok(Self { before, sandbox, stage, snapshot: Snapshot::default(), field })
    }

    /// A picture of the present state, some time after the one before \[s\], or the first one.
    fn picture(&mut self, passed: Option<f64>) -> Picture {
        self.sandbox.snapshot(self.field, &mut self.snapshot);
        self.stage.follow_loads(&self.sandbox);
        match passed {
            Some(passed) => self.stage.picture(&self.snapshot, passed),
            None => self.stage.first_picture(&self.snapshot),
        }
    }

    /// Runs to the end, or until a signal comes, and encodes the frames; returns the bytes and the numbers of frames drawn and wanted.
    fn taken(&mut self, request: &Render, format: Option<FilmFormat>) -> Result<(Vec<u8>, u64, u64), String> {
        let interval = 1.0 / f64::from(request.rate);
        let frames = (request.seconds / interval).round() as u64;
        // A film that is played over and over ends where it begins anew.
        let wanted = if format.is_some() { frames.max(1) } else { frames + 1 };
        let progress = Progress::new(&request.progress_options, wanted, "frames");
        let mut encoder = format.map(|format| format.encoder(request.size, request.rate)).transpose()?;
        let mut taken = 0;
        while taken < wanted {
            self.run_to(taken as f64 * interval);
            if let Some(encoder) = &mut encoder {
                encoder.add(self.picture((taken > 0).then_some(interval)))?;
            }
            taken += 1;
            progress.set(taken);
            if Interrupt::seen().is_some() || self.sandbox.simulation().fault().is_some() {
                break;
            }
        }
        let bytes = match encoder {
            Some(encoder) => encoder.finish()?,
            None => self.picture(None).png()?,
        };
        Ok((bytes, taken, wanted))
    }

    /// Takes the steps that end nearest to a time of the run \[s\].
    fn run_to(&mut self, time: f64) {
        let step = self.sandbox.step_length();
        let due = self.before + (time / step).round() as u64;
        let taken = self.sandbox.simulation().state().steps;
        if due > taken {
            self.sandbox.advance(due - taken, &mut || Interrupt::seen().is_none());
        }
    }
}

fn camera(text: &str) -> Result<link::Camera, String> {
    text.parse().map_err(|()| {
        "expected X,Y,SCALE of a scene in the plane, or X,Y,Z,RADIUS,YAW,PITCH in space; scale and radius above zero"
            .to_owned()
    })
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above zero".to_owned())
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|pixels| (16..=4096).contains(pixels));
    let sides = text.split_once('x').and_then(|(width, height)| Some([number(width)?, number(height)?]));
    sides.ok_or_else(|| "expected a width and a height in [16, 4096] pixels, such as 640x480".to_owned())
}
