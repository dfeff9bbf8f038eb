//! Findings with the lines of the file that they are about.

use std::cell::Cell;
use std::io::IsTerminal as _;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use gonio::message::{Finding, Severity};
use gonio::record::{Place, Placed};

/// Bytes of a line that are shown at most: files of a single line exist.
const WIDEST: usize = 400;

/// A text with the places where its lines begin.
pub(crate) struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
    /// The place that was asked for last and its column: findings come in order, and a file may be one line.
    last: Cell<(usize, usize)>,
}

impl<'a> Lines<'a> {
    pub(crate) fn of(text: &'a str) -> Self {
        let after_breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1);
        let starts = std::iter::once(0).chain(after_breaks).collect();
        Self { text, starts, last: Cell::new((0, 1)) }
    }

    /// Index of the line that a byte is in.
    fn line(&self, at: usize) -> usize {
        self.starts.partition_point(|&start| start <= at) - 1
    }

    /// Line and column of a byte, from 1; columns are characters.
    fn position(&self, at: usize) -> (usize, usize) {
        let line = self.line(at);
        let (from, column) = match self.last.get() {
            (last, column) if (self.starts[line]..=at).contains(&last) => (last, column),
            _ => (self.starts[line], 1),
        };
        let column = column + self.text.get(from..at).unwrap_or_default().chars().count();
        self.last.set((at, column));
        (line + 1, column)
    }

    /// A finding with its lines and columns.
    pub(crate) fn placed(&self, finding: &Finding) -> Placed {
        let place = finding.span.clone().map(|Range { start, end }| {
            let ((line, column), (end_line, end_column)) = (self.position(start), self.position(end));
            Place { line, column, end_line, end_column }
        });
        Placed { severity: finding.code.severity(), place, finding: finding.clone() }
    }
}

/// A finding as text for a terminal.
pub(crate) fn render(finding: &Finding, path: &str, lines: &Lines<'_>) -> String {
    let level = match finding.code.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = Group::with_title(level.primary_title(&*finding.text).id(finding.code.id()));
    if let Some(span) = &finding.span {
        // The lines of its beginning and no more; a table may go on for long.
        let line = lines.line(span.start);
        let line_start = lines.starts[line];
        let line_end = lines.starts.get(line + 1).map_or(lines.text.len(), |next| next - 1);
        let start = on_boundary(lines.text, line_start.max(span.start.saturating_sub(WIDEST / 2)));
        let end = on_boundary(lines.text, line_end.min(start + WIDEST)).max(start);
        let within = span.start.clamp(start, end) - start..span.end.clamp(start, end) - start;
        let annotation = AnnotationKind::Primary.span(within).label(&*finding.label);
        let source = lines.text.get(start..end).unwrap_or_default();
        group = group.element(Snippet::source(source).line_start(line + 1).path(path).annotation(annotation));
    }
    for help in &finding.help {
        group = group.element(Level::HELP.message(&**help));
    }
    let is_styled = std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let renderer = if is_styled { Renderer::styled() } else { Renderer::plain() };
    renderer.render(&[group])
}

/// The nearest place at or before a byte where a character begins.
fn on_boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}
