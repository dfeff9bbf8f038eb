//! Reflectance against angle of incidence: the thesis's Figure 5.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::ReportError;
use crate::fresnel::{Polarized, conductor};
use crate::ior::{ComplexIndex, IorError, Table};

/// Units of the drawing per pixel: plotters rounds coordinates to whole units, and curves would be ragged.
const SCALE: i32 = 4;
/// Size in pixels.
const SIZE: (i32, i32) = (960, 600);
/// Points per curve, every half degree.
const POINTS: usize = 181;

/// Colour, dash (drawn, left out) in pixels and marker of each curve. The colours keep a contrast of 3:1 on white
/// and stay apart in grey; dash and marker tell the curves apart without any colour.
const STYLES: [(RGBColor, (i32, i32), char); 6] = [
    (RGBColor(0x4a, 0x60, 0x78), (1, 0), 'o'),
    (RGBColor(0xb4, 0x4a, 0x12), (14, 5), '^'),
    (RGBColor(0x1f, 0x1f, 0x1f), (8, 4), 's'),
    (RGBColor(0x7a, 0x3f, 0xa0), (1, 0), 'd'),
    (RGBColor(0x0f, 0x7a, 0x5c), (10, 4), 'x'),
    (RGBColor(0x1c, 0x6f, 0xc4), (3, 4), '+'),
];

/// One curve of the figure.
struct Curve {
    /// Name of the material for people.
    material: String,
    /// Name of the data set.
    table: String,
    index: ComplexIndex,
    /// Reflectance at each angle.
    reflectance: Vec<Polarized<f64>>,
}

/// Reflectance of several materials over the angle of incidence at one wavelength.
pub struct FresnelFigure {
    wavelength_nm: f64,
    curves: Vec<Curve>,
}

fn theta_deg(point: usize) -> f64 {
    90.0 * point as f64 / (POINTS - 1) as f64
}

fn cos_theta(point: usize) -> f64 {
    // cos(π/2) rounds to 6e-17; the figure ends at 90° exactly.
    if point == POINTS - 1 { 0.0 } else { libm::cos(theta_deg(point).to_radians()) }
}

impl FresnelFigure {
    /// The most curves that can be told apart.
    pub const MOST_CURVES: usize = STYLES.len();

    /// The figure of the given tables at a wavelength, incidence from vacuum.
    ///
    /// # Errors
    /// If a table does not cover the wavelength, or there are more than [`Self::MOST_CURVES`].
    pub fn new(tables: &[Table], wavelength_nm: f64) -> Result<Self, ReportError> {
        if tables.len() > Self::MOST_CURVES {
            return Err(ReportError::TooManyCurves { given: tables.len(), most: Self::MOST_CURVES });
        }
        let curves = tables
            .iter()
            .map(|table| {
                let index = table.at(wavelength_nm)?;
                let reflectance =
                    (0..POINTS).map(|i| conductor(cos_theta(i), index.eta, index.k).reflectance).collect();
                let material = table.provenance().map_or(table.name(), |p| p.material.as_str()).to_owned();
                Ok(Curve { material, table: table.name().to_owned(), index, reflectance })
            })
            .collect::<Result<_, IorError>>()?;
        Ok(Self { wavelength_nm, curves })
    }

    /// The numbers of the figure: a row per angle; R for unpolarised light, R_s and R_p per data set.
    pub fn csv(&self) -> Result<String, ReportError> {
        let failed =
            |error: &dyn std::fmt::Display| ReportError::Drawing("the Fresnel table", error.to_string());
        let mut csv = csv::Writer::from_writer(Vec::new());
        let names = self.curves.iter().flat_map(|curve| {
            let name = &curve.table;
            [format!("{name} R"), format!("{name} R_s"), format!("{name} R_p")]
        });
        csv.write_record(["theta_deg".to_owned()].into_iter().chain(names))
            .map_err(|error| failed(&error))?;
        for point in 0..POINTS {
            let values = self.curves.iter().flat_map(|curve| {
                let r @ Polarized { s, p } = curve.reflectance[point];
                [r.unpolarized(), s, p].map(|value| format!("{value:.9}"))
            });
            csv.write_record([theta_deg(point).to_string()].into_iter().chain(values))
                .map_err(|error| failed(&error))?;
        }
        let bytes = csv.into_inner().map_err(|error| failed(&error))?;
        String::from_utf8(bytes).map_err(|error| failed(&error))
    }

    /// The caption: how the figure was computed.
    pub fn caption(&self) -> String {
        let sets = self.curves.iter().map(|curve| {
            let ComplexIndex { eta, k } = curve.index;
            let extinction = match k {
                0.0 => String::new(),
                k if k < 1e-3 => format!(" + {k:.1e}i"),
                k => format!(" + {k:.3}i"),
            };
            format!("{} {eta:.3}{extinction}", curve.table)
        });
        format!(
            "Exact Fresnel reflectance of unpolarised light from vacuum at {} nm, η + ik interpolated linearly in \
             the measured tables: {}.",
            self.wavelength_nm,
            sets.collect::<Vec<_>>().join(", ")
        )
    }

    /// The figure as SVG, text as text.
    pub fn svg(&self) -> Result<String, ReportError> {
        let mut svg = String::new();
        self.draw(&mut svg).map_err(|error| ReportError::Drawing("the Fresnel figure", error.to_string()))?;
        let (width, height) = SIZE;
        // The drawing scales with the page; a title and a description make it readable without eyes.
        let size = format!("width=\"{}\" height=\"{}\"", width * SCALE, height * SCALE);
        let svg = svg.replacen(&size, "role=\"img\" width=\"100%\" font-family=\"sans-serif\"", 1);
        let description = self.caption().replace('&', "&amp;").replace('<', "&lt;");
        Ok(svg.replacen(
            '>',
            &format!(">\n<title>Reflectance against angle of incidence</title>\n<desc>{description}</desc>"),
            1,
        ))
    }

    fn draw(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let px = |pixels: i32| pixels * SCALE;
        let size = ((SIZE.0 * SCALE) as u32, (SIZE.1 * SCALE) as u32);
        let root = SVGBackend::with_string(svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let ink = RGBColor(0x22, 0x22, 0x22);
        let text = |pixels: i32| ("sans-serif", f64::from(px(pixels))).into_font().color(&ink);
        let (plot, legend) = root.split_horizontally(px(680));
        let mut chart = ChartBuilder::on(&plot)
            .margin_top(px(24))
            .margin_right(px(20))
            .margin_left(px(8))
            .margin_bottom(px(8))
            .x_label_area_size(px(52))
            .y_label_area_size(px(62))
            .build_cartesian_2d(0.0..90.0, 0.0..1.0)?;
        chart
            .configure_mesh()
            .x_labels(10)
            .y_labels(11)
            .x_label_formatter(&|x| format!("{x:.0}°"))
            .y_label_formatter(&|y| format!("{y:.1}"))
            .x_desc("angle of incidence θ")
            .y_desc("reflectance R")
            .label_style(text(15))
            .axis_desc_style(text(16))
            .axis_style(ShapeStyle { color: ink.to_rgba(), filled: false, stroke_width: px(1) as u32 })
            .bold_line_style(ShapeStyle {
                color: RGBColor(0xdd, 0xdd, 0xdd).to_rgba(),
                filled: false,
                stroke_width: px(1) as u32,
            })
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(px(5))
            .draw()?;
        for (i, (curve, style)) in self.curves.iter().zip(STYLES).enumerate() {
            let (color, dash, marker) = style;
            let points = |step: usize, offset: usize| {
                (offset..POINTS)
                    .step_by(step)
                    .map(|point| (theta_deg(point), curve.reflectance[point].unpolarized()))
                    .collect::<Vec<_>>()
            };
            let line = ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: (px(5) / 2) as u32 };
            if dash.1 == 0 {
                chart.draw_series(LineSeries::new(points(1, 0), line))?;
            } else {
                chart.draw_series(DashedLineSeries::new(points(1, 0), px(dash.0), px(dash.1), line))?;
            }
            // Markers every 15°, each curve a little later so that they do not meet where curves do.
            for (x, y) in points(30, 6 + 4 * i) {
                let at = chart.backend_coord(&(x, y));
                draw_marker(&root, at, marker, line)?;
            }
        }
        let mut labels: Vec<(usize, i32)> = self
            .curves
            .iter()
            .enumerate()
            .map(|(i, curve)| (i, chart.backend_coord(&(90.0, curve.reflectance[0].unpolarized())).1))
            .collect();
        labels.sort_by_key(|&(_, y)| y);
        self.draw_legend(&legend, &labels, &text)?;
        root.present()?;
        Ok(())
    }

    /// The legend in the order of the curves at 0°, each entry as near as possible to the height of its curve.
    fn draw_legend(
        &self,
        legend: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
        labels: &[(usize, i32)],
        text: &dyn Fn(i32) -> TextStyle<'static>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let px = |pixels: i32| pixels * SCALE;
        let spacing = px(62);
        let bottom = px(SIZE.1 - 70);
        let mut heights: Vec<i32> = labels.iter().map(|&(_, y)| y).collect();
        // From the bottom up, so that the crowd of dielectrics is pushed into the free space above it.
        for i in (0..heights.len()).rev() {
            let below = if i + 1 < heights.len() { heights[i + 1] - spacing } else { bottom };
            heights[i] = heights[i].min(below);
        }
        for (&(i, _), y) in labels.iter().zip(heights) {
            let (curve, (color, dash, marker)) = (&self.curves[i], STYLES[i]);
            let line = ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: (px(5) / 2) as u32 };
            let (start, end) = (px(4), px(52));
            let mut x = start;
            while x < end {
                let stop = if dash.1 == 0 { end } else { (x + px(dash.0)).min(end) };
                legend.draw(&PathElement::new(vec![(x, y), (stop, y)], line))?;
                x = stop + px(dash.1.max(1));
            }
            draw_marker(legend, ((start + end) / 2, y), marker, line)?;
            let anchored = |pixels| text(pixels).pos(Pos::new(HPos::Left, VPos::Center));
            let at_normal = curve.reflectance[0].unpolarized();
            legend.draw(&Text::new(curve.material.clone(), (px(62), y - px(9)), anchored(17)))?;
            let second = format!("{} · R(0°) {at_normal:.3}", curve.table);
            legend.draw(&Text::new(second, (px(62), y + px(11)), anchored(13)))?;
        }
        Ok(())
    }
}

/// Draws a marker of about nine pixels.
fn draw_marker(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    (x, y): (i32, i32),
    marker: char,
    style: ShapeStyle,
) -> Result<(), Box<dyn std::error::Error>> {
    let r = 5 * SCALE;
    let polygon = |corners: &[(i32, i32)]| {
        Polygon::new(
            corners.iter().map(|&(dx, dy)| (x + dx, y + dy)).collect::<Vec<_>>(),
            style.color.filled(),
        )
    };
    let stroke = |dx: i32, dy: i32| PathElement::new(vec![(x - dx, y - dy), (x + dx, y + dy)], style);
    match marker {
        'o' => area.draw(&Circle::new((x, y), r, style.color.filled()))?,
        '^' => area.draw(&polygon(&[(0, -r), (r, r), (-r, r)]))?,
        's' => area.draw(&polygon(&[(-r, -r), (r, -r), (r, r), (-r, r)]))?,
        'd' => area.draw(&polygon(&[(0, -r - 4), (r + 4, 0), (0, r + 4), (-r - 4, 0)]))?,
        '+' => {
            area.draw(&stroke(r, 0))?;
            area.draw(&stroke(0, r))?;
        }
        _ => {
            area.draw(&stroke(r, r))?;
            area.draw(&stroke(r, -r))?;
        }
    }
    Ok(())
}
