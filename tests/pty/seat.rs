//! A seat in front of the program: a pseudo-terminal, a keyboard, eyes and a clock.

use std::{
    env,
    io::{Read as _, Write},
    num::NonZeroU16,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{
        Arc, Mutex, OnceLock,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use portable_pty::{Child, CommandBuilder, ExitStatus, MasterPty, PtySize, native_pty_system};
use rustix::process::{Pid, Signal, kill_process};
use vt100::{Parser, Screen};

/// Nothing here takes longer, even on a machine that is busy with other things.
const PATIENCE: Duration = Duration::from_secs(90);

/// Someone in front of a program.
pub struct Seat {
    master: Box<dyn MasterPty + Send>,
    keyboard: Arc<Mutex<Box<dyn Write + Send>>>,
    child: Box<dyn Child + Send + Sync>,
    eyes: Arc<Mutex<Parser>>,
    bytes: Arc<AtomicUsize>,
    written: Arc<Mutex<Vec<u8>>>,
    before: String,
}

fn cells(number: u16) -> NonZeroU16 {
    NonZeroU16::new(number).unwrap()
}

fn size(columns: u16, rows: u16) -> PtySize {
    PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 }
}

impl Seat {
    /// Sits down in front of `tui` with these arguments.
    pub fn at_tui(arguments: &[&str]) -> Self {
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_tui"));
        command.args(arguments);
        Self::at(command, 80, 24)
    }

    /// Sits down in front of a program on a terminal of this size.
    pub fn at(command: CommandBuilder, columns: u16, rows: u16) -> Self {
        Self::at_answering(command, columns, rows, &[])
    }

    /// Sits down in front of a program on a terminal that answers when it is asked: questions with their answers.
    pub fn at_answering(
        mut command: CommandBuilder,
        columns: u16,
        rows: u16,
        answers: &'static [(&'static str, &'static str)],
    ) -> Self {
        command.env("TERM", "xterm-256color");
        command.env("LC_ALL", "C.UTF-8");
        command.env_remove("NO_COLOR");
        command.env("XDG_CONFIG_HOME", "/nonexistent");
        let pair = native_pty_system().openpty(size(columns, rows)).unwrap();
        let before = modes(&*pair.master);
        let child = pair.slave.spawn_command(command).unwrap();
        drop(pair.slave);
        let keyboard = Arc::new(Mutex::new(pair.master.take_writer().unwrap()));
        let answering = Arc::clone(&keyboard);
        let mut light = pair.master.try_clone_reader().unwrap();
        let eyes = Arc::new(Mutex::new(Parser::new(cells(rows), cells(columns), 0)));
        let bytes = Arc::new(AtomicUsize::new(0));
        let written: Arc<Mutex<Vec<u8>>> = Arc::default();
        let (seeing, counting, keeping) = (Arc::clone(&eyes), Arc::clone(&bytes), Arc::clone(&written));
        thread::spawn(move || {
            let mut buffer = [0; 1 << 12];
            let mut heard = Vec::new();
            while let Ok(count @ 1..) = light.read(&mut buffer) {
                heard.extend_from_slice(&buffer[..count]);
                for (question, answer) in answers {
                    let asked = heard.windows(question.len()).filter(|window| *window == question.as_bytes()).count();
                    answering.lock().unwrap().write_all(answer.repeat(asked).as_bytes()).unwrap();
                }
                // The beginning of a question is kept until its end comes.
                let begun = heard.iter().rposition(|byte| *byte == 0x1b).filter(|at| {
                    let rest = &heard[*at..];
                    answers.iter().any(|(asked, _)| rest.len() < asked.len() && asked.as_bytes().starts_with(rest))
                });
                heard.drain(..begun.unwrap_or(heard.len()));
                seeing.lock().unwrap().process(&buffer[..count]);
                keeping.lock().unwrap().extend_from_slice(&buffer[..count]);
                counting.fetch_add(count, Ordering::SeqCst);
            }
        });
        Self { master: pair.master, keyboard, child, eyes, bytes, written, before }
    }

    /// Presses keys, given as the bytes that a terminal sends for them.
    pub fn press(&mut self, keys: &str) {
        let mut keyboard = self.keyboard.lock().unwrap();
        keyboard.write_all(keys.as_bytes()).unwrap();
        keyboard.flush().unwrap();
    }

    /// Looks at the screen.
    pub fn look<T>(&self, at: impl FnOnce(&Screen) -> T) -> T {
        at(self.eyes.lock().unwrap().screen())
    }

    /// The screen's text.
    pub fn text(&self) -> String {
        self.look(Screen::contents)
    }

    /// Waits until the screen is as described; says what was to be seen when it never is.
    pub fn until(&self, what: &str, seen: impl Fn(&Screen) -> bool) {
        let began = Instant::now();
        while !self.look(&seen) {
            assert!(began.elapsed() < PATIENCE, "no {what} to be seen on\n{}", self.text());
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Waits for a text.
    pub fn until_shown(&self, text: &str) {
        self.until(text, |screen| screen.contents().contains(text));
    }

    /// Waits until everything is computed and nothing more is written.
    pub fn until_settled(&self) {
        self.until_shown("up to date");
        loop {
            let before = self.bytes();
            thread::sleep(Duration::from_millis(400));
            if self.bytes() == before {
                return;
            }
        }
    }

    /// Bytes that the program has written.
    pub fn bytes(&self) -> usize {
        self.bytes.load(Ordering::SeqCst)
    }

    /// True when the program has written these bytes in a row at any time.
    pub fn wrote(&self, bytes: &[u8]) -> bool {
        self.written.lock().unwrap().windows(bytes.len()).any(|window| window == bytes)
    }

    /// How often it has written them.
    pub fn written(&self, bytes: &[u8]) -> usize {
        self.written.lock().unwrap().windows(bytes.len()).filter(|window| *window == bytes).count()
    }

    /// The last that it has written from these bytes on.
    pub fn last_written(&self, bytes: &[u8]) -> Vec<u8> {
        let written = self.written.lock().unwrap();
        let at = written.windows(bytes.len()).rposition(|window| window == bytes);
        at.map_or_else(Vec::new, |at| written[at..].to_vec())
    }

    /// The terminal's settings now.
    pub fn settings(&self) -> String {
        modes(&*self.master)
    }

    /// Makes the window another size.
    pub fn resize(&self, columns: u16, rows: u16) {
        self.eyes.lock().unwrap().screen_mut().set_size(cells(rows), cells(columns));
        self.master.resize(size(columns, rows)).unwrap();
    }

    /// The program's process.
    pub fn process(&self) -> Pid {
        Pid::from_raw(self.child.process_id().unwrap() as i32).unwrap()
    }

    /// Sends it a signal.
    pub fn signal(&self, signal: Signal) {
        kill_process(self.process(), signal).unwrap();
    }

    /// True while the program runs.
    pub fn runs(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Waits for the program's end.
    pub fn end(&mut self) -> ExitStatus {
        let began = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(began.elapsed() < PATIENCE, "still running\n{}", self.text());
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Checks that the terminal is as it was before the program ran.
    pub fn assert_restored(&self) {
        self.until("shell's screen", |screen| !screen.alternate_screen());
        self.until("cursor", |screen| !screen.hide_cursor());
        assert_eq!(modes(&*self.master), self.before, "the terminal's settings");
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        // A failed test leaves nobody running.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The terminal's settings, all of them.
fn modes(master: &dyn MasterPty) -> String {
    format!("{:?}", master.get_termios().unwrap())
}

/// A folder of this test's own.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pty").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Makes a data set with the program itself.
fn synth(folder: &Path, arguments: &[&str]) {
    let status = Command::new(env!("CARGO_BIN_EXE_tui"))
        .arg("synth")
        .arg(folder)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
}

/// Tells a program of these tests, run by another one, where the small data set is already.
pub const SMALL: &str = "SMALL_DATA_SET";

/// Three classes of four small shapes, which take no time.
pub fn small() -> &'static str {
    static DATA: OnceLock<String> = OnceLock::new();
    DATA.get_or_init(|| {
        if let Ok(made) = env::var(SMALL) {
            return made;
        }
        let data = folder("small").join("shapes");
        synth(&data, &["--classes", "3", "--models", "4", "--vertices", "300"]);
        data.to_str().unwrap().to_owned()
    })
}

/// Shapes that one thread solves for a long while.
pub fn heavy() -> &'static str {
    static DATA: OnceLock<String> = OnceLock::new();
    DATA.get_or_init(|| {
        let data = folder("heavy").join("shapes");
        synth(&data, &["--classes", "3", "--models", "8", "--vertices", "6000"]);
        data.to_str().unwrap().to_owned()
    })
}

/// In front of the small data set, with a cold cache of its own.
pub fn at_small(name: &str) -> Seat {
    let cache = folder(name);
    Seat::at_tui(&[small(), "--cache", cache.to_str().unwrap(), "--set", "kmax=30", "--threads", "2"])
}

/// In front of the heavy data set, with a cold cache of its own.
pub fn at_heavy(name: &str) -> Seat {
    let cache = folder(name);
    Seat::at_tui(&[heavy(), "--cache", cache.to_str().unwrap(), "--set", "kmax=500", "--threads", "1"])
}
