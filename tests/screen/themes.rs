//! Every view at every usual size in every look, and every size there is.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    hash::{DefaultHasher, Hash as _, Hasher as _},
};

use eigenselect::{
    ui::{Look, Shades},
    workbench::{Action, State, View, shape::Style, update},
};
use ratatui::{
    buffer::Buffer,
    style::{Color, Modifier},
};

use super::{LARGE, MEDIUM, NARROW, SMALL, buffer, compare, replies, sample, text};

/// The looks a terminal can have, by what makes them.
fn looks() -> [(&'static str, Look); 6] {
    let dark = Look::default();
    [
        ("dark", dark),
        ("dark, all colours", Look { shades: Shades::All, ..dark }),
        ("light", Look { light: true, ..dark }),
        ("light, 256 colours", Look { light: true, shades: Shades::Many, ..dark }),
        ("NO_COLOR", Look { colour: false, ..dark }),
        ("ASCII", Look { ascii: true, ..dark }),
    ]
}

fn state_of(view: View, size: (u16, u16), look: Look) -> State {
    let mut state = sample::state(sample::full());
    if look.ascii {
        state.style = Style::Plain;
    }
    update(&mut state, Action::Resize(size.0, size.1));
    update(&mut state, Action::Show(view));
    replies::served(state)
}

/// How many cells have which colours and attributes, and a number that changes with any cell.
fn digest(buffer: &Buffer) -> String {
    let mut styles: BTreeMap<String, usize> = BTreeMap::new();
    // Its default keys are fixed; should another release of Rust hash otherwise, every line of the snapshot changes.
    let mut hasher = DefaultHasher::new();
    for cell in &buffer.content {
        (cell.symbol(), cell.fg, cell.bg, cell.modifier).hash(&mut hasher);
        let fine = |colour: Color| matches!(colour, Color::Rgb(..) | Color::Indexed(_));
        let mut style = match cell.fg {
            Color::Reset => String::new(),
            colour if fine(colour) => "shade ".to_owned(),
            colour => format!("{colour} ").to_lowercase(),
        };
        if cell.bg != Color::Reset {
            style += if fine(cell.bg) { "on shade " } else { "on colour " };
        }
        for (modifier, name) in [
            (Modifier::BOLD, "bold "),
            (Modifier::DIM, "faint "),
            (Modifier::UNDERLINED, "underlined "),
            (Modifier::REVERSED, "reversed "),
        ] {
            if cell.modifier.contains(modifier) {
                style += name;
            }
        }
        if !style.is_empty() {
            *styles.entry(style.trim().to_owned()).or_default() += 1;
        }
    }
    let counts: Vec<String> = styles.iter().map(|(style, count)| format!("{style} {count}")).collect();
    format!("{:08x}  {}", hasher.finish() as u32, counts.join(", "))
}

/// The text of each view in the first look is in snapshots of its own; here stands what the looks make of it.
/// A question mark of the ASCII frame is one of the other frame, or stands for a character of a name.
#[test]
fn what_the_views_draw_has_a_likeness_in_ascii() {
    for (view, size) in View::ALL.into_iter().flat_map(|view| [SMALL, MEDIUM, LARGE].map(|size| (view, size))) {
        let state = state_of(view, size, Look { ascii: true, ..Look::default() });
        let marks = |look: Look| text(&buffer(&state, look, size)).matches('?').count();
        let (ascii, other) = (marks(Look { ascii: true, ..Look::default() }), marks(Look::default()));
        assert_eq!(ascii, other, "{view:?} {size:?}");
    }
}

#[test]
fn every_view_in_every_look() {
    let mut said = String::new();
    for view in View::ALL {
        for size in [NARROW, SMALL, MEDIUM, LARGE] {
            for (name, look) in looks() {
                let drawn = buffer(&state_of(view, size, look), look, size);
                let (columns, rows) = size;
                let _ = writeln!(said, "{} {columns}x{rows} {name}: {}", view.name(), digest(&drawn));
                assert!(!look.ascii || text(&drawn).is_ascii(), "{view:?} {size:?}");
                let coloured = drawn.content.iter().any(|cell| cell.fg != Color::Reset || cell.bg != Color::Reset);
                assert!(look.colour || !coloured, "{view:?} {size:?}");
            }
        }
    }
    compare("looks", &said);
}

/// What colour says, a mark, a word or an attribute says too: without colour every view is the same text, but for the
/// values on a shape, which show as density.
#[test]
fn without_colour_no_view_says_less() {
    for view in View::ALL {
        for size in [NARROW, SMALL, MEDIUM, LARGE] {
            let [(_, dark), .., (_, plain), _] = looks();
            let with = text(&buffer(&state_of(view, size, dark), dark, size));
            let without = text(&buffer(&state_of(view, size, plain), plain, size));
            assert_eq!(with, without, "{view:?} {size:?}");
        }
    }
}

/// The pictures in the README are of real data; at least their tabs and keys are those of the program.
#[test]
fn the_readmes_pictures_have_the_keys_of_today() {
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let pictures: Vec<&str> = readme
        .split("```text\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap())
        .filter(|picture| picture.starts_with(" eigenselect "))
        .collect();
    assert!(pictures.len() >= 2, "the README shows the screen");
    // Marks on the tabs say something of the data.
    let ends = |picture: &str| {
        let lines: Vec<&str> = picture.lines().collect();
        [lines[1].replace(['!', '×'], " "), lines[lines.len() - 1].to_owned()]
    };
    let size = (100, 30);
    let drawn: Vec<_> = View::ALL
        .into_iter()
        .map(|view| ends(&text(&buffer(&state_of(view, size, Look::default()), Look::default(), size))))
        .collect();
    for picture in pictures {
        assert!(drawn.contains(&ends(picture)), "take this one anew, at 100×30:\n{picture}");
    }
}

/// Draws the views at a size; whatever it is, nothing panics, and the last line is used as soon as there is a screen.
fn draw_all(states: &mut [State], (columns, rows): (u16, u16)) {
    for state in states {
        state.size = (columns, rows);
        let drawn = buffer(state, Look::default(), (columns, rows));
        let cells = &drawn.content[(rows as usize - 1) * columns as usize..];
        let used = cells.iter().any(|cell| cell.symbol() != " ");
        assert!(used || columns < 24 || rows < 6, "{:?} at {columns}×{rows}", state.view);
    }
}

fn states() -> Vec<State> {
    let answers = [sample::full, sample::partial, sample::hostile];
    let served = |(place, view): (usize, View)| {
        let mut state = sample::state(answers[place % 3]());
        update(&mut state, Action::Resize(120, 40));
        update(&mut state, Action::Show(view));
        replies::served(state)
    };
    View::ALL.into_iter().enumerate().map(served).collect()
}

#[test]
fn every_width_and_every_height() {
    let mut states = states();
    for columns in 1..=200 {
        for rows in [1, 6, 13, 18, 24] {
            draw_all(&mut states, (columns, rows));
        }
    }
    for rows in 1..=60 {
        for columns in [1, 24, 60, 80, 200] {
            draw_all(&mut states, (columns, rows));
        }
    }
}

#[test]
#[ignore = "takes a minute: every size from 1×1 to 200×60"]
fn every_size() {
    let mut states = states();
    for columns in 1..=200 {
        for rows in 1..=60 {
            draw_all(&mut states, (columns, rows));
        }
    }
}
