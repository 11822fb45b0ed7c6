//! The paper's experiment on the screen: all spectra, precision and recall, variants, the document; the journal.

use std::{sync::Arc, time::Duration};

use eigenselect::{
    laplacian::Operator,
    query::Parameter,
    report::paper::variation::{Spectra, Subject, Variation},
    workbench::{
        Action, Command, Effect, State, Update, View,
        experiment::{Face, Standing, Told, Varied},
        export,
        journal::{Line, Weight},
        update,
    },
};

use super::{LARGE, MEDIUM, SMALL, compare, drawn, replies, sample, shown, tried};

/// The view of curves with a face.
pub fn faced(face: Face, size: (u16, u16)) -> State {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(size.0, size.1));
    let mut state = shown(state, View::Curves);
    while state.experiment.face != face {
        update(&mut state, Action::TurnFace);
    }
    match face {
        Face::Own => {}
        Face::Recall => state = replies::served(state),
        Face::Spectra => {
            for place in [0, 1, 4, 6] {
                state.experiment.at = place;
                update(&mut state, Action::Switch);
            }
            // One is left to be computed.
            for settings in state.tried.clone().into_iter().take(2) {
                let mut trial = tried(&state, &settings);
                let first_k = Arc::make_mut(trial.figures.first_k.as_mut().unwrap());
                let less = if settings.remesh.is_some() { 0.1 } else { 0.05 };
                first_k.error.train.iter_mut().for_each(|value| *value -= less);
                update(&mut state, Action::News(Update::Trial(Arc::new(trial))));
            }
            let last = state.tried.last().unwrap().clone();
            update(&mut state, Action::News(Update::Trying(last, 120, 380)));
        }
        Face::Variation => {
            let effects = update(&mut state, Action::Switch);
            let Effect::Send(Command::Vary(subject)) = &effects[0] else { panic!("{effects:?}") };
            let of = |(name, turn): (&str, f64)| {
                let values: Vec<f64> =
                    (0..100).map(|k| f64::from(k) * (1.0 + turn * (f64::from(k) * 0.3).sin())).collect();
                let mut spectra = Spectra::of(name, 5000);
                spectra.put(Operator::Fem, &values);
                spectra.put(Operator::Cot, &values.iter().map(|value| value * 0.01).collect::<Vec<_>>());
                spectra
            };
            let variants = [("original", 0.0), ("rotated", 0.0), ("bent by 60°", 0.03), ("refined", 0.004)].map(of);
            let members = (0_u8..).zip(&subject.models).map(|(at, (name, _))| of((name, f64::from(at) / 90.0)));
            let variation = Variation {
                model: subject.models[0].0.clone(),
                class: subject.class.clone(),
                variants: variants.to_vec(),
                members: members.collect(),
            };
            let varied = Varied { subject: subject.clone(), variation: Ok(variation) };
            update(&mut state, Action::News(Update::Varied(Arc::new(varied))));
        }
    }
    state
}

#[test]
fn the_papers_figures_are_faces_of_the_curves() {
    for face in [Face::Spectra, Face::Recall, Face::Variation] {
        for (columns, rows) in [SMALL, MEDIUM, LARGE] {
            let screen = drawn(&faced(face, (columns, rows)), (columns, rows));
            compare(&format!("Curves-{face:?}-{columns}x{rows}"), &screen);
        }
    }
    let mut before = faced(Face::Own, SMALL);
    update(&mut before, Action::TurnFace);
    assert!(drawn(&before, SMALL).contains("no spectrum is switched on"));
    update(&mut before, Action::TurnFace);
    update(&mut before, Action::TurnFace);
    let (models, screen) = (before.subject().models.len(), drawn(&before, MEDIUM));
    assert!(screen.contains(&format!("{} spectra", 18 + 2 * models)), "what it costs is said before: {screen}");
}

#[test]
fn figure_1_tells_how_far_it_is_and_is_made_again_when_the_files_were_looked_at() {
    let mut state = faced(Face::Own, MEDIUM);
    while state.experiment.face != Face::Variation {
        update(&mut state, Action::TurnFace);
    }
    assert!(update(&mut state, Action::News(Update::Rescanned)).is_empty(), "there is nothing to be made again");
    let effects = update(&mut state, Action::Switch);
    let [Effect::Send(Command::Vary(subject))] = &effects[..] else { panic!("{effects:?}") };
    let total = 18 + 2 * subject.models.len();
    update(&mut state, Action::News(Update::Varying(Arc::new(subject.clone()), 7)));
    assert!(drawn(&state, MEDIUM).contains(&format!("7 of {total} spectra")), "{}", drawn(&state, MEDIUM));
    let other = Subject { vertices: 1, ..subject.clone() };
    update(&mut state, Action::News(Update::Varying(Arc::new(other.clone()), 8)));
    let late = Varied { subject: other, variation: Err("of another".to_owned()) };
    update(&mut state, Action::News(Update::Varied(Arc::new(late))));
    assert!(drawn(&state, MEDIUM).contains(&format!("7 of {total} spectra")), "news of another figure say nothing");
    assert_eq!(update(&mut state, Action::Switch), [Effect::Send(Command::StopVarying)]);

    let mut state = faced(Face::Variation, MEDIUM);
    let shown = drawn(&state, MEDIUM);
    let effects = update(&mut state, Action::News(Update::Rescanned));
    assert!(matches!(&effects[0], Effect::Send(Command::Vary(again)) if *again == state.subject()), "{effects:?}");
    assert_eq!(drawn(&state, MEDIUM), shown, "it stays until the new one is there");
    update(&mut state, Action::Set(Parameter::Class, "2".to_owned()));
    assert!(drawn(&state, MEDIUM).contains("spectra are there"), "it is not another class's");
}

#[test]
fn only_spectra_that_are_switched_on_are_computed() {
    let mut state = faced(Face::Own, MEDIUM);
    update(&mut state, Action::TurnFace);
    assert!(state.tried.is_empty());
    assert!(matches!(state.standing(1), Standing::There(_)), "those of the screen are there");
    assert_eq!(state.standing(0), Standing::Off(0.0), "another normalisation takes a moment");
    let Standing::Off(seconds) = state.standing(4) else { panic!("{:?}", state.standing(4)) };
    assert!(seconds > 60.0, "380 re-meshed models take {seconds} s");
    update(&mut state, Action::StepSpectrum(4));
    let effects = update(&mut state, Action::Switch);
    let [Effect::Send(Command::Try(settings))] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!((settings.len(), settings[0].remesh), (1, Some(10_000)));
    // What the curves do not depend on computes none again.
    update(&mut state, Action::Set(Parameter::Rounds, "40".to_owned()));
    assert_eq!(state.tried, *settings);
    let effects = update(&mut state, Action::SwitchOff);
    assert_eq!(effects, [Effect::Send(Command::Try(Vec::new()))], "what is switched off is called off");
}

#[test]
fn the_faces_leave_with_their_tables_and_figures() {
    let folder = std::env::var_os("EIGENSELECT_FIGURES");
    for face in [Face::Spectra, Face::Recall, Face::Variation] {
        let state = faced(face, MEDIUM);
        let table = export::table(&state).unwrap();
        assert!(table.rows.len() > 10, "{face:?}");
        let drawing = export::drawing(&state).unwrap();
        let svg = String::from_utf8(drawing.svg().unwrap()).unwrap();
        assert!(svg.contains("<path") && !svg.contains("NaN"), "{face:?}");
        if let Some(folder) = &folder {
            let path = std::path::Path::new(folder).join(format!("curves-{face:?}.png"));
            std::fs::write(path, drawing.png().unwrap()).unwrap();
        }
    }
}

#[test]
fn the_document_is_written_by_a_key_and_called_off_by_it() {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::WritePaper);
    assert_eq!(state.entry.as_ref().unwrap().text(), "paper");
    let effects = update(&mut state, Action::Commit);
    assert_eq!(effects, [Effect::Send(Command::Paper("paper".into()))]);
    update(&mut state, Action::Close);
    update(&mut state, Action::Show(View::Tables));
    update(&mut state, Action::News(Update::Paper(Told::Progress(1200, 3420))));
    let foot = |state: &State| drawn(state, SMALL).lines().nth(22).unwrap().to_owned();
    assert!(foot(&state).contains("the paper's document to paper: 1200/3420"), "{}", foot(&state));
    assert!(foot(&state).contains("X calls it off"));
    let effects = update(&mut state, Action::WritePaper);
    assert_eq!(effects, [Effect::Send(Command::StopPaper)]);
    assert!(foot(&state).contains("being called off"));
    update(&mut state, Action::News(Update::Paper(Told::Done(Err("interrupted".to_owned())))));
    assert!(foot(&state).contains("paper: interrupted") && state.experiment.document.is_none());
}

#[test]
fn long_lines_of_the_journal_are_wrapped_and_its_oldest_line_can_be_reached() {
    let mut state = sample::state(sample::full());
    for at in 0..30 {
        let text = format!("begin{at} {} end{at}", "and so on ".repeat(at as usize % 7));
        let line = Line { at: Duration::from_secs(at), weight: Weight::Note, text };
        update(&mut state, Action::News(Update::Note(line)));
    }
    update(&mut state, Action::Journal);
    let screen = drawn(&state, (60, 18));
    assert!(screen.contains("begin29") && screen.contains("end29") && screen.contains("more"), "{screen}");
    update(&mut state, Action::Last);
    let screen = drawn(&state, (60, 18));
    assert!(screen.contains("end0") && screen.contains("end1") && !screen.contains("more"), "{screen}");
}

#[test]
fn the_journal_is_shown_the_newest_first() {
    let mut state = sample::state(sample::full());
    for (second, weight, text) in [
        (0, Weight::Note, "data/shrec07: Princeton .cla, 380 models of 20 classes"),
        (1, Weight::Warning, "shrec07/notes.txt: passed over, not a mesh format that is read"),
        (12, Weight::Note, "study of 379 models in 0.412 s"),
        (14, Weight::Error, "curves.png: cannot be written"),
    ] {
        let line = Line { at: Duration::from_millis(1000 * second + 25), weight, text: text.to_owned() };
        update(&mut state, Action::News(Update::Note(line)));
    }
    update(&mut state, Action::Journal);
    compare("journal-80x24", &drawn(&state, SMALL));
    update(&mut state, Action::Close);
    assert!(!drawn(&state, SMALL).contains("Journal"));
}
