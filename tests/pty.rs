//! The real program in a pseudo-terminal: what a user sees and does, and that the terminal is given back on every way
//! out.

#![allow(clippy::unwrap_used)] // Helpers of tests are tests.

#[path = "pty/questions.rs"]
mod questions;
#[path = "pty/seat.rs"]
mod seat;

use std::{
    io::{self, BufRead as _},
    thread,
    time::{Duration, Instant},
};

use eigenselect::{
    query::Settings,
    terminal::{self, Engine, Notify, Opening, Pictures},
    ui::Look,
    workbench::{Command, Update},
};
use portable_pty::CommandBuilder;
use rustix::process::Signal;
use seat::{Seat, at_heavy, at_small, folder, small};
use vt100::MouseProtocolMode;

const RIGHT: &str = "\x1b[C";
const CTRL_C: &str = "\x03";
const CTRL_Z: &str = "\x1a";

#[test]
fn a_parameter_is_turned_and_the_value_changes() {
    let mut seat = at_small("turn");
    seat.until_settled();
    seat.until_shown("AdaBoost T = 20");
    assert!(seat.look(vt100::Screen::alternate_screen) && seat.look(vt100::Screen::hide_cursor));
    seat.press("t");
    seat.press(RIGHT);
    seat.until_shown("AdaBoost T = 21");
    seat.until_settled();
    seat.press("k=5\r");
    seat.until_shown("first k = 5");
    seat.press("uu");
    seat.until_shown("AdaBoost T = 20");
    seat.until_shown("first k = 10");
    for (key, sign) in [
        ("2", "mean ADR against k"),
        ("3", "Table 4: Mean ADR"),
        ("4", "Figure 5: bands selected"),
        ("5", "content hash"),
        ("6", "12 models"),
        ("1", "first k, best"),
    ] {
        seat.press(key);
        seat.until_shown(sign);
    }
    seat.press("?");
    seat.until_shown("turn the parameter");
    seat.press("q");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
    seat.assert_restored();
}

#[test]
fn a_second_start_finds_the_spectra_and_shows_them_at_once() {
    let cache = folder("warm");
    let arguments = [small(), "--cache", cache.to_str().unwrap(), "--set", "kmax=30"];
    for start in 0..2 {
        let mut seat = Seat::at_tui(&arguments);
        seat.until_settled();
        seat.press("5");
        seat.until_shown("ran mem");
        let row = seat.text().lines().find(|line| line.contains("● spectrum")).unwrap().to_owned();
        // Ran, from memory, from disk.
        let counts = row.split("spectrum").nth(1).unwrap().split_whitespace().take(3).collect::<Vec<_>>().join(" ");
        assert_eq!(counts, if start == 0 { "12 · ·" } else { "· · 12" }, "{row}");
        seat.press("q");
        assert_eq!(seat.end().exit_code(), 0);
    }
}

#[test]
fn a_key_during_a_cold_run_answers_at_once() {
    let mut seat = at_heavy("busy");
    seat.until_shown("solving");
    seat.press("t");
    let mut waits: Vec<Duration> = (21..41)
        .map(|rounds| {
            thread::sleep(Duration::from_millis(10));
            let began = Instant::now();
            seat.press(RIGHT);
            seat.until_shown(&format!("‹{rounds}›"));
            began.elapsed()
        })
        .collect();
    waits.sort();
    // The frame takes a millisecond; the rest is the machine's, which may be busy with other tests.
    assert!(waits[waits.len() / 2] < Duration::from_millis(100), "{waits:?}");
    assert!(seat.text().contains("solving"), "else this shows nothing");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}

#[test]
fn quitting_does_not_wait_for_the_spectra() {
    let quickest = (0..3)
        .map(|_| {
            let mut seat = at_heavy("quit");
            seat.until_shown("solving");
            thread::sleep(Duration::from_millis(300));
            let began = Instant::now();
            seat.press("q");
            assert_eq!(seat.end().exit_code(), 0);
            let took = began.elapsed();
            seat.assert_restored();
            took
        })
        .min()
        .unwrap();
    assert!(quickest < Duration::from_millis(200), "{quickest:?}");
}

#[test]
fn the_mouse_is_the_terminals_until_it_is_asked_for_and_after_every_end() {
    let listens = |seat: &Seat| seat.look(|screen| screen.mouse_protocol_mode() != MouseProtocolMode::None);
    let mut seat = at_small("mouse");
    seat.until_shown("up to date");
    assert!(!listens(&seat));
    seat.press("M");
    seat.until("the mouse to be listened to", |screen| screen.mouse_protocol_mode() != MouseProtocolMode::None);
    // The tab of the tables: column 17 of the second row.
    seat.press("\x1b[<0;17;2M\x1b[<0;17;2m");
    seat.until_shown("Table 1:");
    seat.signal(Signal::TERM);
    assert_eq!(seat.end().exit_code(), 143);
    assert!(!listens(&seat));
    seat.assert_restored();
}

#[test]
fn a_terminal_that_shows_pictures_gets_one_and_others_get_none() {
    for (program, pictured) in [("WezTerm", true), ("other", false)] {
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_tui"));
        let cache = folder("pictures");
        command.args([small(), "--cache", cache.to_str().unwrap(), "--set", "kmax=20"]);
        command.env("TERM_PROGRAM", program);
        command.env_remove("TMUX");
        command.env_remove("STY");
        let mut seat = Seat::at(command, 80, 24);
        seat.until_shown("up to date");
        let before = seat.bytes();
        seat.press("9");
        seat.until_shown(if pictured { "pixels ×1.0" } else { "dots ×1.0" });
        if pictured {
            seat.until("a picture", |_| seat.bytes() > before + 8000);
        }
        seat.until_settled();
        let blank = seat.look(|screen| screen.contents().lines().skip(5).take(16).all(|line| line.trim().is_empty()));
        assert_eq!(blank, pictured, "characters or a picture, and not both");
        seat.press("q");
        assert_eq!(seat.end().exit_code(), 0);
        seat.assert_restored();
    }
}

#[test]
fn a_terminal_that_answers_that_it_has_sixels_gets_them_and_another_is_asked_once() {
    const SIXELS: &[(&str, &str)] =
        &[("\x1b[c", "\x1b[?62;4;22c"), ("\x1b[?1;1;0S", "\x1b[?1;0;256S"), ("\x1b[16t", "\x1b[6;20;10t")];
    const NONE: &[(&str, &str)] = &[("\x1b[c", "\x1b[?62;22c")];
    let at = |answers| {
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_tui"));
        let cache = folder("sixels");
        command.args([small(), "--cache", cache.to_str().unwrap(), "--set", "kmax=20"]);
        command.env_remove("TERM_PROGRAM");
        let seat = Seat::at_answering(command, 80, 24, answers);
        seat.until_shown("up to date");
        assert!(!seat.wrote(b"\x1b[c"), "nothing is asked before a shape is shown");
        seat
    };
    let leave = |mut seat: Seat| {
        seat.press("q");
        assert_eq!(seat.end().exit_code(), 0);
        seat.assert_restored();
    };
    let mut plain = at(NONE);
    plain.press("9");
    plain.until_shown("dots ×1.0");
    plain.until_settled();
    plain.press("19");
    plain.until_settled();
    assert_eq!((plain.written(b"\x1b[c"), plain.written(b"\x1bP"), plain.written(b"\x1b[16t")), (1, 0, 0));
    leave(plain);

    let mut seat = at(SIXELS);
    let picture = b"\x1bP0;1q\"1;1;";
    let pictures = |seat: &Seat| seat.written(picture);
    seat.press("9");
    seat.until_shown("pixels ×1.0");
    seat.until("a picture", |_| pictures(&seat) == 1);
    seat.until_settled();
    assert_eq!(pictures(&seat), 1, "it is sent once");
    let frame = seat.last_written(b"\x1b[?2026h");
    assert!(frame.windows(picture.len()).any(|window| window == picture), "within a synchronised update");
    assert!(frame.ends_with(b"\x1b\\\x1b8\x1b[?2026l"), "and the cursor is put back");
    // What opens above it is not painted over, and it is erased below.
    seat.press("?");
    seat.until_shown("Keys");
    assert!(pictures(&seat) == 1 && seat.last_written(b"\x1b[?2026h").starts_with(b"\x1b[?2026h\x1b7\x1b[m\x1b["));
    seat.press("\x1b");
    seat.until("the picture again", |_| pictures(&seat) == 2);
    for turned in 3..6 {
        seat.press("\x1b[C");
        seat.until("the next picture", |_| pictures(&seat) >= turned);
    }
    seat.press("1");
    seat.until_shown("HCBw");
    seat.until_settled();
    let before = pictures(&seat);
    seat.press("2");
    seat.until_settled();
    assert_eq!(pictures(&seat), before);
    leave(seat);
}

#[test]
fn what_the_engine_does_is_logged() {
    let file = folder("log").join("tui.log");
    let cache = folder("logged").to_str().unwrap().to_owned();
    let mut seat =
        Seat::at_tui(&[small(), "--cache", &cache, "--set", "kmax=20", "--mouse", "--log", file.to_str().unwrap()]);
    seat.until_shown("up to date");
    seat.press("J");
    seat.until_shown("study of");
    seat.press("qq");
    assert_eq!(seat.end().exit_code(), 0);
    seat.assert_restored();
    let log = std::fs::read_to_string(&file).unwrap();
    assert!(log.starts_with("# eigenselect ") && log.contains(" note    spectra: "), "{log}");
}

#[test]
fn signals_give_the_terminal_back() {
    for (signal, code) in [(Signal::TERM, 143), (Signal::HUP, 129), (Signal::INT, 130)] {
        let mut seat = at_heavy("signals");
        seat.until_shown("solving");
        seat.signal(signal);
        assert_eq!(seat.end().exit_code(), code, "{signal:?}");
        seat.assert_restored();
    }
}

#[test]
fn ctrl_c_interrupts() {
    let mut seat = at_small("interrupt");
    seat.until_shown("eigenselect");
    seat.press("=12");
    seat.press(CTRL_C);
    assert_eq!(seat.end().exit_code(), 130);
    seat.assert_restored();
}

/// A window with the program in it, for the test below: says its process and stays open.
#[test]
#[ignore = "is run by another test"]
fn window_program() {
    let seat = at_small("window");
    seat.until_shown("eigenselect");
    println!("process {}", seat.process());
    thread::sleep(Duration::from_mins(1));
}

#[test]
fn a_closed_window_ends_the_program() {
    let mut window = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", "window_program", "--nocapture", "--test-threads=1"])
        .env(seat::SMALL, small())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines = io::BufReader::new(window.stdout.take().unwrap()).lines();
    let process = lines.map(Result::unwrap).find_map(|line| line.split_once("process ").map(|(_, id)| id.to_owned()));
    let process = process.unwrap();
    assert!(alive(&process), "else this shows nothing");
    // Killed like this, the window cannot see to anything: the system closes its end of the terminal.
    window.kill().unwrap();
    window.wait().unwrap();
    let began = Instant::now();
    while alive(&process) {
        assert!(began.elapsed() < Duration::from_secs(10));
        thread::sleep(Duration::from_millis(5));
    }
}

/// True while a process runs; one that has ended and is not yet buried does not.
fn alive(process: &str) -> bool {
    let id = rustix::process::Pid::from_raw(process.parse().unwrap()).unwrap();
    let buried = rustix::process::test_kill_process(id).is_err();
    let state = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    !buried && !state.rsplit(')').next().unwrap_or_default().trim_start().starts_with('Z')
}

#[test]
fn ctrl_z_gives_the_terminal_to_the_shell_and_fg_takes_it_again() {
    let mut shell = CommandBuilder::new("sh");
    shell.args(["-i"]);
    shell.env("PS1", "ready> ");
    shell.env_remove("ENV");
    let cache = folder("suspended");
    let mut seat = Seat::at(shell, 80, 24);
    seat.until_shown("ready> ");
    let settings = seat.settings();
    let tui = format!("'{}' '{}' --cache '{}'\n", env!("CARGO_BIN_EXE_tui"), small(), cache.display());
    seat.press(&tui);
    seat.until("screen", vt100::Screen::alternate_screen);
    seat.until_shown("eigenselect");
    seat.press(CTRL_Z);
    seat.until("shell", |screen| !screen.alternate_screen() && !screen.hide_cursor());
    seat.press("echo sto''pped\n");
    seat.until_shown("stopped");
    assert_eq!(seat.settings(), settings, "the shell has its terminal back as it was");
    seat.press("fg\n");
    seat.until("screen again", |screen| screen.alternate_screen() && screen.contents().contains("2 Curves"));
    seat.press("q");
    seat.until("shell again", |screen| !screen.alternate_screen());
    seat.press("echo en''ded $?\n");
    seat.until_shown("ended 0");
    assert_eq!(seat.settings(), settings);
    seat.press("exit\n");
    seat.end();
}

#[test]
fn nothing_is_written_while_nothing_happens() {
    let mut seat = at_small("idle");
    seat.until_settled();
    let before = seat.bytes();
    thread::sleep(Duration::from_secs(2));
    assert_eq!(seat.bytes() - before, 0);
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}

#[test]
fn a_press_writes_little() {
    let mut seat = at_small("bytes");
    seat.until_settled();
    seat.press("t");
    let mut sizes: Vec<usize> = (0..9)
        .map(|_| {
            seat.until_settled();
            let before = seat.bytes();
            seat.press(RIGHT);
            seat.until_settled();
            seat.bytes() - before
        })
        .collect();
    sizes.sort_unstable();
    assert!((1..2048).contains(&sizes[sizes.len() / 2]), "{sizes:?}");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}

/// No q and no Ctrl-C; Ctrl-Z would stop a program that no shell continues.
const KEYS: &[&str] = &[
    "\x1b[A",
    "\x1b[B",
    "\x1b[C",
    "\x1b[D",
    "\x1b[5~",
    "\x1b[6~",
    "\x1b[H",
    "\x1b[F",
    "\x1b[1;2C",
    "\x1b[1;2D",
    "\t",
    "\x1b[Z",
    "\r",
    "\x7f",
    "1",
    "2",
    "3",
    "4",
    "5",
    "6",
    "=",
    "9",
    "o",
    "m",
    "n",
    "d",
    "k",
    "t",
    "c",
    "s",
    "l",
    "g",
    "f",
    "a",
    "A",
    "w",
    "u",
    "U",
    "r",
    "R",
    " ",
    "+",
    "-",
    "<",
    ">",
    "?",
    "\x0c",
    "\x15",
    "é",
    "象",
    "\x1b[200~",
    "\x1b[M!!!",
    "\x1bOP",
    "\x1b[15~",
    "\u{0}",
];

#[test]
fn a_storm_of_sizes_and_keys_does_no_harm() {
    let mut seat = at_small("storm");
    seat.until_shown("eigenselect");
    let mut number = 7_u64;
    let mut below = |end: u64| {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 33) % end
    };
    for turn in 0..10_000 {
        seat.press(KEYS[below(KEYS.len() as u64) as usize]);
        if turn % 40 == 0 {
            let (columns, rows) = (1 + below(160) as u16, 1 + below(60) as u16);
            seat.resize(columns, rows);
        }
        assert!(turn % 500 != 0 || seat.runs(), "it ended after {turn} keys");
    }
    seat.resize(80, 24);
    // Whatever is open is closed by these, and then the value is not typed but the view shown.
    seat.press("\x1b");
    thread::sleep(Duration::from_millis(300));
    seat.press("\x1b");
    thread::sleep(Duration::from_millis(300));
    seat.press("5\x0c");
    seat.until_shown("content hash");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
    seat.assert_restored();
}

#[test]
fn no_such_folder_is_said_on_the_shells_screen() {
    let mut seat = Seat::at_tui(&["no-such-folder"]);
    assert_eq!(seat.end().exit_code(), 1);
    seat.until_shown("no-such-folder: no such folder");
    seat.assert_restored();
}

#[test]
fn files_with_hostile_names_do_nothing_to_the_terminal() {
    use std::os::unix::ffi::OsStrExt as _;
    let data = folder("hostile").join("shapes");
    let names: [&[u8]; 6] = [
        b"\x1b[2J\x1b]0;owned\x07\x1b[31m",
        b"\xff\xfe not utf-8",
        "שלום \u{202e}fdp".as_bytes(),
        "🐘👩‍👩‍👧 象".as_bytes(),
        &[b'x'; 240],
        b"a\r\nb\tc\x08\x9b31m",
    ];
    let inside = |folder: &std::path::Path| {
        let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        entries
    };
    let splits = inside(small().as_ref()).into_iter().filter(|split| split.is_dir());
    for split in splits {
        for (place, class) in inside(&split).iter().enumerate() {
            let own = data.join(split.file_name().unwrap()).join(std::ffi::OsStr::from_bytes(names[place]));
            std::fs::create_dir_all(&own).unwrap();
            for (model, file) in inside(class).iter().enumerate() {
                let ending = file.extension().unwrap().as_bytes();
                let name = [names[(place + model) % names.len()], b".", ending].concat();
                std::fs::copy(file, own.join(std::ffi::OsStr::from_bytes(&name))).unwrap();
            }
        }
    }
    let cache = folder("hostile-cache");
    let mut seat = Seat::at_tui(&[data.to_str().unwrap(), "--cache", cache.to_str().unwrap(), "--set", "kmax=30"]);
    seat.until_settled();
    for key in ["2", "3", "4", "5", "6", "7", ".", "\r", "\r", "8", "9", "0", ":mod", "\x1b", "?", "\x1b"] {
        seat.press(key);
        thread::sleep(Duration::from_millis(100));
    }
    seat.press("6");
    seat.until_shown("of 12");
    assert!(!seat.wrote(b"\x1b]0;"), "no name sets the title");
    assert!(!seat.wrote(b"\x1b[31m\x1b") && !seat.wrote("\u{202e}".as_bytes()) && !seat.wrote(b"\x9b31m."));
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
    seat.assert_restored();
}

/// An engine that fails in the way its name says as soon as it is told anything.
struct Faulty {
    fault: String,
    notify: std::sync::Mutex<Option<Notify>>,
}

impl Engine for Faulty {
    fn send(&self, _: Command) {
        let Some(notify) = self.notify.lock().unwrap().take() else { return };
        match self.fault.as_str() {
            "screen" => panic!("the screen's thread panicked on purpose"),
            "fatal" => notify(Update::Fatal("the engine \u{1b}[2J ended on purpose".to_owned())),
            _ => drop(thread::spawn(|| panic!("another thread panicked on purpose"))),
        }
    }
}

/// The program of the two tests below, run by them in a terminal.
#[test]
#[ignore = "is run by other tests"]
fn faulty_program() {
    let fault = std::env::var("FAULT").unwrap();
    let opening = Opening {
        title: "data".to_owned(),
        settings: Settings::default(),
        look: Look::default(),
        mouse: false,
        pictures: Pictures::None,
        recipe: None,
        last: None,
    };
    let start = |notify| -> io::Result<Faulty> { Ok(Faulty { fault, notify: Some(notify).into() }) };
    let ending = terminal::run(opening, start).unwrap();
    println!("{:?}", ending.lines);
    std::process::exit(i32::from(ending.exit.code()));
}

fn at_faulty(fault: &str) -> Seat {
    let mut command = CommandBuilder::new(std::env::current_exe().unwrap());
    command.args(["--ignored", "--exact", "faulty_program", "--nocapture", "--test-threads=1"]);
    command.env("FAULT", fault);
    command.env("RUST_BACKTRACE", "0");
    let mut seat = Seat::at(command, 80, 24);
    seat.until_shown("eigenselect");
    seat.press(RIGHT);
    seat
}

#[test]
fn a_panic_of_the_screen_gives_the_terminal_back_before_it_is_told() {
    let mut seat = at_faulty("screen");
    assert_ne!(seat.end().exit_code(), 0);
    seat.until_shown("the screen's thread panicked on purpose");
    seat.assert_restored();
}

#[test]
fn a_panic_of_another_thread_leaves_the_screen_in_order() {
    let mut seat = at_faulty("other");
    seat.until("report", |screen| {
        screen.alternate_screen() && screen.contents().contains("another thread panicked on purpose")
    });
    seat.press("4");
    seat.until_shown("Figure 5");
    assert!(!seat.text().contains("another thread"), "the report goes with the next key, and nothing else is there");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
    seat.until_shown("another thread panicked on purpose");
    seat.assert_restored();
}

#[test]
fn an_engine_that_ends_is_told_and_makes_the_program_fail() {
    let mut seat = at_faulty("fatal");
    seat.until_shown("[2J ended on purpose");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 1);
    seat.until_shown("[2J ended on purpose");
    seat.assert_restored();
}
