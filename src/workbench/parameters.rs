//! What the screen knows of parameters beyond their values: steps, ranges, what turning one costs.

use crate::query::{Parameter, Settings, Stage};

/// Parameters by what turning one costs, the dearest first; the panel shows them in these groups.
pub const GROUPS: [(&str, &[Parameter]); 4] = [
    (
        "spectra",
        &[
            Parameter::Remesh,
            Parameter::Operator,
            Parameter::Mass,
            Parameter::Boundary,
            Parameter::Triangulation,
            Parameter::Kmax,
        ],
    ),
    ("features", &[Parameter::Normalisation, Parameter::Weights, Parameter::Distance]),
    ("selection", &[Parameter::Search, Parameter::Weak, Parameter::Stop]),
    ("read off", &[Parameter::K, Parameter::Rounds, Parameter::Cost, Parameter::Sel, Parameter::Class]),
];

/// All parameters in the order of the panel.
pub fn in_order() -> impl DoubleEndedIterator<Item = Parameter> + Clone {
    GROUPS.into_iter().flat_map(|(_, parameters)| parameters.iter().copied())
}

/// The key that chooses a parameter; it is a letter of its name.
#[must_use]
pub const fn letter(parameter: Parameter) -> char {
    match parameter {
        Parameter::Remesh => 'h',
        Parameter::Operator => 'o',
        Parameter::Mass => 'm',
        Parameter::Boundary => 'y',
        Parameter::Triangulation => 'i',
        Parameter::Kmax => 'x',
        Parameter::Normalisation => 'n',
        Parameter::Weights => 'G',
        Parameter::Distance => 'd',
        Parameter::Search => 'H',
        Parameter::Weak => 'K',
        Parameter::Stop => 'O',
        Parameter::K => 'k',
        Parameter::Rounds => 't',
        Parameter::Cost => 'c',
        Parameter::Sel => 's',
        Parameter::Class => 'l',
    }
}

/// How far a number moves with one step and with one big step; words move by one.
#[must_use]
pub const fn steps(parameter: Parameter) -> (isize, isize) {
    match parameter {
        Parameter::Remesh => (1000, 10_000),
        Parameter::Kmax => (10, 100),
        Parameter::K | Parameter::Rounds => (1, 10),
        Parameter::Class => (1, 5),
        _ => (1, 1),
    }
}

/// The least and greatest number that makes sense now; k is read off curves that end at kmax. `(0, 0)` for words.
#[must_use]
pub const fn range(parameter: Parameter, settings: &Settings, classes: usize) -> (usize, usize) {
    match parameter {
        Parameter::K => (1, settings.kmax),
        _ => parameter.range(classes),
    }
}

/// The stages whose values change with a parameter.
#[must_use]
pub const fn invalidates(parameter: Parameter) -> &'static [Stage] {
    const FEATURES: &[Stage] =
        &[Stage::Features, Stage::FirstK, Stage::ClimbError, Stage::ClimbAdr, Stage::Boost, Stage::Tables];
    const SPECTRA: &[Stage] = &[
        Stage::Spectrum,
        Stage::Features,
        Stage::FirstK,
        Stage::ClimbError,
        Stage::ClimbAdr,
        Stage::Boost,
        Stage::Tables,
    ];
    match parameter {
        Parameter::Remesh
        | Parameter::Operator
        | Parameter::Mass
        | Parameter::Boundary
        | Parameter::Triangulation
        | Parameter::Kmax => SPECTRA,
        Parameter::Normalisation | Parameter::Weights => FEATURES,
        Parameter::Distance => &[Stage::FirstK, Stage::ClimbError, Stage::ClimbAdr, Stage::Tables],
        Parameter::K | Parameter::Sel => &[Stage::Tables],
        Parameter::Search => &[Stage::ClimbError, Stage::ClimbAdr, Stage::Tables],
        Parameter::Weak | Parameter::Stop | Parameter::Rounds => &[Stage::Boost, Stage::Tables],
        Parameter::Cost | Parameter::Class => &[],
    }
}

/// What turning a parameter costs, in a few words.
#[must_use]
pub const fn price(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Remesh => "re-meshes and solves what is not stored",
        Parameter::Operator | Parameter::Mass | Parameter::Boundary | Parameter::Triangulation => {
            "solves every spectrum that is not stored"
        }
        Parameter::Kmax => "greater: solves the bands above; smaller: a slice",
        Parameter::Normalisation | Parameter::Weights => "features and selections anew; no spectra",
        Parameter::Distance => "first-k and hill climbing anew; not AdaBoost",
        Parameter::Search => "hill climbing anew",
        Parameter::Weak | Parameter::Stop => "AdaBoost anew",
        Parameter::K => "nothing: read off the curves",
        Parameter::Rounds => "a slice of AdaBoost's run, or further rounds",
        Parameter::Cost | Parameter::Sel | Parameter::Class => "nothing: another view of the same",
    }
}

/// The full word or number that the typed `text` means for a parameter.
///
/// Words may be cut short as long as one choice is left; a class may be given by its name or the name's beginning.
///
/// # Errors
/// A line that says what the parameter takes.
pub fn parse(parameter: Parameter, text: &str, settings: &Settings, classes: &[String]) -> Result<String, String> {
    let text = text.trim();
    let (least, greatest) = range(parameter, settings, classes.len());
    let begins = |word: &str| word.to_lowercase().starts_with(&text.to_lowercase());
    if parameter.choices().is_empty() {
        if let Ok(number) = text.parse::<usize>()
            && (least..=greatest).contains(&number)
        {
            return Ok(number.to_string());
        }
        if parameter == Parameter::Remesh && !text.is_empty() && "original".starts_with(&text.to_lowercase()) {
            return Ok("original".to_owned());
        }
        if parameter == Parameter::Class && !text.is_empty() {
            let exact = classes.iter().position(|class| class.eq_ignore_ascii_case(text));
            if let Some(at) = exact.or_else(|| classes.iter().position(|class| begins(class))) {
                return Ok((at + 1).to_string());
            }
        }
        let also = match parameter {
            Parameter::Class => " or a class's name",
            Parameter::K => " (kmax)",
            Parameter::Remesh => ", or original",
            _ => "",
        };
        return Err(format!("{} takes a number from {least} to {greatest}{also}", parameter.name()));
    }
    let mut fitting = parameter.choices().iter().filter(|choice| begins(choice));
    match (fitting.next(), fitting.next()) {
        (Some(choice), None) => Ok((*choice).to_owned()),
        (Some(choice), Some(_)) if choice.eq_ignore_ascii_case(text) => Ok((*choice).to_owned()),
        _ => Err(format!("{} takes {}", parameter.name(), parameter.choices().join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(parsed: Result<String, String>) -> String {
        parsed.map_or_else(|message| message, |value| format!("= {value}"))
    }

    #[test]
    fn the_groups_hold_every_parameter_once() {
        let mut grouped: Vec<_> = in_order().collect();
        assert_eq!(grouped.len(), Parameter::ALL.len());
        grouped.sort_unstable();
        grouped.dedup();
        assert_eq!(grouped.len(), Parameter::ALL.len());
    }

    #[test]
    fn a_parameters_letter_is_in_its_name_and_its_own() {
        for parameter in Parameter::ALL {
            let letter_in = letter(parameter).to_ascii_lowercase();
            assert!(parameter.name().to_lowercase().contains(letter_in), "{}", parameter.name());
            let sharing = Parameter::ALL.into_iter().filter(|other| letter(*other) == letter(parameter)).count();
            assert_eq!(sharing, 1, "{}", letter(parameter));
        }
    }

    #[test]
    fn words_may_be_cut_short() {
        let settings = Settings::default();
        let parse = |parameter, text| said(parse(parameter, text, &settings, &[]));
        assert_eq!(parse(Parameter::Normalisation, " WE "), "= weyl");
        assert_eq!(parse(Parameter::Distance, "l"), "distance takes l2, l1, chi2, wesd1.5, wesd2");
        assert_eq!(parse(Parameter::Distance, "l1"), "= l1");
        assert_eq!(parse(Parameter::Operator, ""), "operator takes fem, cot");
        assert_eq!(parse(Parameter::Mass, "lumpy"), "mass takes consistent, lumped, blended");
    }

    #[test]
    fn numbers_are_held_to_their_range() {
        let settings = Settings { kmax: 100, ..Settings::default() };
        let parse = |parameter, text| said(parse(parameter, text, &settings, &[]));
        assert_eq!(parse(Parameter::K, "100"), "= 100");
        assert_eq!(parse(Parameter::K, "101"), "k takes a number from 1 to 100 (kmax)");
        assert_eq!(parse(Parameter::Rounds, "0"), "T takes a number from 1 to 1000");
        assert_eq!(parse(Parameter::Rounds, "-3"), "T takes a number from 1 to 1000");
        assert_eq!(parse(Parameter::Rounds, "99999999999999999999999"), parse(Parameter::Rounds, "x"));
    }

    #[test]
    fn a_class_is_known_by_number_and_by_name() {
        let classes = ["human", "humanoid", "ant"].map(str::to_owned);
        let parse = |text| said(parse(Parameter::Class, text, &Settings::default(), &classes));
        assert_eq!(parse("2"), "= 2");
        assert_eq!(parse("human"), "= 1");
        assert_eq!(parse("HUMANO"), "= 2");
        assert_eq!(parse("a"), "= 3");
        assert_eq!(parse("bird"), "class takes a number from 1 to 3 or a class's name");
        assert!(!parse("").starts_with("= "));
    }

    #[test]
    fn what_is_parsed_can_be_set() {
        let classes = ["human".to_owned()];
        for parameter in Parameter::ALL {
            let mut settings = Settings::default();
            let value = settings.get(parameter);
            let parsed = parse(parameter, &value, &settings, &classes).unwrap();
            settings.set(parameter, &parsed, 1).unwrap();
            assert_eq!(settings, Settings::default());
        }
    }
}
