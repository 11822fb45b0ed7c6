//! A little of everything.
//!
//! ```text
//!  ε            ◆ 0.242 at k 8  │ mean ADR    ◆ 0.612 at k 10
//!  (Figure 3, small)            │ (Figure 6, small)
//!
//!                    ε D   ε Q ADR D ADR Q  selected
//!  first k = 10     0.274 0.311 0.553 0.541  10
//!  …
//!  ● content hash  ● mesh  ◐ spectrum 214/380  ● features …
//! ```
//!
//! Where there is room, the pipeline and the map of Figure 5 stand below in full.

use ratatui::layout::Rect;

use super::{
    curves::{self, Figure},
    heading::{Note, note},
    look::Role,
    number,
    pane::{self, Pane},
    pipeline, selection, text,
};
use crate::{
    query::{Part, Stage, StageRow},
    selection::SelCount,
    study::{Climbed, Score},
    workbench::{State, View, lists},
};

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let large = rest.width >= 110 && rest.height >= 34;
    // The pipeline's two lines give way before the curves do.
    let beside = |others: u16| rest.height.checked_sub(METHODS + others).filter(|high| *high >= LEAST);
    let high = if large { Some(rest.height * 2 / 5) } else { beside(3).or_else(|| beside(0)) };
    if let Some(high) = high {
        let mut upper = pane::cut_top(&mut rest, high);
        let half = upper.width / 2;
        let one = pane::cut_left(&mut upper, half);
        curves::chart(state, Figure::Error, &mut pane.part(one), true);
        curves::chart(state, Figure::Adr, &mut pane.part(upper), true);
    }
    let gap = u16::from(high.is_some() && rest.height > METHODS);
    pane::cut_top(&mut rest, gap);
    if large {
        let half = rest.width / 2;
        let mut left = pane::cut_left(&mut rest, half);
        methods(state, &mut pane.part(pane::cut_top(&mut left, METHODS + 1)));
        chosen(state, &mut pane.part(pane::cut_top(&mut left, 6)));
        pipeline::draw(state, &mut pane.part(left));
        selection::map(state, &mut pane.part(rest));
    } else {
        methods(state, &mut pane.part(pane::cut_top(&mut rest, METHODS)));
        stages(state, &mut pane.part(rest));
    }
}

/// Below so many lines there are no curves.
const LEAST: u16 = 5;
/// Lines of the methods' table.
const METHODS: u16 = 6;
/// Columns of a figure.
const FIGURE: usize = 6;

/// A line of the methods' table.
struct Method {
    name: String,
    error: Option<Score>,
    adr: Option<Score>,
    count: String,
    stale: bool,
}

impl Method {
    /// Some figure of it is there.
    const fn there(&self) -> bool {
        self.error.is_some() || self.adr.is_some()
    }
}

fn methods(state: &State, pane: &mut Pane<'_>) {
    let wide = pane.width() as usize;
    let name = if wide >= 60 { 18 } else { 15 };
    let from = 2;
    if let Note::Partial(some, all) = note(state, false) {
        let over = [format!("{some} of {all} models"), format!("{some} of {all}")];
        let fitting = over.into_iter().find(|over| text::width(over) <= name + 1).unwrap_or_default();
        pane.put(from as u16, 0, &fitting, Role::Warn);
    }
    for (column, head) in (0..).zip(["ε D", "ε Q", "ADR D", "ADR Q"]) {
        pane.put_right((from + name + FIGURE * (column + 1)) as u16, 0, head, Role::Faint);
    }
    let count_at = (from + name + 4 * FIGURE + 2) as u16;
    pane.put(count_at, 0, &text::fit("selected", wide.saturating_sub(count_at as usize)), Role::Faint);
    let mut rows = rows(state);
    state.lists[View::Overview as usize].sort(&mut rows, |by, a, b| {
        let (error, train) = (by < 3, by % 2 == 1);
        let score = |method: &Method| {
            let score = if error { method.error } else { method.adr };
            // The best first: the least ε, the greatest ADR.
            let score = if train { score.map(|score| score.train) } else { score.and_then(|score| score.query) };
            score.map(|score| if error { score } else { -score })
        };
        lists::ascending(score(a), score(b))
    });
    for (y, method) in (1..).zip(rows) {
        pane.put(from as u16, y, &text::left(&method.name, name), Role::Plain);
        let (error, adr) = (number::score(method.error), number::score(method.adr));
        let figures = [(error.0, Role::Train), (error.1, Role::Query), (adr.0, Role::Train), (adr.1, Role::Query)];
        for (column, (figure, role)) in (0..).zip(figures) {
            let role = if figure == number::NONE { Role::Faint } else { role };
            pane.put_right((from + name + FIGURE * (column + 1)) as u16, y, &figure, role);
        }
        pane.put(count_at, y, &text::fit(&method.count, wide.saturating_sub(count_at as usize + 1)), Role::Plain);
        if method.stale && method.there() {
            let line = Rect { y: pane.area().y + y, height: 1, ..pane.area() };
            pane.part(line).fade();
            pane.put(0, y, "◌", Role::Warn);
        }
    }
}

fn rows(state: &State) -> Vec<Method> {
    let answer = &state.answer;
    let first_k = answer.first_k.value.as_deref();
    let k = state.settings.k;
    let k_stale = state.stale(&answer.first_k, Stage::FirstK);
    let best = first_k.map(|f| (f.best_error, f.best_adr));
    let climb = |name: &str, part: &Part<Climbed>, stage| {
        let climbed = part.value.as_deref();
        Method {
            name: name.to_owned(),
            error: climbed.map(|c| c.error),
            adr: climbed.map(|c| c.adr),
            count: climbed.map_or_else(|| number::NONE.to_owned(), |c| c.climb.selected.len().to_string()),
            stale: state.stale(part, stage),
        }
    };
    let boosted = answer.boosted.value.as_deref();
    let mean = boosted.map(|b| match state.settings.sel {
        SelCount::Chosen => format!("{:.1}", b.mean_chosen),
        SelCount::Ties => format!("{:.1}", b.mean_ties),
    });
    vec![
        Method {
            name: format!("first k = {k}"),
            error: first_k.and_then(|f| f.error.at(k)),
            adr: first_k.and_then(|f| f.adr.at(k)),
            count: k.to_string(),
            stale: k_stale,
        },
        Method {
            name: "first k, best".to_owned(),
            error: first_k.and_then(|f| f.error.at(f.best_error)),
            adr: first_k.and_then(|f| f.adr.at(f.best_adr)),
            count: best.map_or_else(|| number::NONE.to_owned(), |(error, adr)| format!("{error}, {adr}")),
            stale: k_stale,
        },
        climb("HCBw for ε", &answer.climb_error, Stage::ClimbError),
        climb("HCBw for ADR", &answer.climb_adr, Stage::ClimbAdr),
        Method {
            name: format!("AdaBoost T = {}", state.settings.rounds),
            error: boosted.map(|b| b.error),
            adr: None,
            count: mean.unwrap_or_else(|| number::NONE.to_owned()),
            stale: state.stale(&answer.boosted, Stage::Boost),
        },
    ]
}

/// The eigenvalues that each method selected.
fn chosen(state: &State, pane: &mut Pane<'_>) {
    let answer = &state.answer;
    let climbed = |part: &Part<Climbed>| {
        part.value.as_deref().map_or_else(String::new, |c| number::indices(c.climb.selected.iter().copied()))
    };
    let marks = answer.marks.value.as_deref().and_then(|marks| marks.get(state.settings.class));
    let boosted = marks.map_or_else(String::new, |marks| number::indices(marks.iter().map(|mark| mark.index)));
    let class = state.class().unwrap_or("the class");
    let room = (pane.width() as usize).saturating_sub(20);
    pane.put(1, 0, "Selected eigenvalues", Role::Strong);
    for (y, (name, indices, stale)) in (1..).zip([
        ("HCBw for ε", climbed(&answer.climb_error), state.stale(&answer.climb_error, Stage::ClimbError)),
        ("HCBw for ADR", climbed(&answer.climb_adr), state.stale(&answer.climb_adr, Stage::ClimbAdr)),
        (class, boosted, state.stale(&answer.marks, Stage::Boost)),
    ]) {
        pane.put(1, y, &text::left(name, 17), Role::Plain);
        let indices = if indices.is_empty() { number::NONE.to_owned() } else { indices };
        pane.put(19, y, &text::fit(&indices, room), if stale { Role::Faint } else { Role::Plain });
    }
}

/// The pipeline in two lines.
fn stages(state: &State, pane: &mut Pane<'_>) {
    let (width, height) = (pane.width(), pane.height());
    if height == 0 {
        return;
    }
    let mut y = u16::from(height >= 3);
    let mut x = 1;
    for row in &state.answer.stages {
        let (mark, role) = pipeline::mark(state, row);
        let label = stage(state, row);
        let wide = text::width(&label) as u16 + 4;
        if x + wide > width + 2 && x > 1 {
            y += 1;
            x = 1;
        }
        x = pane.spans(x, y, [(mark, role), (" ", Role::Plain), (label.as_str(), Role::Plain), ("  ", Role::Plain)]);
    }
}

fn stage(state: &State, row: &StageRow) -> String {
    let progress = &state.answer.progress;
    match row.stage {
        Stage::Spectrum if !progress.complete() => {
            format!("spectrum {}/{}", progress.ready + progress.out, progress.total)
        }
        stage => stage.name().to_owned(),
    }
}
