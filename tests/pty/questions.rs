//! Questions that a researcher has, answered by keys alone on the starter set.

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{
        OnceLock,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    RIGHT,
    seat::{Seat, folder},
};

/// The starter set and a cache with its first spectra: few eigenvalues, which take no time. Each screen has a cache of
/// its own, for it keeps its last session there, which it offers to the next one.
fn starter() -> Vec<String> {
    static FILLED: OnceLock<PathBuf> = OnceLock::new();
    static SCREENS: AtomicUsize = AtomicUsize::new(0);
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let words = |cache: &Path| {
        let words = [data.to_str().unwrap(), "--cache", cache.to_str().unwrap(), "--set", "kmax=20", "--set", "k=4"];
        words.map(str::to_owned).to_vec()
    };
    let filled = FILLED.get_or_init(|| {
        let cache = folder("starter");
        let mut report = Command::new(env!("CARGO_BIN_EXE_tui"));
        assert!(report.arg("report").args(words(&cache)).stdout(Stdio::null()).status().unwrap().success());
        cache
    });
    let own = folder(&format!("starter-{}", SCREENS.fetch_add(1, Ordering::Relaxed)));
    assert!(Command::new("cp").arg("-r").arg(filled.join(".")).arg(&own).status().unwrap().success());
    words(&own)
}

/// In front of the starter set, on a screen of the larger usual size.
fn at_starter() -> Seat {
    let mut command = portable_pty::CommandBuilder::new(env!("CARGO_BIN_EXE_tui"));
    command.args(starter());
    let seat = Seat::at(command, 120, 40);
    seat.until_settled();
    seat
}

fn line(seat: &Seat, with: &str) -> String {
    let text = seat.text();
    text.lines().find(|line| line.contains(with)).unwrap_or_else(|| panic!("no {with:?} on\n{text}")).to_owned()
}

#[test]
fn which_class_is_confused_most_and_what_tells_it_from_the_other() {
    let mut seat = at_starter();
    seat.press("7");
    seat.until_shown("most often wrong: ");
    let said = line(&seat, "most often wrong: ");
    seat.press(".");
    seat.until_shown(" taken for ");
    // The classes of the fullest cell are what the next view compares.
    let cell = line(&seat, " taken for ");
    let (own, other) = cell.split_once(" taken for ").unwrap();
    let own = own.split_whitespace().last().unwrap().to_owned();
    let other = other.split(':').next().unwrap().trim().to_owned();
    seat.press("a");
    seat.until("two classes", |screen| {
        screen.contents().lines().any(|l| l.contains(&format!("{own} against ")) && l.contains(&other))
    });
    seat.until_shown("λ with + greater");
    assert!(said.contains(" of "), "{said}");
    seat.press("\x7f");
    seat.until_shown("most often wrong: ");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}

#[test]
fn what_adaboost_gains_by_more_rounds() {
    let mut seat = at_starter();
    seat.press("tP");
    seat.press("=40\r");
    seat.until_shown("AdaBoost T = 40");
    seat.press("0");
    seat.until_shown("against the pins");
    seat.press("[");
    seat.until_shown("AdaBoost against the pins");
    // The parameter that differs, now and in the pin.
    seat.until("T", |screen| {
        screen.contents().lines().any(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            words.ends_with(&["T", "40", "20"])
        })
    });
    seat.until_shown("p ");
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}

#[test]
fn what_a_model_suffers_from() {
    let mut seat = at_starter();
    seat.press("6");
    seat.press("/hand");
    seat.until_shown("models with hand");
    seat.press("\r");
    seat.until_shown("with \"hand\"");
    seat.press(RIGHT);
    seat.until_shown(" vertices · ");
    assert!(seat.text().contains("defects"), "{}", seat.text());
    seat.press("q");
    assert_eq!(seat.end().exit_code(), 0);
}
