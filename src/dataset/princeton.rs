//! Classes by `.cla` files, the format of the Princeton Shape Benchmark.
//!
//! ```text
//! PSB 1
//! <number of classes> <number of models>
//!
//! <class> <parent class, or 0> <number of models>
//! <model>
//! …
//! ```

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
};

use super::{DataSetError, Found, Labelled, Options, Role, name, walk::Walk};

/// The `.cla` files of a data set.
#[derive(Debug)]
pub(super) struct Files {
    train: PathBuf,
    query: Option<PathBuf>,
}

/// Which `.cla` files there are: those of the options, or else the folder's own.
pub(super) fn files(root: &Path, options: &Options) -> Result<Option<Files>, DataSetError> {
    let named = |path: &PathBuf| {
        let below = root.join(path);
        if !path.exists() && below.exists() { below } else { path.clone() }
    };
    match (&options.train, &options.query) {
        (Some(train), query) => Ok(Some(Files { train: named(train), query: query.as_ref().map(named) })),
        (None, Some(query)) => Err(DataSetError::NoTrainingFile(query.clone())),
        (None, None) => {
            let own = |name: &str| Some(root.join(name)).filter(|path| path.is_file());
            let query = own("query.cla").or_else(|| own("test.cla"));
            match (own("train.cla"), query) {
                (Some(train), query) => Ok(Some(Files { train, query })),
                (None, Some(query)) => Err(DataSetError::NoTrainingFile(query)),
                (None, None) => Ok(None),
            }
        }
    }
}

/// Finds the models that the files name, anywhere below the folder.
pub(super) fn open(root: &Path, files: &Files) -> Result<Found, DataSetError> {
    let mut found = Found::default();
    let meshes = Meshes::below(root, &mut found.warnings);
    let mut owner: HashMap<PathBuf, String> = HashMap::new();
    let sides = [(Some(&files.train), Role::Train), (files.query.as_ref(), Role::Query)];
    let mut names = Vec::new();
    for (file, role) in sides {
        let Some(file) = file else { continue };
        let shown = name::text(file.file_name().unwrap_or_default());
        let listing = Listing::read(file)?;
        if listing.announced != listing.models() {
            let (announced, models) = (listing.announced, listing.models());
            found.warnings.push(format!("{shown}: announces {announced} models and names {models}"));
        }
        for (label, models) in listing.labels() {
            let class = found.classes.iter().position(|known| *known == label).unwrap_or_else(|| {
                found.classes.push(label.clone());
                found.classes.len() - 1
            });
            for model in models {
                let Some((path, others)) = meshes.find(root, model) else {
                    found.warnings.push(format!("{shown}: model {model} of class {label} has no mesh file"));
                    continue;
                };
                let below = |path: &Path| name::joined(path.strip_prefix(root).unwrap_or(path));
                if let Some(other) = others.first() {
                    let (path, other) = (below(path), below(other));
                    found.warnings.push(format!("{shown}: model {model} is {path}; passed over is {other}"));
                }
                let listed = format!("{shown} in class {label}");
                if let Some(before) = owner.get(path) {
                    found.warnings.push(format!("{shown}: model {model} of class {label} is already in {before}"));
                    continue;
                }
                owner.insert(path.to_owned(), listed);
                found.files.push(Labelled { path: path.to_owned(), class, role: Some(role) });
            }
        }
        names.push(shown);
    }
    found.layout = format!("Princeton .cla: {}", names.join(" and "));
    if files.query.is_none() {
        found.warnings.push(format!("{}: no query.cla beside it, so there are no queries", files.train.display()));
    }
    Ok(found)
}

/// The mesh files below a folder, by their names without ending.
struct Meshes {
    by_stem: HashMap<Vec<u8>, Vec<PathBuf>>,
}

impl Meshes {
    fn below(root: &Path, warnings: &mut Vec<String>) -> Self {
        let mut by_stem: HashMap<Vec<u8>, Vec<PathBuf>> = HashMap::new();
        for path in Walk::default().meshes(root, warnings) {
            let stem = path.file_stem().unwrap_or_default().as_encoded_bytes().to_vec();
            by_stem.entry(stem).or_default().push(path);
        }
        Self { by_stem }
    }

    /// The file of a model, and others that it could be. The benchmark's own files have an `m` before the number;
    /// some lists name a path below the folder or the ending too.
    fn find(&self, root: &Path, model: &str) -> Option<(&Path, &[PathBuf])> {
        for stem in [model, &format!("m{model}")] {
            if let Some((path, others)) = self.by_stem.get(stem.as_bytes()).and_then(|paths| paths.split_first()) {
                return Some((path, others));
            }
        }
        let last = model.rsplit('/').next().unwrap_or(model);
        let without = last.rsplit_once('.').map_or(last, |(stem, _)| stem);
        let candidates = [last, without].into_iter().filter_map(|stem| self.by_stem.get(stem.as_bytes())).flatten();
        let fits = |path: &&PathBuf| {
            let below = name::joined(path.strip_prefix(root).unwrap_or(path));
            let short = below.rsplit_once('.').map_or(below.as_str(), |(short, _)| short);
            [below.as_str(), short]
                .into_iter()
                .any(|text| text.strip_suffix(model).is_some_and(|before| before.is_empty() || before.ends_with('/')))
        };
        candidates.into_iter().find(fits).map(|path| (path.as_path(), &[][..]))
    }
}

/// One class of a `.cla` file.
#[derive(Debug)]
struct Class {
    name: String,
    parent: String,
    models: Vec<String>,
}

/// A `.cla` file.
#[derive(Debug)]
struct Listing {
    announced: usize,
    classes: Vec<Class>,
}

impl Listing {
    fn read(path: &Path) -> Result<Self, DataSetError> {
        let bytes = fs::read(path).map_err(|source| DataSetError::Io { path: path.to_owned(), source })?;
        Self::parse(&String::from_utf8_lossy(&bytes)).map_err(|(line, defect)| DataSetError::Cla {
            path: path.to_owned(),
            line,
            defect,
        })
    }

    /// Reads the text; an error is a line's number and what is wrong there.
    fn parse(text: &str) -> Result<Self, (usize, String)> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let last = text.lines().count().max(1);
        let mut lines =
            (1..).zip(text.lines()).map(|(number, line)| (number, line.trim())).filter(|(_, line)| !line.is_empty());
        let (number, line) = lines.next().ok_or((1, "the file is empty".to_owned()))?;
        if line.split_whitespace().next() != Some("PSB") {
            return Err((number, format!("the file does not begin with PSB, but with {line:?}")));
        }
        let (number, line) = lines.next().ok_or((last, "the file ends before its counts".to_owned()))?;
        let [_, announced] = words(line)
            .and_then(|counts: [&str; 2]| Some([counts[0].parse::<usize>().ok()?, counts[1].parse().ok()?]))
            .ok_or_else(|| (number, format!("needs the numbers of classes and of models, not {line:?}")))?;
        let mut classes = Vec::new();
        while let Some((number, line)) = lines.next() {
            let [name, parent, count] = words(line)
                .filter(|[_, _, count]| count.parse::<usize>().is_ok())
                .ok_or_else(|| (number, format!("needs a class, its parent and its number of models, not {line:?}")))?;
            // Parsed above.
            let count: usize = count.parse().unwrap_or_default();
            let mut models = Vec::new();
            while models.len() < count {
                let (_, line) = lines.next().ok_or_else(|| {
                    (last, format!("class {name} announces {count} models, but the file ends after {}", models.len()))
                })?;
                models.extend(line.split_whitespace().map(str::to_owned));
            }
            classes.push(Class { name: name.to_owned(), parent: parent.to_owned(), models });
        }
        Ok(Self { announced, classes })
    }

    fn models(&self) -> usize {
        self.classes.iter().map(|class| class.models.len()).sum()
    }

    /// Classes that have models, in the file's order. Parents group classes and are none themselves unless they name
    /// models; where two classes of one name have different parents, the parent stands before the name.
    fn labels(&self) -> impl Iterator<Item = (String, &[String])> {
        self.classes.iter().filter(|class| !class.models.is_empty()).map(|class| {
            let twin = self.classes.iter().any(|other| other.name == class.name && other.parent != class.parent);
            let label = if twin { format!("{}/{}", class.parent, class.name) } else { class.name.clone() };
            (label, class.models.as_slice())
        })
    }
}

/// Exactly so many words of a line.
fn words<const N: usize>(line: &str) -> Option<[&str; N]> {
    line.split_whitespace().collect::<Vec<_>>().try_into().ok()
}
