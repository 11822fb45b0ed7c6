//! The screen as literal text, at the sizes it is used at, and without a panic at all others.

#![allow(clippy::unwrap_used)]

#[path = "screen/clicks.rs"]
mod clicks;
#[path = "screen/experiment.rs"]
mod experiment;
#[path = "screen/figures.rs"]
mod figures;
#[path = "screen/lists.rs"]
mod lists;
#[path = "screen/replies.rs"]
mod replies;
#[path = "screen/sample.rs"]
mod sample;
#[path = "screen/themes.rs"]
mod themes;

use std::{
    collections::HashSet,
    sync::Arc,
    time::{Duration, Instant},
};

use eigenselect::{
    query::{Answer, Parameter, Settings},
    ui::{self, Look, Shades},
    workbench::{
        Action, Command, Content, Effect, Figure, Filter, Leave, State, Trial, Update, View,
        experiment::Face,
        keymap, pins, recipe,
        shape::{self, Style},
        update,
    },
};
use ratatui::{
    Terminal,
    backend::TestBackend,
    buffer::Buffer,
    style::{Color, Modifier},
};
use unicode_width::UnicodeWidthStr;

const NARROW: (u16, u16) = (60, 18);
const SMALL: (u16, u16) = (80, 24);
const MEDIUM: (u16, u16) = (120, 40);
const LARGE: (u16, u16) = (200, 60);

fn buffer(state: &State, look: Look, (columns, rows): (u16, u16)) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(columns, rows)).unwrap();
    terminal.draw(|frame| ui::render(state, look, frame)).unwrap();
    terminal.backend().buffer().clone()
}

/// The characters of a buffer, line by line, without the cells that wide characters cover.
fn text(buffer: &Buffer) -> String {
    let mut text = String::new();
    for row in 0..buffer.area.height {
        let mut line = String::new();
        let mut covered = 0;
        for column in 0..buffer.area.width {
            if covered > 0 {
                covered -= 1;
                continue;
            }
            let symbol = buffer[(column, row)].symbol();
            line.push_str(symbol);
            covered = symbol.width().saturating_sub(1);
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn drawn(state: &State, size: (u16, u16)) -> String {
    text(&buffer(state, Look::default(), size))
}

fn shown(mut state: State, view: View) -> State {
    update(&mut state, Action::Show(view));
    replies::served(state)
}

fn compare(name: &str, screen: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("screen/snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, screen));
}

#[test]
fn every_view_at_the_usual_sizes() {
    for view in View::ALL {
        for (columns, rows) in [NARROW, SMALL, MEDIUM, LARGE] {
            let mut state = sample::state(sample::full());
            update(&mut state, Action::Resize(columns, rows));
            let screen = drawn(&shown(state, view), (columns, rows));
            compare(&format!("{}-{columns}x{rows}", view.name()), &screen);
        }
    }
}

#[test]
fn the_other_faces_of_the_explaining_views() {
    let mut state = shown(sample::state(sample::full()), View::Neighbours);
    update(&mut state, Action::Down);
    update(&mut state, Action::ToggleOverlay);
    compare("Neighbours-overlaid", &drawn(&state, SMALL));
    update(&mut state, Action::TurnMethod(-1));
    compare("Neighbours-votes", &drawn(&replies::served(state), SMALL));
    let mut state = shown(sample::state(sample::full()), View::Selection);
    state.figure = Figure::Shared;
    compare("Shared-80x24", &drawn(&replies::served(state), SMALL));
}

#[test]
fn a_shape_is_drawn_in_every_style() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(SMALL.0, SMALL.1));
    let state = shown(state, View::Shape);
    let styled = |style: Style| replies::served(State { style, ..state.clone() });
    for (name, style, look) in [
        ("blocks", Style::Blocks, Look { shades: Shades::All, ..Look::default() }),
        ("ascii", Style::Plain, Look { ascii: true, ..Look::default() }),
        ("light", Style::Dots, Look { light: true, ..Look::default() }),
    ] {
        compare(&format!("Shape-{name}"), &text(&buffer(&styled(style), look, SMALL)));
    }
    // More colours than sixteen are used for shapes alone, and where they are offered.
    let colours = |shades: Shades| {
        let look = Look { shades, ..Look::default() };
        let drawn = buffer(&state, look, SMALL);
        let fine = |cell: &&ratatui::buffer::Cell| matches!(cell.fg, Color::Rgb(..) | Color::Indexed(16..));
        drawn.content.iter().filter(fine).count()
    };
    assert_eq!(colours(Shades::Few), 0);
    assert!(colours(Shades::Many) > 50 && colours(Shades::All) > 50);
}

#[test]
fn an_eigenfunction_colours_the_shape() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(SMALL.0, SMALL.1));
    let mut state = shown(state, View::Shape);
    let plain = drawn(&state, SMALL);
    update(&mut state, Action::TurnFunction(1));
    assert_eq!(state.function, Some(2), "the first eigenvalue selected");
    update(&mut state, Action::TurnFunction(1));
    let state = replies::served(state);
    let drawn = buffer(&state, Look::default(), SMALL);
    let count = |colour: Color| drawn.content.iter().filter(|cell| cell.fg == colour).count();
    assert!(count(Color::Cyan) > 30 && count(Color::Magenta) > 30, "above and below 0");
    assert!(text(&drawn).contains("eigenfunction 3 of λ"));
    let without = Look { colour: false, ..Look::default() };
    compare("Shape-function", &text(&buffer(&state, without, SMALL)));
    assert_ne!(text(&buffer(&state, without, SMALL)), plain, "without colour the value shows as density");
    // The next one is on its way: nothing is painted until it is there.
    let mut state = state;
    let effects = update(&mut state, Action::TurnFunction(1));
    assert!(effects.iter().all(|effect| !matches!(effect, Effect::Send(Command::Paint(_)))), "{effects:?}");
    let function = |state: &State| state.scenes[0].function.as_ref().map(|function| function.index);
    assert_eq!(function(&state), Some(3));
    let state = replies::served(state);
    assert_eq!(function(&state), Some(4));
}

/// Figures for pins: those of the sample with another T.
fn tried(state: &State, settings: &Settings) -> Trial {
    let mut figures = pins::present(state);
    if let Some(boosted) = &mut figures.boosted {
        Arc::make_mut(boosted).error.train = 1.0 / settings.rounds as f64;
    }
    Trial { settings: settings.clone(), figures }
}

#[test]
fn settings_are_compared_with_pins() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(SMALL.0, SMALL.1));
    update(&mut state, Action::Pin);
    update(&mut state, Action::Set(Parameter::Distance, "l1".to_owned()));
    update(&mut state, Action::Set(Parameter::Rounds, "40".to_owned()));
    update(&mut state, Action::Pin);
    update(&mut state, Action::Undo);
    update(&mut state, Action::Undo);
    update(&mut state, Action::TurnMethod(-1));
    let mut state = replies::served(shown(state, View::Compare));
    assert_eq!(state.tried, [state.pins[1].settings.clone()], "the other pin is what is on the screen");
    let trial = tried(&state, &state.pins[1].settings.clone());
    update(&mut state, Action::News(Update::Trial(Arc::new(trial))));
    assert!(state.tried.is_empty());
    compare("Compare-pins", &drawn(&state, SMALL));
    let tables = State { view: View::Tables, size: MEDIUM, ..state.clone() };
    compare("Tables-pins", &drawn(&tables, MEDIUM));
    let table = eigenselect::workbench::export::table(&tables).unwrap();
    assert_eq!(table.columns[0], "pin");
    assert!(table.rows.iter().any(|row| row[0] == "B"));
    update(&mut state, Action::Down);
    update(&mut state, Action::Recall);
    assert_eq!(state.settings.rounds, 40);
    update(&mut state, Action::Unpin);
    assert_eq!(state.pins.len(), 1);
}

#[test]
fn a_sweep_fills_its_curve() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(SMALL.0, SMALL.1));
    update(&mut state, Action::TurnMethod(-1));
    update(&mut state, Action::Sweep);
    let swept = state.sweep.as_ref().unwrap().settings.clone();
    assert_eq!(state.tried, swept);
    for settings in swept.iter().take(9) {
        let trial = tried(&state, settings);
        update(&mut state, Action::News(Update::Trial(Arc::new(trial))));
    }
    compare("Compare-sweep", &drawn(&state, SMALL));
    update(&mut state, Action::Choose(Parameter::Distance));
    update(&mut state, Action::Sweep);
    let trial = tried(&state, &state.sweep.as_ref().unwrap().settings[1].clone());
    update(&mut state, Action::News(Update::Trial(Arc::new(trial))));
    compare("Compare-words", &drawn(&state, SMALL));
}

#[test]
fn the_palette_finds_commands_and_places() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Palette);
    compare("palette-80x24", &drawn(&state, SMALL));
    "armad".chars().for_each(|c| drop(update(&mut state, Action::Insert(c))));
    compare("palette-typed", &drawn(&state, SMALL));
    update(&mut state, Action::Pick);
    assert_eq!((state.settings.class, state.view, state.palette), (14, View::Selection, None));
}

#[test]
fn every_view_can_be_written_and_copied() {
    for view in View::ALL {
        let mut state = shown(sample::state(sample::full()), view);
        update(&mut state, Action::Pin);
        update(&mut state, Action::WriteView);
        let name = format!("{}.csv", view.name().to_lowercase());
        assert_eq!(state.entry.as_ref().unwrap().text(), name);
        let effects = update(&mut state, Action::Commit);
        let [Effect::Send(Command::Write { path, content: Content::Text(text), overwrite: false }), ..] = &effects[..]
        else {
            panic!("{view:?}: {effects:?}")
        };
        assert_eq!(path.to_str().unwrap(), name);
        let mut lines = text.lines();
        let columns = lines.next().unwrap().split(',').count();
        assert!(lines.next().unwrap().split(',').count() >= columns, "{view:?}");
        let copied = update(&mut state, Action::Copy);
        assert!(matches!(&copied[..], [Effect::Copy(text)] if text.lines().count() > 1), "{view:?}");
    }
    let empty = update(&mut shown(sample::state(Answer::default()), View::Curves), Action::Copy);
    assert_eq!(empty, [], "there is nothing yet");
}

#[test]
fn a_name_that_no_format_has_is_refused_where_it_is_typed() {
    let mut state = shown(sample::state(sample::full()), View::Curves);
    update(&mut state, Action::WriteView);
    update(&mut state, Action::EraseAll);
    "curves.xls".chars().for_each(|c| drop(update(&mut state, Action::Insert(c))));
    assert_eq!(update(&mut state, Action::Commit), []);
    let footer = drawn(&state, MEDIUM).lines().nth(38).unwrap().to_owned();
    assert_eq!(
        footer,
        " write to curves.xls   × the name must end in .csv, .json, .txt, .svg or .png, or in .toml for a recipe"
    );
    update(&mut state, Action::Close);
    update(&mut state, Action::WriteRecipe);
    let effects = update(&mut state, Action::Commit);
    assert!(
        matches!(&effects[..], [Effect::Send(Command::Write { content: Content::Text(text), .. })] if text.contains("T = 20"))
    );
}

#[test]
fn the_last_session_is_offered_and_taken_up() {
    let mut before = sample::state(sample::full());
    update(&mut before, Action::Set(Parameter::Rounds, "40".to_owned()));
    update(&mut before, Action::Show(View::Curves));
    update(&mut before, Action::Pin);
    let text = recipe::write(&before).unwrap();
    let mut state = sample::state(sample::full());
    state.offer(recipe::read(&text, &Settings::default(), 20).unwrap());
    assert!(drawn(&state, SMALL).contains("L takes up the last session"));
    let effects = update(&mut state, Action::Restore);
    assert!(effects.contains(&Effect::Send(Command::Set(before.settings.clone()))));
    assert_eq!((state.view, state.pins.len(), &state.settings), (View::Curves, 1, &before.settings));
    update(&mut state, Action::Undo);
    assert_eq!(state.settings, Settings::default());
}

#[test]
fn models_are_found_by_typing() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Find);
    "spr".chars().for_each(|c| drop(update(&mut state, Action::Insert(c))));
    assert_eq!(state.models.listed(&state.answer).len(), 19);
    update(&mut state, Action::CycleSort);
    update(&mut state, Action::CycleSort);
    compare("Models-found", &drawn(&state, SMALL));
    update(&mut state, Action::Close);
    assert_eq!(state.models.listed(&state.answer).len(), 380, "Esc lists all again");
}

#[test]
fn turning_a_shape_shows_it_from_there_once_it_is_painted() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(SMALL.0, SMALL.1));
    let before = shown(state, View::Shape);
    let mut turned = before.clone();
    update(&mut turned, Action::Orbit(1, 0));
    assert_eq!(drawn(&turned, SMALL), drawn(&before, SMALL), "the screen does not wait for the picture");
    let turned = replies::served(turned);
    assert_ne!(drawn(&turned, SMALL), drawn(&before, SMALL));
    let mut back = turned;
    update(&mut back, Action::FirstLook);
    assert_eq!(drawn(&replies::served(back), SMALL), drawn(&before, SMALL));
}

#[test]
fn from_a_wrong_cell_to_a_model_and_back() {
    let mut state = shown(sample::state(sample::full()), View::Confusion);
    update(&mut state, Action::NextConfusion);
    update(&mut state, Action::Open);
    compare("Confusion-opened", &drawn(&state, SMALL));
    let mut narrowed = state.clone();
    narrowed.models.filter = Filter::Out;
    let screen = drawn(&narrowed, LARGE);
    assert!(screen.contains(" models that take no part among "), "of which it is said still: {screen}");
    update(&mut state, Action::Open);
    assert_eq!(state.view, View::Neighbours);
    let model = state.model();
    let mut state = replies::served(state);
    update(&mut state, Action::Open);
    assert_ne!(state.model(), model, "a neighbour is another model");
    for view in [View::Neighbours, View::Models, View::Confusion] {
        update(&mut state, Action::Back);
        assert_eq!(state.view, view);
    }
}

#[test]
fn figure_4_on_a_small_screen() {
    let mut state = shown(sample::state(sample::full()), View::Selection);
    state.figure = Figure::Marks;
    state.compared.extend([6, 12]);
    compare("Figure4-80x24", &drawn(&state, SMALL));
    state.figure = Figure::Climb;
    compare("Climb-80x24", &drawn(&state, SMALL));
}

#[test]
fn a_narrow_screen_has_its_parameters_in_a_strip() {
    compare("Models-44x14", &drawn(&shown(sample::state(sample::full()), View::Models), (44, 14)));
    compare("Tables-30x8", &drawn(&shown(sample::state(sample::full()), View::Tables), (30, 8)));
    compare("too-small-20x5", &drawn(&sample::state(sample::full()), (20, 5)));
}

#[test]
fn a_great_weight_keeps_its_distance_from_the_index() {
    let mut state = shown(sample::state(sample::full()), View::Selection);
    let answer = Arc::make_mut(&mut state.answer);
    let mut marks = answer.marks.value.as_deref().cloned().unwrap();
    let mark = &mut marks[state.settings.class][0];
    (mark.index, mark.alpha) = (2, 230.26);
    answer.marks.value = Some(Arc::new(marks));
    assert!(drawn(&state, SMALL).contains(" 2   230 "), "{}", drawn(&state, SMALL));
}

/// A number without its last digits would be another one.
#[test]
fn no_figure_is_cut_on_a_narrow_screen() {
    for view in View::ALL {
        let state = replies::served(shown(sample::state(sample::full()), view));
        let wide = |columns| drawn(&state, (columns, 60)).split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let whole: HashSet<String> = (120..200).flat_map(wide).collect();
        for size in (20..120).flat_map(|columns| [12, 24, 40].map(|rows| (columns, rows))) {
            let screen = drawn(&state, size);
            // Where a line is full, its last word may be less than it was.
            for line in screen.lines().filter(|line| line.trim_end().width() == usize::from(size.0)) {
                let word = line.split_whitespace().last().unwrap_or_default();
                let is_number = word.contains('.') && word.chars().all(|c| c.is_ascii_digit() || ".–".contains(c));
                let is_cut = !whole.contains(word) && whole.iter().any(|longer| longer.starts_with(word));
                assert!(!is_number || !is_cut, "{word} at {size:?} in {view:?}: {line}");
            }
        }
    }
}

#[test]
fn before_the_first_answer() {
    for view in View::ALL {
        compare(&format!("{}-empty", view.name()), &drawn(&shown(sample::state(Answer::default()), view), SMALL));
    }
}

#[test]
fn in_the_middle_of_a_cold_run() {
    for view in [View::Overview, View::Pipeline, View::Models] {
        let mut state = shown(sample::state(sample::partial()), view);
        state.models.at = 209;
        compare(&format!("{}-partial", view.name()), &drawn(&state, SMALL));
    }
    // What is told does not hide how far it is.
    let mut state = sample::state(sample::partial());
    update(&mut state, Action::Report("something is to be known".to_owned()));
    let screen = drawn(&state, SMALL);
    let progress = &state.answer.progress;
    let done = format!("{}/{}", progress.ready + progress.out, progress.total);
    assert!(screen.lines().any(|line| line.contains("something is to be known") && line.contains(&done)), "{screen}");
}

#[test]
fn models_that_failed() {
    let mut state = shown(sample::state(sample::full()), View::Models);
    state.models.filter = Filter::Defects;
    state.models.at = 3;
    compare("Models-defects", &drawn(&state, SMALL));
    state.models.at = 1;
    compare("Models-out", &drawn(&state, SMALL));
    compare("Overview-failed", &drawn(&sample::state(sample::failed()), SMALL));
}

#[test]
fn names_cannot_do_anything_to_the_terminal() {
    let bad = |c: char| c.is_control() || matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}');
    for view in View::ALL {
        for size in [NARROW, SMALL, MEDIUM, LARGE] {
            let mut state = sample::state(sample::hostile());
            update(&mut state, Action::Resize(size.0, size.1));
            let state = shown(state, view);
            let mut opened = state.clone();
            update(&mut opened, Action::NextConfusion);
            update(&mut opened, Action::Open);
            let mut finding = state.clone();
            update(&mut finding, Action::Palette);
            "mod".chars().for_each(|c| drop(update(&mut finding, Action::Insert(c))));
            for state in [state, replies::served(opened), finding] {
                for look in [Look::default(), Look { ascii: true, ..Look::default() }] {
                    let buffer = buffer(&state, look, size);
                    for cell in &buffer.content {
                        assert!(!cell.symbol().chars().any(bad), "{:?} in {}", cell.symbol(), view.name());
                    }
                    assert!(!look.ascii || text(&buffer).is_ascii(), "{}", view.name());
                }
            }
        }
    }
    compare("Models-hostile", &drawn(&shown(sample::state(sample::hostile()), View::Models), SMALL));
}

#[test]
fn plain_ascii() {
    let look = Look { ascii: true, ..Look::default() };
    for view in View::ALL {
        let buffer = buffer(&shown(sample::state(sample::full()), view), look, SMALL);
        assert!(text(&buffer).is_ascii(), "{}", view.name());
    }
    compare("Curves-ascii", &text(&buffer(&shown(sample::state(sample::full()), View::Curves), look, SMALL)));
    compare("Selection-ascii", &text(&buffer(&shown(sample::state(sample::full()), View::Selection), look, SMALL)));
}

#[test]
fn the_help_comes_from_the_keymap() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Help);
    compare("help-80x24", &drawn(&state, SMALL));
    let mut all = drawn(&state, LARGE);
    update(&mut state, Action::Last);
    all += &drawn(&state, LARGE);
    for binding in keymap::bindings() {
        assert!(all.contains(&binding.label) && all.contains(&binding.about), "{binding:?}");
    }
    assert!(drawn(&state, SMALL).contains("draw the screen anew"), "its end can be reached");
}

#[test]
fn a_value_is_typed_in_the_footer() {
    let mut state = sample::state(sample::full());
    let footer = |state: &State| drawn(state, SMALL).lines().skip(22).map(str::to_owned).collect::<Vec<_>>();
    for action in [Action::Edit, Action::Insert('2'), Action::Insert('0'), Action::Insert('0'), Action::Insert('1')] {
        update(&mut state, action);
    }
    assert_eq!(footer(&state), [" T = 2001   1 – 1000", " Enter take it  Esc leave it"]);
    update(&mut state, Action::Commit);
    assert_eq!(footer(&state)[0], " T = 2001   × T takes a number from 1 to 1000");
}

#[test]
fn every_number_of_an_explanation_is_faint_while_it_is_stale() {
    for (view, size) in
        [View::Confusion, View::Neighbours].into_iter().flat_map(|v| [SMALL, MEDIUM, LARGE].map(|s| (v, s)))
    {
        let mut state = sample::state(sample::full());
        update(&mut state, Action::Resize(size.0, size.1));
        let mut state = shown(state, view);
        state.alone = true;
        // Below the title, and above the small pictures and the footer.
        let below = if shape::thumbs(size) > 0 { shape::THUMB.1 + 5 } else { 4 };
        let numbers = |state: &State| {
            let buffer = buffer(state, Look::default(), size);
            let cells = (4..size.1 - below).flat_map(|row| (0..size.0).map(move |column| (column, row)));
            let digits = cells.map(|at| buffer[at].clone()).filter(|cell| cell.symbol().chars().all(char::is_numeric));
            let dim: Vec<bool> = digits.map(|cell| cell.modifier.contains(Modifier::DIM)).collect();
            (dim.len(), dim.iter().filter(|dim| !**dim).count())
        };
        let (all, strong) = numbers(&state);
        assert!(all > 20 && strong > 10, "{view:?} {size:?}: {all}, {strong}");
        state.settings.set(Parameter::Distance, "l1", 1).unwrap();
        assert_eq!(numbers(&state).1, 0, "{view:?} {size:?}");
    }
}

#[test]
fn what_is_stale_is_faint_and_says_so() {
    let mut state = sample::state(sample::full());
    let faint = |state: &State, word: &str| {
        let buffer = buffer(state, Look::default(), SMALL);
        let screen = text(&buffer);
        let (row, line) = screen.lines().enumerate().find(|(_, line)| line.contains(word)).unwrap();
        let column = line[..line.find(word).unwrap()].width();
        buffer[(column as u16, row as u16)].modifier.contains(Modifier::DIM)
    };
    assert!(!faint(&state, "HCBw for ε") && !faint(&state, "AdaBoost T"));
    update(&mut state, Action::Choose(Parameter::Distance));
    update(&mut state, Action::Turn(1));
    assert!(faint(&state, "HCBw for ε"), "a climb depends on the distance");
    assert!(!faint(&state, "AdaBoost T"), "AdaBoost does not");
    assert!(drawn(&state, SMALL).contains("◌ HCBw for ε"));
}

#[test]
fn a_table_is_settled_as_soon_as_its_own_parts_are_there() {
    let mut answer = sample::full();
    // First-k has come; the climbs and AdaBoost are on their way.
    for stale in [&mut answer.climb_error.stale, &mut answer.climb_adr.stale, &mut answer.tables.stale] {
        *stale = true;
    }
    answer.boosted = eigenselect::query::Part::default();
    let state = shown(sample::state(answer), View::Tables);
    compare("Tables-arriving", &drawn(&state, MEDIUM));
    let lines = drawn(&state, MEDIUM);
    let title = |number: u32| lines.lines().find(|line| line.contains(&format!("Table {number}:"))).unwrap().to_owned();
    assert_eq!([1, 2, 3, 4].map(|number| title(number).contains('◌')), [false, true, true, true]);
    // A press of k is read off the curves at once, without the engine.
    let mut turned = state.clone();
    update(&mut turned, Action::Set(Parameter::K, "7".to_owned()));
    assert!(drawn(&turned, MEDIUM).contains("k=7"), "{}", drawn(&turned, MEDIUM));
}

#[test]
fn without_colour_nothing_is_coloured() {
    let look = Look { colour: false, ..Look::default() };
    for view in View::ALL {
        let buffer = buffer(&shown(sample::state(sample::partial()), view), look, SMALL);
        assert!(buffer.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
        assert!(buffer.content.iter().any(|cell| cell.modifier.contains(Modifier::REVERSED)), "what is chosen shows");
    }
}

/// Every screen that the tests know, in every view, with everything that can be open above it.
fn moods() -> Vec<State> {
    let answers: [fn() -> Answer; 6] =
        [Answer::default, sample::full, sample::partial, sample::failed, sample::hostile, sample::nonsense];
    let mut moods = Vec::new();
    for answer in answers {
        for view in View::ALL {
            let mut state = shown(sample::state(answer()), view);
            state.compared.extend(0..30);
            state.scroll = 1000;
            state.models.at = 1000;
            state.why.neighbour = 1000;
            state.why.cell = (1000, 7);
            moods.push(state.clone());
            state.figure = if view == View::Selection { Figure::Shared } else { Figure::Marks };
            state.why.overlaid = true;
            state.logarithmic = false;
            state.scroll = 3;
            state.settings.class = 19;
            state.settings.k = 5000;
            moods.push(replies::served(state));
        }
    }
    let mut helped = sample::state(sample::full());
    update(&mut helped, Action::Help);
    let mut typing = sample::state(sample::full());
    update(&mut typing, Action::Edit);
    (0..40).for_each(|_| drop(update(&mut typing, Action::Insert('象'))));
    let mut dead = sample::state(sample::hostile());
    update(&mut dead, Action::News(Update::Fatal("\u{1b}[2J the engine ".repeat(30))));
    let mut told = sample::state(sample::full());
    update(&mut told, Action::Journal);
    moods.extend([helped, typing, dead, told]);
    moods.extend(Face::ALL.map(|face| experiment::faced(face, SMALL)));
    moods
}

#[test]
fn no_size_panics() {
    for state in moods() {
        for columns in [1, 2, 3, 7, 12, 23, 24, 25, 31, 40, 53, 66, 72, 79, 80, 99, 120] {
            for rows in [1, 2, 3, 5, 6, 7, 8, 9, 11, 13, 14, 16, 17, 20, 24, 33, 50] {
                buffer(&state, Look::default(), (columns, rows));
            }
        }
        for size in [(300, 100), (300, 1), (1, 100), (120, 17), (200, 12)] {
            buffer(&state, Look { ascii: true, colour: false, ..Look::default() }, size);
        }
    }
}

#[test]
fn ten_thousand_random_keys_leave_a_screen_that_lives() {
    let mut keys: Vec<keymap::Key> =
        keymap::bindings().iter().flat_map(|binding| binding.keys.iter().map(|(key, _)| *key)).collect();
    keys.extend("0123456789 aλ象\u{1b}".chars().map(keymap::Key::Char));
    let mut random = 1_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let answers: [fn() -> Answer; 4] = [sample::full, sample::partial, sample::nonsense, Answer::default];
    for answer in answers {
        let mut state = sample::state(answer());
        for press in 0..2500 {
            let key = keys[next(keys.len())];
            for effect in keymap::action(&state, key).map(|action| update(&mut state, action)).unwrap_or_default() {
                // The engine answers for the parameters asked for.
                if let Effect::Send(Command::Set(settings)) = effect {
                    let serial = state.answer.serial + 1;
                    let answer = Answer { serial, settings, ..(*state.answer).clone() };
                    update(&mut state, Action::News(Update::Answer(Arc::new(answer))));
                }
            }
            if press % 40 == 0 {
                update(&mut state, Action::Resize(20 + next(190) as u16, 5 + next(60) as u16));
                if answer().members.len() < 1000 && state.answer.settings == Settings::default() {
                    state = replies::served(state);
                }
                buffer(&state, Look::default(), state.size);
            }
        }
        // Whatever is open can be closed, and the screen left.
        for _ in 0..3 {
            update(&mut state, Action::Close);
        }
        let quit = keymap::action(&state, keymap::Key::Char('q')).map(|action| update(&mut state, action));
        assert!(quit.is_some_and(|effects| effects.contains(&Effect::Leave(Leave::Quit))));
    }
}

#[test]
fn a_frame_takes_little_time() {
    for view in View::ALL {
        let state = shown(sample::state(sample::full()), view);
        let mut terminal = Terminal::new(TestBackend::new(200, 60)).unwrap();
        let quickest = (0..20)
            .map(|_| {
                let start = Instant::now();
                terminal.draw(|frame| ui::render(&state, Look::default(), frame)).unwrap();
                start.elapsed()
            })
            .min()
            .unwrap();
        // Aimed at 2 ms; the bound leaves room for a busy machine and for debug assertions.
        assert!(quickest < Duration::from_millis(10), "{} took {quickest:?}", view.name());
    }
}
