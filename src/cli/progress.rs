//! Progress on standard error: a bar on a terminal, counter lines when piped, nothing with `-q`.

use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

use super::General;

pub(crate) struct Progress {
    total: usize,
    done: AtomicUsize,
    shown: Shown,
}

enum Shown {
    Bar(ProgressBar),
    Lines,
    Nothing,
}

impl Progress {
    pub(crate) fn new(total: usize, general: &General) -> Self {
        let shown = if general.quiet {
            Shown::Nothing
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total as u64);
            let template = "{wide_bar} {pos}/{len} specimens, {eta} left";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            Shown::Bar(bar)
        } else {
            Shown::Lines
        };
        Self { total, done: AtomicUsize::new(0), shown }
    }

    /// One more is done.
    pub(crate) fn finished(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        match &self.shown {
            Shown::Bar(bar) => bar.set_position(done as u64),
            Shown::Lines if done == self.total || done.is_multiple_of(self.total.div_ceil(10)) => {
                eprintln!("{done}/{} specimens", self.total);
            }
            Shown::Lines | Shown::Nothing => {}
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Shown::Bar(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}
