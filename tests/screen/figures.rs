//! Every view that shows a plot as a figure for print.

use eigenselect::{
    query::Parameter,
    study::Method,
    workbench::{
        Action, Content, Effect, Figure, State, Update, View,
        export::{Drawing, drawing},
        update,
    },
};

use super::{replies, sample, shown, tried};

/// The views and what they can be turned to, by a name for each.
fn faces() -> Vec<(String, State)> {
    let begin = || {
        let mut state = sample::state(sample::full());
        update(&mut state, Action::Resize(120, 40));
        state
    };
    let mut faces: Vec<(String, State)> =
        View::ALL.into_iter().map(|view| (view.name().to_lowercase(), shown(begin(), view))).collect();
    for (name, figure) in [("marks", Figure::Marks), ("climb", Figure::Climb), ("shared", Figure::Shared)] {
        let mut state = begin();
        state.figure = figure;
        state.compared.extend([6, 12]);
        faces.push((format!("selection-{name}"), shown(state, View::Selection)));
    }
    let mut pinned = begin();
    update(&mut pinned, Action::Pin);
    update(&mut pinned, Action::Set(Parameter::Distance, "l1".to_owned()));
    update(&mut pinned, Action::Pin);
    update(&mut pinned, Action::Undo);
    for settings in pinned.tried.clone() {
        let trial = tried(&pinned, &settings);
        update(&mut pinned, Action::News(Update::Trial(std::sync::Arc::new(trial))));
    }
    faces.push(("curves-pinned".to_owned(), shown(pinned.clone(), View::Curves)));
    faces.push(("compare-pins".to_owned(), shown(pinned, View::Compare)));
    for parameter in [Parameter::Rounds, Parameter::Distance] {
        let mut swept = begin();
        update(&mut swept, Action::Choose(parameter));
        update(&mut swept, Action::Sweep);
        swept.why.method = Method::Boost;
        for settings in swept.tried.clone().into_iter().take(9) {
            let trial = tried(&swept, &settings);
            update(&mut swept, Action::News(Update::Trial(std::sync::Arc::new(trial))));
        }
        faces.push((format!("compare-{}", parameter.name()), swept));
    }
    let mut votes = begin();
    votes.why.method = Method::Boost;
    faces.push(("neighbours-votes".to_owned(), shown(votes, View::Neighbours)));
    let mut function = shown(begin(), View::Shape);
    update(&mut function, Action::Eigenfunction(3));
    faces.push(("shape-function".to_owned(), replies::served(function)));
    faces
}

#[test]
fn every_view_with_a_plot_is_a_figure() {
    let folder = std::env::var_os("EIGENSELECT_FIGURES");
    for (name, state) in faces() {
        let drawing = match drawing(&state) {
            Ok(drawing) => drawing,
            Err(reason) => {
                assert!(matches!(state.view, View::Tables | View::Pipeline), "{name}: {reason}");
                continue;
            }
        };
        let svg = String::from_utf8(drawing.svg().unwrap()).unwrap();
        let marks = svg.matches("<path").count() + svg.matches("<image").count() + svg.matches("<rect").count();
        assert!(svg.starts_with("<svg") && marks > 1, "{name}");
        if let Drawing::Figure(figure) = &drawing {
            assert!(!svg.contains("NaN"), "{name}");
            assert!(figure.panels.iter().all(|panel| !panel.layers.is_empty()), "{name}");
            assert!(figure.panels.iter().all(|panel| !panel.y.label.is_empty()), "{name}: an axis without a label");
        }
        if let Some(folder) = &folder {
            let path = std::path::Path::new(folder).join(format!("{name}.png"));
            std::fs::write(path, drawing.png().unwrap()).unwrap();
        }
    }
}

#[test]
fn names_from_files_cannot_break_a_figure() {
    for view in View::ALL {
        let state = shown(sample::state(sample::hostile()), view);
        let Ok(drawing) = drawing(&state) else { continue };
        let svg = String::from_utf8(drawing.svg().unwrap()).unwrap();
        let bad =
            |c: char| (c.is_control() && c != '\n') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{200b}'..='\u{200f}');
        assert!(!svg.chars().any(bad), "{view:?}");
        assert_eq!(svg.matches("<svg").count(), 1);
    }
}

#[test]
fn tab_turns_the_ending_and_the_engine_draws() {
    let mut state = shown(sample::state(sample::full()), View::Curves);
    update(&mut state, Action::WriteView);
    let mut names = Vec::new();
    for _ in 0..5 {
        update(&mut state, Action::NextEnding);
        names.push(state.entry.as_ref().unwrap().text());
    }
    assert_eq!(names, ["curves.json", "curves.txt", "curves.svg", "curves.png", "curves.csv"]);
    update(&mut state, Action::NextEnding);
    update(&mut state, Action::NextEnding);
    update(&mut state, Action::NextEnding);
    let effects = update(&mut state, Action::Commit);
    let written = effects.into_iter().find_map(|effect| match effect {
        Effect::Send(eigenselect::workbench::Command::Write { path, content, .. }) => Some((path, content)),
        _ => None,
    });
    let (path, content) = written.unwrap();
    assert_eq!(path.to_str(), Some("curves.svg"));
    assert!(matches!(content, Content::Svg(_)));
    assert!(content.bytes().unwrap().starts_with(b"<svg"));
    let mut table = shown(sample::state(sample::full()), View::Tables);
    update(&mut table, Action::WriteView);
    for _ in 0..4 {
        update(&mut table, Action::NextEnding);
    }
    assert_eq!(update(&mut table, Action::Commit), []);
    assert!(table.entry.unwrap().error.unwrap().contains("no figure"));
}
