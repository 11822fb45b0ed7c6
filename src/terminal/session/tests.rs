//! The loop on a surface that only remembers: what it draws, when, and how it ends.

use std::{
    cell::RefCell,
    sync::{Arc, mpsc},
};

use signal_hook::consts::SIGTERM;

use super::{super::events, *};
use crate::{
    query::{Answer, Progress, Settings},
    workbench::{Command, View, keymap::Key, shape::Style},
};

/// Remembers what was drawn and asked of it.
#[derive(Default)]
struct Paper {
    drawn: Vec<State>,
    forgotten: usize,
    suspended: usize,
    copied: Vec<String>,
    mouse: Vec<bool>,
    resumed: usize,
    torn: bool,
}

impl Surface for Paper {
    fn size(&self) -> io::Result<(u16, u16)> {
        Ok((90, 30))
    }

    fn measure(&mut self) -> io::Result<Option<Raster>> {
        Ok(None)
    }

    fn hear(&mut self, answer: events::Answer) -> io::Result<Option<Raster>> {
        let events::Answer::Cell(cell) = answer else { return Ok(None) };
        Ok(Some(Raster { cell, ..Raster::default() }))
    }

    fn draw(&mut self, state: &State) -> io::Result<()> {
        self.drawn.push(state.clone());
        if self.torn { Err(io::ErrorKind::BrokenPipe.into()) } else { Ok(()) }
    }

    fn forget(&mut self) -> io::Result<()> {
        self.forgotten += 1;
        Ok(())
    }

    fn copy(&mut self, text: &str) -> io::Result<()> {
        self.copied.push(text.to_owned());
        Ok(())
    }

    fn mouse(&mut self, on: bool) -> io::Result<()> {
        self.mouse.push(on);
        Ok(())
    }

    fn clicked(&self, _: &State, (column, _): (u16, u16)) -> Vec<Action> {
        if column == 0 { vec![Action::Show(View::Tables)] } else { Vec::new() }
    }

    fn suspend(&mut self) -> io::Result<()> {
        self.suspended += 1;
        Ok(())
    }

    fn resume(&mut self) -> io::Result<()> {
        self.resumed += 1;
        Ok(())
    }
}

/// Remembers what it was told.
#[derive(Default)]
struct Ear(RefCell<Vec<Command>>);

impl Engine for Ear {
    fn send(&self, command: Command) {
        self.0.borrow_mut().push(command);
    }
}

fn answer(serial: u64, settings: &Settings, ready: usize) -> Event {
    let progress = Progress { ready, total: 100, ..Progress::default() };
    Event::Update(Update::Answer(Arc::new(Answer {
        serial,
        settings: settings.clone(),
        progress,
        ..Answer::default()
    })))
}

/// Plays the events, one after the other without a pause, and quits.
fn played(events: impl IntoIterator<Item = Event>) -> (Ending, Paper, Vec<Command>) {
    let (sender, inbox) = mpsc::channel();
    events.into_iter().chain([Event::Key(Key::Char('q'))]).for_each(|event| sender.send(event).unwrap());
    let mut paper = Paper::default();
    let ear = Ear::default();
    let ending = run(State::new("data", Settings::default()), &ear, &mut paper, &inbox).unwrap();
    (ending, paper, ear.0.into_inner())
}

#[test]
fn quitting_ends_with_zero() {
    let (ending, paper, sent) = played([]);
    assert_eq!((ending.exit, ending.lines), (Exit::Quit, Vec::new()));
    assert_eq!(paper.drawn.len(), 1, "one frame is there before the first key");
    assert_eq!(paper.drawn[0].size, (90, 30));
    assert_eq!(sent, []);
}

#[test]
fn ways_to_end() {
    assert_eq!(played([Event::Key(Key::Ctrl('c'))]).0.exit, Exit::Interrupted);
    assert_eq!(played([Event::Signal(SIGTERM)]).0.exit, Exit::Signal(SIGTERM));
    assert_eq!(played([Event::Signal(SIGINT)]).0.exit, Exit::Interrupted);
    assert_eq!(played([Event::Closed]).0.exit, Exit::Gone);
    let (ending, ..) = played([Event::Update(Update::Fatal("no such folder".to_owned()))]);
    assert_eq!((ending.exit, ending.lines), (Exit::Failed, vec!["no such folder".to_owned()]));
    assert!(ending.session.is_some_and(|session| session.contains("version = 1")));
}

#[test]
fn turns_in_a_row_are_all_sent_and_drawn_together() {
    let (_, paper, sent) = played((0..50).map(|_| Event::Key(Key::Right)));
    assert_eq!(sent.len(), 50);
    assert!(matches!(sent.last(), Some(Command::Set(settings)) if settings.rounds == 70));
    assert_eq!(paper.drawn.len(), 1, "they came before the frame could be drawn, and then the end");
}

#[test]
fn a_frame_follows_each_key_that_comes_alone() {
    let (sender, inbox) = mpsc::channel();
    let keys = thread::spawn(move || {
        for key in [Key::Right, Key::Char('2'), Key::Char('q')] {
            thread::sleep(Duration::from_millis(20));
            sender.send(Event::Key(key)).unwrap();
        }
    });
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    keys.join().unwrap();
    assert_eq!(paper.drawn.iter().map(|state| state.settings.rounds).collect::<Vec<_>>(), [20, 21, 21]);
}

#[test]
fn keys_without_a_meaning_draw_nothing() {
    let (sender, inbox) = mpsc::channel();
    sender.send(Event::Key(Key::F(9))).unwrap();
    drop(sender);
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    assert_eq!(paper.drawn.len(), 1);
}

#[test]
fn progress_is_drawn_at_its_pace_and_the_last_of_it_too() {
    let settings = Settings::default();
    let (sender, inbox) = mpsc::channel();
    let engine = thread::spawn(move || {
        for serial in 1..=40 {
            sender.send(answer(serial, &settings, serial as usize)).unwrap();
            thread::sleep(Duration::from_millis(5));
        }
        thread::sleep(2 * PACE);
        sender.send(Event::Key(Key::Char('q'))).unwrap();
    });
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    engine.join().unwrap();
    assert!((3..=8).contains(&paper.drawn.len()), "{} frames in 0.2 s", paper.drawn.len());
    assert_eq!(paper.drawn.last().map(|state| state.answer.serial), Some(40));
}

#[test]
fn an_awaited_answer_is_drawn_at_once() {
    let (sender, inbox) = mpsc::channel();
    let turned = Settings { rounds: 21, ..Settings::default() };
    let (times, seen) = mpsc::channel();
    let engine = thread::spawn(move || {
        sender.send(answer(1, &Settings::default(), 1)).unwrap();
        thread::sleep(Duration::from_millis(10));
        sender.send(Event::Key(Key::Right)).unwrap();
        thread::sleep(Duration::from_millis(10));
        times.send(Instant::now()).unwrap();
        sender.send(answer(2, &turned, 2)).unwrap();
        thread::sleep(Duration::from_millis(40));
        sender.send(Event::Key(Key::Char('q'))).unwrap();
    });
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    engine.join().unwrap();
    assert!(seen.recv().unwrap().elapsed() < PACE, "else this shows nothing");
    assert_eq!(paper.drawn.last().map(|state| state.answer.serial), Some(2));
}

#[test]
fn suspending_gives_the_terminal_back_and_draws_anew() {
    let (_, paper, _) = played([Event::Key(Key::Ctrl('z'))]);
    assert_eq!((paper.suspended, paper.resumed, paper.forgotten), (1, 1, 1));
    let (_, paper, _) = played([Event::Continued]);
    assert_eq!((paper.suspended, paper.resumed, paper.forgotten), (0, 1, 1));
    let (_, paper, _) = played([Event::Key(Key::Ctrl('l'))]);
    assert_eq!((paper.resumed, paper.forgotten), (0, 1));
}

#[test]
fn a_panic_elsewhere_is_told_and_ends_nothing() {
    let (sender, inbox) = mpsc::channel();
    sender.send(Event::Panic("pool: index out of bounds".to_owned())).unwrap();
    drop(sender);
    let mut paper = Paper::default();
    let ending = run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    assert_eq!(ending.exit, Exit::Gone);
    let (_, paper, _) = played([Event::Panic("pool: index out of bounds".to_owned()), Event::Resized]);
    assert_eq!(paper.drawn.len(), 1);
}

#[test]
fn a_write_that_fails_with_the_terminal_is_no_error() {
    let (sender, inbox) = mpsc::channel();
    let mut paper = Paper { torn: true, ..Paper::default() };
    let state = State::new("data", Settings::default());
    sender.send(Event::Signal(1)).unwrap();
    let ending = run(state.clone(), &Ear::default(), &mut paper, &inbox).unwrap();
    assert_eq!(ending.exit, Exit::Signal(1));
    let error = run(state, &Ear::default(), &mut paper, &inbox).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::BrokenPipe);
}

#[test]
fn nothing_is_drawn_while_nothing_happens() {
    let (sender, inbox) = mpsc::channel();
    let idle = thread::spawn(move || {
        thread::sleep(Duration::from_millis(300));
        sender.send(Event::Key(Key::Char('q'))).unwrap();
    });
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    idle.join().unwrap();
    assert_eq!(paper.drawn.len(), 1);
}

#[test]
fn clicks_count_once_the_mouse_is_ours() {
    let click = || Event::Click((0, 1));
    let (_, paper, _) = played([click()]);
    assert!(paper.mouse.is_empty() && paper.drawn.iter().all(|state| state.view == View::Overview));
    // Pressed keys and quitting come in one batch, so the last frame may be the one before them.
    let (ending, paper, _) = played([Event::Key(Key::Char('M')), click(), Event::Click((9, 9))]);
    assert_eq!(paper.mouse, [true]);
    assert!(ending.session.is_some_and(|session| session.contains("Tables")));
    let (ending, paper, _) = played([Event::Key(Key::Char('M')), Event::Key(Key::Char('M')), click()]);
    assert_eq!(paper.mouse, [true, false]);
    assert!(ending.session.is_some_and(|session| !session.contains("Tables")));
}

#[test]
fn a_terminal_that_says_that_it_takes_pictures_is_drawn_anew_with_them() {
    let (_, paper, _) = played([Event::Answer(events::Answer::Attributes { sixels: false })]);
    assert!(paper.drawn.iter().all(|state| state.style == Style::Dots));
    let (sender, inbox) = mpsc::channel();
    let told = thread::spawn(move || {
        for cell in [(9, 18), (9, 18), (10, 20)] {
            thread::sleep(Duration::from_millis(100));
            sender.send(Event::Answer(events::Answer::Cell(cell))).unwrap();
        }
        thread::sleep(Duration::from_millis(100));
    });
    let mut paper = Paper::default();
    run(State::new("data", Settings::default()), &Ear::default(), &mut paper, &inbox).unwrap();
    told.join().unwrap();
    let cells: Vec<_> = paper.drawn.iter().map(|state| (state.style, state.raster.cell)).collect();
    // What is known already draws nothing.
    assert_eq!(cells, [(Style::Dots, (8, 16)), (Style::Pixels, (9, 18)), (Style::Pixels, (10, 20))]);
}
