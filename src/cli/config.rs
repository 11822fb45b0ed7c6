//! The user's configuration: a TOML file in the user's folder for configurations. Arguments override it.
//!
//! ```toml
//! threads = 4
//!
//! [set]                     # the parameters that the screen begins with, by name
//! kmax = 200
//! normalisation = "log"
//!
//! [screen]
//! ground = "light"          # auto, light, dark
//! colours = "many"          # auto, none, few (16), many (256), all
//! ascii = false
//! mouse = false
//! graphics = "auto"         # auto, kitty, sixel, none: pictures of shapes
//! log = "/tmp/tui.log"
//!
//! [cache]
//! dir = "/scratch/spectra"
//! limit = "4G"              # the entries used longest ago go when the screen is left
//! ```

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::{
    args::{Setting, StudyArguments, values::size},
    exit::Failure,
};
use crate::{
    query::{Parameter, Settings},
    terminal::Pictures,
    ui::{Look, Shades},
};

/// The file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Config {
    /// Models solved at once.
    pub(super) threads: Option<u16>,
    set: BTreeMap<String, toml::Spanned<Value>>,
    pub(super) screen: Screen,
    pub(super) cache: Cache,
    /// The file it was read from, if there was one.
    #[serde(skip)]
    pub(super) file: Option<PathBuf>,
    /// The parameters of `set`, checked.
    #[serde(skip)]
    pub(super) settings: Vec<Setting>,
}

/// A value of a parameter.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Value {
    Number(u64),
    Word(String),
}

/// How the screen is drawn.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Screen {
    ground: Ground,
    colours: Colours,
    ascii: Option<bool>,
    /// The mouse is listened to from the beginning.
    pub(super) mouse: bool,
    /// Pictures instead of characters.
    pub(super) graphics: Graphics,
    /// What the engine does is written there.
    pub(super) log: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Ground {
    #[default]
    Auto,
    Light,
    Dark,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Colours {
    #[default]
    Auto,
    None,
    Few,
    Many,
    All,
}

/// Whether shapes are shown as pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Graphics {
    /// Where the terminal takes them.
    #[default]
    Auto,
    /// Always, by kitty's protocol.
    Kitty,
    /// Always, by sixels.
    Sixel,
    /// Never.
    None,
}

impl From<Graphics> for Pictures {
    fn from(graphics: Graphics) -> Self {
        match graphics {
            Graphics::Auto => Self::Auto,
            Graphics::Kitty => Self::Kitty,
            Graphics::Sixel => Self::Sixels,
            Graphics::None => Self::None,
        }
    }
}

/// Where spectra are kept.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Cache {
    /// The folder.
    pub(super) dir: Option<PathBuf>,
    limit: Option<toml::Spanned<Size>>,
    /// The most bytes that are kept when the screen is left.
    #[serde(skip)]
    pub(super) most: Option<u64>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Size {
    Bytes(u64),
    Words(String),
}

/// The file in the user's folder for configurations; none without a home.
pub(super) fn place() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "eigenselect").map(|dirs| dirs.config_dir().join("config.toml"))
}

/// Reads the user's configuration; its defaults where there is no file.
///
/// # Errors
/// When the file cannot be read, or says something that is not known: the line is named.
pub(super) fn load() -> Result<Config, Failure> {
    let Some(file) = place() else { return Ok(Config::default()) };
    match std::fs::read_to_string(&file) {
        Ok(text) => {
            let read = read(&text).map_err(|error| Failure::Failed(format!("{}{error}", file.display())))?;
            Ok(Config { file: Some(file), ..read })
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Config::default()),
        Err(error) => Err(Failure::caused(format!("{}: cannot be read", file.display()), error)),
    }
}

/// Reads a configuration. An error begins with `:LINE: ` of the text, or with `: `.
fn read(text: &str) -> Result<Config, String> {
    let line = |at: usize| text[..at.min(text.len())].matches('\n').count() + 1;
    let mut config: Config = toml::from_str(text).map_err(|error| {
        let place = error.span().map_or_else(String::new, |span| line(span.start).to_string());
        let message = error.message().trim_end();
        if place.is_empty() { format!(": {message}") } else { format!(":{place}: {message}") }
    })?;
    let mut trial = Settings::default();
    for (name, value) in &config.set {
        let at = line(value.span().start);
        let parameter = Parameter::named(name).ok_or_else(|| {
            let names: Vec<_> = Parameter::ALL.iter().map(|parameter| parameter.name()).collect();
            format!(":{at}: there is no parameter {name:?}; the parameters are {}", names.join(", "))
        })?;
        let value = match value.get_ref() {
            Value::Number(number) => number.to_string(),
            Value::Word(word) => word.clone(),
        };
        // A class is known only with a data set.
        if parameter == Parameter::Class {
            return Err(format!(":{at}: class depends on the data set; --set class=NAME chooses it"));
        }
        trial.set(parameter, &value, 1).map_err(|reason| format!(":{at}: {reason}"))?;
        config.settings.push(Setting { parameter, value });
    }
    if let Some(limit) = &config.cache.limit {
        let read = match limit.get_ref() {
            Size::Bytes(bytes) => Ok(*bytes),
            Size::Words(words) => size(words),
        };
        config.cache.most = Some(read.map_err(|reason| format!(":{}: {reason}", line(limit.span().start)))?);
    }
    if config.threads.is_some_and(|threads| !(1..=1024).contains(&threads)) {
        let at = text.lines().position(|line| line.trim_start().starts_with("threads")).unwrap_or(0) + 1;
        return Err(format!(":{at}: threads takes a number from 1 to 1024"));
    }
    Ok(config)
}

impl Config {
    /// The arguments of a report with what they leave open taken from here: where and with how many threads. The
    /// parameters are those of the command line alone, so that a command gives everybody the same figures.
    pub(super) fn complete(&self, mut arguments: StudyArguments) -> StudyArguments {
        arguments.cache = arguments.cache.or_else(|| self.cache.dir.clone());
        arguments.threads = arguments.threads.or(self.threads);
        arguments
    }

    /// The arguments of the screen with what they leave open taken from here, the parameters to begin with among it.
    pub(super) fn complete_screen(&self, arguments: StudyArguments) -> StudyArguments {
        let mut arguments = self.complete(arguments);
        // A recipe says all of its parameters.
        if arguments.recipe.is_none() {
            arguments.set = self.settings.iter().cloned().chain(arguments.set).collect();
        }
        arguments
    }

    /// The look of the screen: what is asked for here goes before what the terminal says, `NO_COLOR` before both.
    pub(super) fn look(&self, found: Look) -> Look {
        let shades = match self.screen.colours {
            Colours::Auto | Colours::None => found.shades,
            Colours::Few => Shades::Few,
            Colours::Many => Shades::Many,
            Colours::All => Shades::All,
        };
        let light = match self.screen.ground {
            Ground::Auto => found.light,
            Ground::Light => true,
            Ground::Dark => false,
        };
        let colour = found.colour && self.screen.colours != Colours::None;
        Look { colour, ascii: self.screen.ascii.unwrap_or(found.ascii), shades, light }
    }
}

/// The configuration in words for `tui doctor`: the file, and what it sets.
pub(super) fn said(config: &Config) -> String {
    let file = config.file.as_deref();
    let place = file.map(Path::to_path_buf).or_else(place);
    let place = place.map_or_else(|| "no folder".to_owned(), |place| place.display().to_string());
    if file.is_none() {
        return format!("none; {place} would be read");
    }
    let set: Vec<String> =
        config.settings.iter().map(|Setting { parameter, value }| format!("{}={value}", parameter.name())).collect();
    if set.is_empty() { place } else { format!("{place}: {}", set.join(" ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_the_file_can_say() {
        let text = "threads = 3\n[set]\nkmax = 200\nnormalisation = \"log\"\n[screen]\nground = \"light\"\n\
                    colours = \"many\"\nascii = true\nmouse = true\ngraphics = \"none\"\nlog = \"l\"\n[cache]\n\
                    dir = \"/c\"\nlimit = \"4G\"\n";
        let config = read(text).unwrap();
        assert_eq!((config.threads, config.cache.most, config.screen.mouse), (Some(3), Some(4 << 30), true));
        let pairs: Vec<_> = config.settings.iter().map(|set| (set.parameter, set.value.as_str())).collect();
        assert_eq!(pairs, [(Parameter::Kmax, "200"), (Parameter::Normalisation, "log")]);
        let look = config.look(Look::default());
        assert!(look.light && look.ascii && look.colour && look.shades == Shades::Many);
        assert!(!config.look(Look { colour: false, ..Look::default() }).colour, "NO_COLOR holds");
        assert_eq!(read("").unwrap(), Config::default());
    }

    #[test]
    fn an_error_names_its_line() {
        let error = |text: &str| read(text).unwrap_err();
        assert!(error("threads = 3\nthread = 4\n").starts_with(":2: unknown field `thread`"), "{}", error("a = 1"));
        assert!(error("\n[set]\nT = 0\n").starts_with(":3: T takes a number from 1 to 1000"));
        assert!(error("[set]\n\nkmx = 3").starts_with(":3: there is no parameter \"kmx\""));
        assert!(error("[screen]\nground = \"grey\"").starts_with(":2: unknown variant `grey`"));
        assert!(error("[cache]\nlimit = \"much\"").starts_with(":2: "));
        assert!(error("[set]\nclass = 3").contains("depends on the data set"));
        assert!(error("threads = 0").starts_with(":1: "));
        assert!(error("x = [").starts_with(":1: "));
    }
}
