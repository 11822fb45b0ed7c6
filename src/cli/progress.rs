//! What a computation without a screen tells and hears: a bar on standard error, Ctrl-C.

use std::{
    fmt,
    io::{self, IsTerminal as _},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::interrupt::Interrupt;
use crate::watch::Watch;

/// Watches a computation. The bar is drawn only where standard error is a terminal.
pub(super) struct Progress {
    bar: ProgressBar,
    afterwards: &'static str,
    interrupt: Interrupt,
}

impl Progress {
    /// A bar that counts `unit`, `models` say; `afterwards` takes the unit's place when all are done.
    pub(super) fn new(unit: &'static str, afterwards: &'static str, interrupt: Interrupt) -> Self {
        let target =
            if io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target).with_message(unit);
        let template = "{bar:32} {pos}/{len} {msg}  {rate} a second, {elapsed} gone, {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("rate", |state: &ProgressState, out: &mut dyn fmt::Write| {
                // A bar that cannot be drawn is no trouble.
                let _ = write!(out, "{:.1}", state.per_sec());
            }));
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, afterwards, interrupt }
    }
}

impl Watch for Progress {
    fn cancelled(&self) -> bool {
        self.interrupt.raised()
    }

    fn progress(&self, done: usize, total: usize) {
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
        if done == total && total > 0 {
            self.bar.set_message(self.afterwards);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
