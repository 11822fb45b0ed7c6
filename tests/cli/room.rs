//! A folder to run the program in, and small shapes to run it on.

use std::{
    f64::consts::{PI, TAU},
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

use tempfile::TempDir;

/// A folder of its own for a test, which is also the user's home.
pub struct Room {
    dir: TempDir,
}

impl Room {
    /// An empty one.
    pub fn new() -> Self {
        Self { dir: tempfile::tempdir().unwrap() }
    }

    /// With a data set of two classes of six in `shapes`.
    pub fn with_study() -> Self {
        let room = Self::new();
        for class in ["ball", "ring"] {
            fs::create_dir_all(room.path("shapes").join(class)).unwrap();
        }
        for model in 0..6 {
            let size = 1.0 + f64::from(model) / 10.0;
            fs::write(room.path(&format!("shapes/ball/ball-{model}.off")), ball(8, 10, size)).unwrap();
            fs::write(room.path(&format!("shapes/ring/ring-{model}.off")), ring(12, 7, 0.3 * size)).unwrap();
        }
        room
    }

    /// The path of `name` in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// The user's home in it.
    pub fn home(&self) -> PathBuf {
        self.path("home")
    }

    /// The entries of its folder `cache`.
    pub fn entries(&self) -> Vec<PathBuf> {
        let list = |dir: &Path| -> Vec<PathBuf> {
            fs::read_dir(dir).map(|dir| dir.filter_map(|entry| Some(entry.ok()?.path())).collect()).unwrap_or_default()
        };
        let folders = list(&self.path("cache"));
        let files = folders.iter().flat_map(|folder| list(folder));
        files.filter(|file| file.extension().is_some_and(|ending| ending == "entry")).collect()
    }
}

/// How a run ended.
pub struct Outcome {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Outcome {
    /// Waits for it.
    pub fn of(child: Child) -> Self {
        let output = child.wait_with_output().unwrap();
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// Starts the program in the room.
pub fn spawn(room: &Room, arguments: &[&str], out: Stdio) -> Child {
    fs::create_dir_all(room.home()).unwrap();
    Command::new(env!("CARGO_BIN_EXE_tui"))
        .args(arguments)
        .current_dir(room.dir.path())
        .env("HOME", room.home())
        .env("XDG_CACHE_HOME", room.home().join("cache"))
        .env("XDG_CONFIG_HOME", room.home().join("config"))
        .env_remove("COLUMNS")
        .stdin(Stdio::null())
        .stdout(out)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Runs the program in the room.
pub fn tui(room: &Room, arguments: &[&str]) -> Outcome {
    Outcome::of(spawn(room, arguments, Stdio::piped()))
}

/// Sends SIGINT.
#[cfg(unix)]
pub fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

/// An ellipsoid of revolution in OFF: `rows` rings of `columns` vertices between two poles, half axes 1, 1, `height`.
pub fn ball(rows: usize, columns: usize, height: f64) -> String {
    let mut vertices = vec![[0.0, 0.0, height]];
    for row in 1..rows {
        let polar = PI * row as f64 / rows as f64;
        for column in 0..columns {
            let turn = TAU * column as f64 / columns as f64;
            vertices.push([polar.sin() * turn.cos(), polar.sin() * turn.sin(), height * polar.cos()]);
        }
    }
    vertices.push([0.0, 0.0, -height]);
    let at = |row: usize, column: usize| 1 + (row - 1) * columns + column % columns;
    let last = vertices.len() - 1;
    let mut faces = Vec::new();
    for column in 0..columns {
        faces.push([0, at(1, column), at(1, column + 1)]);
        faces.push([last, at(rows - 1, column + 1), at(rows - 1, column)]);
        for row in 1..rows - 1 {
            let quad = [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
            faces.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    off(&vertices, &faces)
}

/// A torus in OFF: `around` by `across` vertices, radius 1 of the core, `thickness` of the tube.
pub fn ring(around: usize, across: usize, thickness: f64) -> String {
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for i in 0..around {
        let u = TAU * i as f64 / around as f64;
        for j in 0..across {
            let v = TAU * j as f64 / across as f64;
            let radius = 1.0 + thickness * v.cos();
            vertices.push([radius * u.cos(), radius * u.sin(), thickness * v.sin()]);
            let at = |i: usize, j: usize| (i % around) * across + j % across;
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    off(&vertices, &faces)
}

fn off(vertices: &[[f64; 3]], faces: &[[usize; 3]]) -> String {
    let mut text = format!("OFF\n{} {} 0\n", vertices.len(), faces.len());
    for [x, y, z] in vertices {
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    for [a, b, c] in faces {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

/// Processor time of a program's threads so far, and whether it has ended; none where the system does not tell.
fn times(child: &Child) -> Option<(Duration, bool)> {
    let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    // After the name, which is in parentheses: the state, and in the 12th and 13th place hundredths of a second.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let hundredths = |at: usize| fields.get(at)?.parse::<u64>().ok();
    Some((Duration::from_millis(10 * (hundredths(11)? + hundredths(12)?)), fields.first() == Some(&"Z")))
}

/// Processor time that a program has taken; none where the system does not tell.
pub fn spent(child: &Child) -> Option<Duration> {
    times(child).map(|(time, _)| time)
}

/// Waits for a program's end, which is not asked for here, and tells the processor time it took in all.
pub fn spent_until_its_end(child: &Child) -> Option<Duration> {
    loop {
        let (time, ended) = times(child)?;
        if ended {
            return Some(time);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}
