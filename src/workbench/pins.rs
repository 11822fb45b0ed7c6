//! Settings put aside to compare the present ones with, and sweeps over one parameter.

use super::{Figures, State, Trial, experiment};
use crate::{
    query::{Finding, Parameter, Question, Reply, Settings},
    study::Method,
};

pub use self::tables::{against, tables};

mod tables;

/// The most pins.
pub const MOST: usize = 5;

/// Settings that were put aside, and their figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Pin {
    /// Its name, A to E.
    pub letter: char,
    /// The parameters.
    pub settings: Settings,
    /// The figures, as far as they are there.
    pub figures: Figures,
}

/// ε of a method on D and on Q, its mean ADR on D and on Q, of a pin.
#[must_use]
pub fn scores(pin: &Pin, method: Method) -> [Option<f64>; 4] {
    pin.figures.scores(method, &pin.settings)
}

/// A sweep over one parameter, as it fills.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The parameter.
    pub parameter: Parameter,
    /// Its values as text, in order.
    pub values: Vec<String>,
    /// The settings of each value.
    pub settings: Vec<Settings>,
    /// The figures of each value, as far as they are there.
    pub figures: Vec<Option<Figures>>,
}

impl Sweep {
    /// Values of a parameter from the settings as they are: every word, or numbers that spread over the range.
    #[must_use]
    pub fn over(parameter: Parameter, settings: &Settings, classes: usize) -> Self {
        let (least, greatest) = super::parameters::range(parameter, settings, classes);
        let words: Vec<String> = parameter.choices().iter().map(|choice| (*choice).to_owned()).collect();
        // Spectra have no more eigenvalues than were asked for; beyond, a sweep would be a day's solving.
        let greatest = if parameter == Parameter::Kmax { settings.kmax } else { greatest };
        let values = if words.is_empty() { spread(least, greatest) } else { words };
        let of = |value: &String| {
            let mut settings = settings.clone();
            settings.set(parameter, value, classes).ok().map(|()| (value.clone(), settings))
        };
        let (values, settings): (Vec<String>, Vec<Settings>) = values.iter().filter_map(of).unzip();
        let figures = vec![None; values.len()];
        Self { parameter, values, settings, figures }
    }

    /// Takes in a trial; says whether it was one of the sweep's.
    pub fn take(&mut self, trial: &Trial) -> bool {
        let at = self.settings.iter().position(|settings| *settings == trial.settings);
        if let Some(at) = at {
            self.figures[at] = Some(trial.figures.clone());
        }
        at.is_some()
    }

    /// How many values have their figures.
    #[must_use]
    pub fn done(&self) -> usize {
        self.figures.iter().flatten().count()
    }
}

/// 1, 2, 5, 10, 20, … within the range, with its ends, as text.
fn spread(least: usize, greatest: usize) -> Vec<String> {
    let round = (0..9).flat_map(|power| [1, 2, 3, 5, 7].map(|digit| digit * 10_usize.pow(power)));
    let mut values: Vec<usize> =
        round.filter(|value| (least..=greatest).contains(value)).chain([least, greatest]).collect();
    values.sort_unstable();
    values.dedup();
    values.into_iter().map(|value| value.to_string()).collect()
}

/// The parameters in which pins or the present settings differ, with the value in each: now, then the pins.
#[must_use]
pub fn differing(state: &State) -> Vec<(Parameter, Vec<String>)> {
    let of = |parameter: Parameter| {
        let all = std::iter::once(&state.settings).chain(state.pins.iter().map(|pin| &pin.settings));
        let values: Vec<String> = all.map(|settings| settings.get(parameter)).collect();
        values.iter().any(|value| *value != values[0]).then_some((parameter, values))
    };
    super::parameters::in_order().filter_map(of).collect()
}

/// The figures of the settings on the screen, with the decisions that are there.
#[must_use]
pub fn present(state: &State) -> Figures {
    let mut figures =
        if state.settings == state.answer.settings { Figures::of(&state.answer) } else { Figures::default() };
    for method in Method::ALL {
        if let Some(reply) = state.replies.find(&Question::Decisions(method)).filter(|reply| !state.outdated(reply)) {
            figures.decided[method as usize] = decided(reply);
        }
    }
    figures
}

fn decided(reply: &Reply) -> Option<super::trial::Decided> {
    match &reply.finding {
        Ok(Finding::Decisions(decisions)) => Some((decisions.clone(), reply.places.clone())),
        _ => None,
    }
}

/// Puts the settings on the screen aside. Says under which letter.
///
/// # Errors
/// A line that says why not: there are five already, or these are one of them.
pub fn pin(state: &mut State) -> Result<char, String> {
    if let Some(pin) = state.pins.iter().find(|pin| pin.settings == state.settings) {
        return Err(format!("these settings are pin {} already", pin.letter));
    }
    let free = ('A'..).take(MOST).find(|letter| state.pins.iter().all(|pin| pin.letter != *letter));
    let letter = free.ok_or_else(|| format!("there are {MOST} pins; Delete in Compare removes one"))?;
    let figures = present(state);
    state.pins.push(Pin { letter, settings: state.settings.clone(), figures });
    state.pins.sort_by_key(|pin| pin.letter);
    Ok(letter)
}

/// Gives the pins of the settings on the screen what has come in for these.
pub fn complete(state: &mut State) {
    if state.pins.iter().any(|pin| pin.settings == state.settings && !pin.figures.complete()) {
        let present = present(state);
        for pin in state.pins.iter_mut().filter(|pin| pin.settings == state.settings) {
            pin.figures = present.clone();
        }
    }
}

/// Settings whose figures are missing and that are not those on the screen: they are tried.
#[must_use]
pub fn untried(state: &State) -> Vec<Settings> {
    // Those of the settings on the screen come with their answers.
    let missing = |pin: &&Pin| !pin.figures.complete() && pin.settings != state.settings;
    let pins = state.pins.iter().filter(missing).map(|pin| pin.settings.clone());
    let swept = state.sweep.iter().flat_map(|sweep| {
        sweep.settings.iter().zip(&sweep.figures).filter(|(_, figures)| figures.is_none()).map(|(s, _)| s.clone())
    });
    pins.chain(swept).chain(experiment::untried(state)).collect()
}

/// Takes in figures under other settings.
pub fn take(state: &mut State, trial: &Trial) {
    for pin in state.pins.iter_mut().filter(|pin| pin.settings == trial.settings) {
        pin.figures = trial.figures.clone();
    }
    if let Some(sweep) = &mut state.sweep {
        sweep.take(trial);
    }
    experiment::take(state, trial);
    state.experiment.trying.take_if(|(settings, ..)| *settings == trial.settings);
}

/// The questions whose answers the comparison shows.
pub(super) fn questions() -> Vec<Question> {
    Method::ALL.into_iter().map(Question::Decisions).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_goes_over_words_and_round_numbers() {
        let settings = Settings { kmax: 40, ..Settings::default() };
        let over = |parameter| Sweep::over(parameter, &settings, 3).values;
        assert_eq!(over(Parameter::Distance), ["l2", "l1", "chi2", "wesd1.5", "wesd2"]);
        assert_eq!(over(Parameter::Kmax), ["1", "2", "3", "5", "7", "10", "20", "30", "40"]);
        assert_eq!(over(Parameter::Rounds).last().unwrap(), "1000");
        assert_eq!(over(Parameter::Class), ["1", "2", "3"]);
        let sweep = Sweep::over(Parameter::Rounds, &settings, 3);
        assert!(sweep.settings.iter().all(|swept| swept.kmax == 40));
    }

    #[test]
    fn pins_have_letters_and_there_are_five_at_most() {
        let mut state = State::new("", Settings::default());
        for (rounds, letter) in (30..).zip('A'..='E') {
            state.settings.rounds = rounds;
            assert_eq!(pin(&mut state), Ok(letter));
            assert!(pin(&mut state).is_err(), "twice the same");
        }
        state.settings.rounds = 99;
        assert!(pin(&mut state).is_err());
        state.pins.remove(1);
        assert_eq!(pin(&mut state), Ok('B'));
        let differing = differing(&state);
        assert_eq!(differing.len(), 1);
        assert_eq!(differing[0], (Parameter::Rounds, ["99", "30", "99", "32", "33", "34"].map(str::to_owned).to_vec()));
    }
}
