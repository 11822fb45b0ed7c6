//! A session as a file that a person can read: parameters, pins, and what was looked at.
//!
//! ```toml
//! # A recipe of eigenselect: tui DATA --recipe FILE, tui report DATA --recipe FILE
//! version = 1
//!
//! [set]
//! kmax = 500
//! normalisation = "max"
//!
//! [screen]
//! view = "Curves"
//!
//! [[pin]]
//! letter = "A"
//! set = { T = 20 }
//! ```
//!
//! `set` names every parameter, so that a recipe gives the same figures when defaults change; a parameter that this
//! version does not know is an error, not a surprise.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Figures, Pin, State, View, parameters, shape};
use crate::{
    query::{Parameter, Settings},
    study::Method,
};

/// The version that is written.
const VERSION: u32 = 1;
/// The first line of the file.
const HEAD: &str = "# A recipe of eigenselect: tui DATA --recipe FILE, tui report DATA --recipe FILE\n";

/// What a recipe cannot be read for.
#[derive(Debug, thiserror::Error)]
pub enum RecipeError {
    /// It is not TOML, or has an entry that is not known.
    #[error("{0}")]
    Syntax(String),
    /// It was written by a later version.
    #[error("version {0} of recipes is not known to this program, which writes version {VERSION}")]
    Version(u32),
    /// A parameter does not exist or does not take the value.
    #[error("{place}: {reason}")]
    Value {
        /// Where in the file.
        place: String,
        /// What is wrong.
        reason: String,
    },
}

/// A value as TOML has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum Value {
    Number(u64),
    Word(String),
}

type Set = BTreeMap<String, Value>;

/// The file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recipe {
    version: u32,
    #[serde(default)]
    set: Set,
    #[serde(default)]
    screen: Screen,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pin: Vec<Put>,
}

/// What was looked at.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Screen {
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<Method>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    logarithmic: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<[i32; 3]>,
}

/// A pin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Put {
    letter: char,
    set: Set,
}

fn set_of(settings: &Settings) -> Set {
    let value = |parameter: Parameter| {
        let text = settings.get(parameter);
        text.parse().map_or_else(|_| Value::Word(text), Value::Number)
    };
    Parameter::ALL.into_iter().map(|parameter| (parameter.name().to_owned(), value(parameter))).collect()
}

/// Sets what is named upon `first`.
fn settings_of(set: &Set, first: &Settings, place: &str, classes: usize) -> Result<Settings, RecipeError> {
    let mut settings = first.clone();
    for (name, value) in set {
        let wrong = |reason: String| RecipeError::Value { place: format!("{place}.{name}"), reason };
        let parameter = Parameter::named(name).ok_or_else(|| {
            let names: Vec<&str> = parameters::in_order().map(Parameter::name).collect();
            wrong(format!("no such parameter; there are {}", names.join(", ")))
        })?;
        let text = match value {
            Value::Number(number) => number.to_string(),
            Value::Word(word) => word.clone(),
        };
        settings.set(parameter, &text, classes).map_err(wrong)?;
    }
    Ok(settings)
}

/// The state as a recipe.
///
/// # Errors
/// A line that says why it cannot be written as TOML; this does not happen.
pub fn write(state: &State) -> Result<String, String> {
    let recipe = Recipe {
        version: VERSION,
        set: set_of(&state.settings),
        screen: Screen {
            view: Some(state.view.name().to_owned()),
            method: Some(state.why.method),
            parameter: Some(state.parameter.name().to_owned()),
            logarithmic: Some(state.logarithmic),
            camera: Some([state.camera.yaw, state.camera.pitch, state.camera.zoom]),
        },
        pin: state.pins.iter().map(|pin| Put { letter: pin.letter, set: set_of(&pin.settings) }).collect(),
    };
    toml::to_string(&recipe).map(|text| HEAD.to_owned() + &text).map_err(|error| error.to_string())
}

/// A recipe that was read and found to be in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The parameters.
    pub settings: Settings,
    screen: Screen,
    pins: Vec<(char, Settings)>,
}

/// Reads a recipe; what it does not set stays as in `first`. `classes` is how many there are.
///
/// # Errors
/// [`RecipeError`], which names the place in the file.
pub fn read(text: &str, first: &Settings, classes: usize) -> Result<Loaded, RecipeError> {
    let recipe: Recipe = toml::from_str(text).map_err(|error| RecipeError::Syntax(said(text, &error)))?;
    if recipe.version != VERSION {
        return Err(RecipeError::Version(recipe.version));
    }
    let settings = settings_of(&recipe.set, first, "set", classes)?;
    let pin = |(place, put): (usize, &Put)| {
        let place = format!("pin[{place}].set");
        Ok((put.letter, settings_of(&put.set, first, &place, classes)?))
    };
    let pins: Vec<(char, Settings)> = recipe.pin.iter().enumerate().map(pin).collect::<Result<_, RecipeError>>()?;
    let known = |letter: char| ('A'..).take(super::pins::MOST).any(|other| other == letter);
    if let Some(at) = pins.iter().position(|(letter, _)| !known(*letter)) {
        let reason = "pins are called A to E".to_owned();
        return Err(RecipeError::Value { place: format!("pin[{at}].letter"), reason });
    }
    Ok(Loaded { settings, screen: recipe.screen, pins })
}

/// An error in one line, with its place.
fn said(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map(|span| text.bytes().take(span.start).filter(|byte| *byte == b'\n').count() + 1);
    let message = error.message().replace('\n', " ");
    line.map_or_else(|| message.clone(), |line| format!("line {line}: {message}"))
}

impl Loaded {
    /// True when there is something in it that the state does not have.
    #[must_use]
    pub fn differs(&self, state: &State) -> bool {
        self.settings != state.settings || !self.pins.is_empty()
    }

    /// Puts everything but the parameters, which the engine is told of, on the screen.
    pub fn show(self, state: &mut State) {
        let Screen { view, method, parameter, logarithmic, camera } = self.screen;
        let named = |name: String| View::ALL.into_iter().find(|view| view.name().eq_ignore_ascii_case(&name));
        state.view = view.and_then(named).unwrap_or(state.view);
        state.why.method = method.unwrap_or(state.why.method);
        state.parameter = parameter.and_then(|name| Parameter::named(&name)).unwrap_or(state.parameter);
        state.logarithmic = logarithmic.unwrap_or(state.logarithmic);
        if let Some([yaw, pitch, zoom]) = camera {
            state.camera = shape::Camera { yaw: 0, pitch: 0, zoom: 0 };
            state.camera.turn(yaw, pitch);
            state.camera.approach(zoom);
        }
        state.pins = self
            .pins
            .into_iter()
            .map(|(letter, settings)| Pin { letter, settings, figures: Figures::default() })
            .collect();
        state.pins.sort_by_key(|pin| pin.letter);
        state.pins.dedup_by_key(|pin| pin.letter);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pinned() -> State {
        let mut state = State::new("data", Settings::default());
        super::super::pins::pin(&mut state).unwrap();
        state.settings.rounds = 60;
        state.settings.class = 2;
        state.view = View::Confusion;
        state.why.method = Method::ClimbAdr;
        state.camera.turn(-4, 3);
        state
    }

    #[test]
    fn what_is_written_is_read_back() {
        let state = pinned();
        let text = write(&state).unwrap();
        let loaded = read(&text, &Settings::default(), 3).unwrap();
        assert_eq!(loaded.settings, state.settings);
        let mut other = State::new("data", loaded.settings.clone());
        loaded.show(&mut other);
        assert_eq!((other.view, other.why.method, other.camera), (state.view, state.why.method, state.camera));
        let pins = |state: &State| state.pins.iter().map(|p| (p.letter, p.settings.clone())).collect::<Vec<_>>();
        assert_eq!(pins(&other), pins(&state));
        assert_eq!(write(&other).unwrap(), text);
    }

    #[test]
    fn every_parameter_is_named() {
        let text = write(&pinned()).unwrap();
        for parameter in Parameter::ALL {
            assert!(text.contains(&format!("{} = ", parameter.name())), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let says = |text: &str| read(text, &Settings::default(), 3).unwrap_err().to_string();
        assert!(says("version = 2").starts_with("version 2 of recipes"));
        assert!(
            says("version = 1\n[set]\nkmx = 3").starts_with("set.kmx: no such parameter; there are remesh, operator")
        );
        assert_eq!(says("version = 1\n[set]\nclass = 4"), "set.class: class takes a number from 1 to 3, not \"4\"");
        assert!(says("version = 1\nflavour = 3").starts_with("line 2: unknown field `flavour`"));
        assert!(says("version = ").starts_with("line 1: "));
        assert!(says("version = 1\n[[pin]]\nletter = \"Z\"\nset = {}").starts_with("pin[0].letter: "));
        assert!(says("").contains("version"));
    }

    #[test]
    fn what_is_not_set_stays() {
        let first = Settings { kmax: 33, ..Settings::default() };
        let loaded = read("version = 1\n[set]\nT = 7\ndistance = \"L1\"", &first, 1).unwrap();
        assert_eq!((loaded.settings.kmax, loaded.settings.rounds), (33, 7));
        assert_eq!(loaded.settings.get(Parameter::Distance), "l1");
    }
}
