//! What happens, and what can be done.
//!
//! ```text
//!  solving 214/380 ████████▌······· 56 %  12.3/s  13 s left                          2 out
//!  ←→ turn  ↑↓ choose  Enter type  u undo  1–6 view                        ? help  q quit
//! ```
//!
//! The first line gives way to a notice, to a value being typed, and to the reason when the engine has ended. A screen
//! with one line of footer shows the first one only.

use ratatui::style::Modifier;

use super::{look::Role, number, pane::Pane, text};
use crate::workbench::{Entry, Notice, Purpose, State, View, experiment::Document, keymap, lists, parameters};

/// One or two lines, as high as the pane.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    match (&state.entry, &state.fatal, &state.notice) {
        (Some(entry), ..) => typing(state, entry, pane),
        (None, Some(reason), _) => line(state, pane, ("×", reason, Role::Bad)),
        (None, None, Some(Notice { text, bad: true, .. })) => line(state, pane, ("×", text, Role::Bad)),
        (None, None, Some(Notice { text, bad: false, .. })) => line(state, pane, ("·", text, Role::Plain)),
        (None, None, None) => match &state.experiment.document {
            Some(document) => writing(document, pane),
            None => progress(state, pane),
        },
    }
    hints(state, pane);
}

fn line(state: &State, pane: &mut Pane<'_>, (mark, text, role): (&str, &str, Role)) {
    let mut room = (pane.width() as usize).saturating_sub(4);
    // Who waits for spectra sees that they come.
    let progress = &state.answer.progress;
    let solving = format!("{}/{}", progress.ready + progress.out, progress.total);
    if progress.total > 0 && !progress.complete() && state.fatal.is_none() && room > 4 * solving.len() {
        pane.put_right(pane.width().saturating_sub(1), 0, &solving, Role::Faint);
        room -= solving.len() + 2;
    }
    pane.spans(1, 0, [(mark, role), (" ", role), (&text::fit(text, room), role)]);
}

/// The paper's document, as it is made.
fn writing(document: &Document, pane: &mut Pane<'_>) {
    let head = match (document.called_off, document.total) {
        (true, _) => "the document is being called off ".to_owned(),
        (false, 0) => format!("the paper's document to {} ", text::clean(&document.folder)),
        (false, total) => {
            format!("the paper's document to {}: {}/{total} ", text::clean(&document.folder), document.done)
        }
    };
    let tail = if document.called_off { "" } else { "  X calls it off" };
    let room = (pane.width() as usize).saturating_sub(text::width(tail) + 2);
    let x = pane.put(1, 0, &text::fit(&head, room), Role::Plain);
    let bar = (pane.width() as usize).saturating_sub(x as usize + text::width(tail) + 1).min(40);
    let mut x = x;
    if bar >= 6 && document.total > 0 {
        let (full, rest) = self::bar(document.done as f64 / document.total as f64, bar);
        x = pane.spans(x, 0, [(full.as_str(), Role::Train), (rest.as_str(), Role::Faint)]);
    }
    pane.put(x, 0, tail, Role::Faint);
}

fn progress(state: &State, pane: &mut Pane<'_>) {
    let progress = &state.answer.progress;
    let mut out = match progress.out {
        0 => String::new(),
        out => format!("{out} out"),
    };
    // A list that does not show everything as it is says so.
    let order = text::fit(&text::clean(&state.order().said(&lists::columns(state))), pane.width() as usize / 2);
    if !order.is_empty() {
        out = if out.is_empty() { order } else { format!("{order}  {out}") };
    }
    pane.put_right(pane.width().saturating_sub(1), 0, &out, Role::Warn);
    if progress.total == 0 {
        pane.put(1, 0, "reading the data set", Role::Faint);
        return;
    }
    if progress.complete() {
        let settled = state.settings == state.answer.settings && !state.answer.tables.stale;
        let done = number::count(progress.ready, "spectrum").replace("spectrums", "spectra");
        let now = match (settled, state.answer.members.is_empty()) {
            (_, true) => "no model takes part",
            (true, false) => "up to date",
            (false, false) => "computing",
        };
        let x = pane.spans(1, 0, [("✓", Role::Good), (" ", Role::Plain), (&done, Role::Plain), ("  ", Role::Plain)]);
        let room = (pane.width() as usize).saturating_sub(x as usize + text::width(&out) + 2);
        pane.put(x, 0, &text::fit(now, room), Role::Faint);
        return;
    }
    let done = progress.ready + progress.out;
    let word = if state.stopped { "stopped" } else { "solving" };
    let head = format!("{word} {done}/{} ", progress.total);
    let mut tail = format!(" {} %", 100 * done / progress.total);
    if state.stopped {
        tail += "  Space goes on";
    } else {
        if let Some(rate) = progress.rate.filter(|rate| rate.is_finite()) {
            tail = format!("{tail}  {rate:.1}/s");
        }
        if let Some(left) = progress.left {
            tail = format!("{tail}  {}", number::left(left));
        }
    }
    let taken = text::width(&head) + text::width(&tail) + text::width(&out) + 4;
    let bar = (pane.width() as usize).saturating_sub(taken).min(40);
    let mut x = pane.put(1, 0, &head, if state.stopped { Role::Warn } else { Role::Plain });
    if bar >= 6 {
        let (full, rest) = self::bar(done as f64 / progress.total as f64, bar);
        x = pane.spans(x, 0, [(full.as_str(), Role::Train), (rest.as_str(), Role::Faint)]);
    }
    pane.put(x, 0, &tail, Role::Plain);
}

/// A bar of `columns`, its filled and its empty part, in eighths of a column.
pub(super) fn bar(share: f64, columns: usize) -> (String, String) {
    const EIGHTHS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];
    let eighths = (share.clamp(0.0, 1.0) * 8.0 * columns as f64).floor() as usize;
    let full = "█".repeat(eighths / 8) + EIGHTHS[eighths % 8];
    let rest = "·".repeat(columns - eighths.div_ceil(8));
    (full, rest)
}

fn typing(state: &State, entry: &Entry, pane: &mut Pane<'_>) {
    let (before, after) = entry.parts();
    let (name, sign) = match state.purpose {
        Purpose::Value => (state.parameter.name(), " = "),
        Purpose::Needle if state.view == View::Models => ("models with", " "),
        Purpose::Needle => ("lines with", " "),
        Purpose::File => ("write to", " "),
        Purpose::Folder => ("write the paper's document to the folder", " "),
    };
    let x = pane.spans(1, 0, [(name, Role::Strong), (sign, Role::Strong), (before.as_str(), Role::Plain)]);
    let mut after = after.chars();
    let under = after.next().unwrap_or(' ').to_string();
    let x = pane.put(x, 0, &under, Role::Chosen);
    let x = pane.put(x, 0, after.as_str(), Role::Plain);
    let (says, role) = match &entry.error {
        Some(error) => (format!("× {error}"), Role::Bad),
        None if state.purpose == Purpose::Needle => (String::new(), Role::Faint),
        None if state.purpose == Purpose::Folder => ("eight spectra of every model".to_owned(), Role::Faint),
        None if state.purpose == Purpose::File => {
            ("Tab: .csv .json .txt .svg .png; .toml for a recipe".to_owned(), Role::Faint)
        }
        None => (range(state), Role::Faint),
    };
    let room = (pane.width() as usize).saturating_sub(x as usize + 3);
    pane.put(x + 2, 0, &text::fit(&says, room), role);
}

/// What the chosen parameter takes.
pub(super) fn range(state: &State) -> String {
    let parameter = state.parameter;
    if !parameter.choices().is_empty() {
        return parameter.choices().join(" · ");
    }
    let (least, greatest) = parameters::range(parameter, &state.settings, state.answer.classes.len());
    format!("{least} – {greatest}")
}

/// The keys, the most general ones at the right; what does not fit is left out.
fn hints(state: &State, pane: &mut Pane<'_>) {
    if pane.height() < 2 {
        return;
    }
    let ascii = pane.look().ascii;
    let hints = keymap::hints(state).into_iter().map(|(keys, word)| (text::keys(&keys, ascii), word));
    let (general, near): (Vec<_>, Vec<_>) = hints.partition(|(_, word)| matches!(*word, "help" | "quit"));
    let columns = |hint: &(String, &str)| text::width(&hint.0) + 1 + text::width(hint.1) + 2;
    let mut room = (pane.width() as usize).saturating_sub(1);
    let reserved: usize = general.iter().map(columns).sum();
    let key = pane.style(Role::Strong).add_modifier(Modifier::BOLD);
    let put = |x: u16, (keys, word): &(String, &str), pane: &mut Pane<'_>| {
        let x = pane.styled(x, 1, keys, key);
        pane.spans(x, 1, [(" ", Role::Plain), (word, Role::Faint), ("  ", Role::Plain)])
    };
    let mut x = 1;
    for hint in &near {
        if room >= reserved + columns(hint) {
            room -= columns(hint);
            x = put(x, hint, pane);
        }
    }
    let mut x = (pane.width() as usize + 1).saturating_sub(reserved).max(x as usize) as u16;
    for hint in &general {
        x = put(x, hint, pane);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_fills_by_eighths() {
        assert_eq!(bar(0.0, 4), (String::new(), "····".to_owned()));
        assert_eq!(bar(0.5, 4), ("██".to_owned(), "··".to_owned()));
        assert_eq!(bar(0.54, 4), ("██▏".to_owned(), "·".to_owned()));
        assert_eq!(bar(7.0, 4), ("████".to_owned(), String::new()));
    }
}
