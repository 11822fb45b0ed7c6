//! What the terminal can show.

use std::{
    env,
    ffi::OsString,
    io::{self, IsTerminal as _},
};

use super::TerminalError;
use crate::ui::{Look, Shades};

/// What the environment says of the terminal: no colour with `NO_COLOR` (<https://no-color.org>), ASCII where the
/// locale is not UTF-8, more than sixteen colours where `COLORTERM` or `TERM` say so.
#[must_use]
pub fn look() -> Look {
    from(|name| env::var_os(name))
}

fn from(variable: impl Fn(&str) -> Option<OsString>) -> Look {
    let set = |name: &str| variable(name).filter(|value| !value.is_empty());
    // As setlocale(3) reads them: the first one that is set decides.
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(set);
    let locale = locale.map(|locale| locale.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let lower = |name: &str| set(name).map(|value| value.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let shades = match (lower("COLORTERM").as_str(), lower("TERM").as_str()) {
        ("truecolor" | "24bit", _) => Shades::All,
        (_, term) if term.ends_with("-direct") => Shades::All,
        (_, term) if term.contains("256color") => Shades::Many,
        _ => Shades::Few,
    };
    // The last number is the ground's, as rxvt and those after it say it: 7 and 9 to 15 are light.
    let ground = lower("COLORFGBG").rsplit(';').next().and_then(|ground| ground.parse::<u8>().ok());
    Look {
        colour: set("NO_COLOR").is_none(),
        ascii: !(locale.contains("utf-8") || locale.contains("utf8")),
        shades,
        light: ground.is_some_and(|ground| ground == 7 || (9..=15).contains(&ground)),
    }
}

/// True where the terminal says that it shows pictures by kitty's protocol, and nothing stands between it and us that
/// would swallow them.
pub(super) fn kitty() -> bool {
    takes(|name| env::var_os(name))
}

fn takes(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    let lower =
        |name: &str| variable(name).map(|value| value.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let term = lower("TERM");
    let between = !lower("TMUX").is_empty() || !lower("STY").is_empty();
    let known = matches!(term.as_str(), "xterm-kitty" | "xterm-ghostty")
        || matches!(lower("TERM_PROGRAM").as_str(), "wezterm" | "ghostty");
    known && !between && !term.starts_with("tmux") && !term.starts_with("screen")
}

/// Fails where no screen can be drawn.
pub(super) fn require() -> Result<(), TerminalError> {
    if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        return Err(TerminalError::Unfit("the screen needs a terminal on standard input and output".to_owned()));
    }
    match env::var("TERM") {
        Ok(term) if term == "dumb" => {
            Err(TerminalError::Unfit("the terminal cannot place text (TERM=dumb)".to_owned()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(variables: &[(&str, &str)]) -> Look {
        from(|name| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| OsString::from(value)))
    }

    #[test]
    fn the_locale_decides_on_unicode() {
        assert!(with(&[]).ascii);
        assert!(!with(&[("LANG", "de_CH.UTF-8")]).ascii);
        assert!(!with(&[("LANG", "C"), ("LC_CTYPE", "en_US.utf8")]).ascii);
        assert!(with(&[("LANG", "en_US.UTF-8"), ("LC_ALL", "C")]).ascii);
        assert!(!with(&[("LANG", "C.UTF-8"), ("LC_ALL", "")]).ascii, "what is empty is not set");
        assert!(with(&[("LANG", "de_CH.ISO-8859-1")]).ascii);
    }

    #[test]
    fn colours_and_ground_are_taken_from_what_is_set() {
        assert_eq!(with(&[("TERM", "xterm")]).shades, Shades::Few);
        assert_eq!(with(&[("TERM", "tmux-256color")]).shades, Shades::Many);
        assert_eq!(with(&[("TERM", "xterm-256color"), ("COLORTERM", "truecolor")]).shades, Shades::All);
        assert!(with(&[("COLORFGBG", "0;default;15")]).light);
        assert!(!with(&[("COLORFGBG", "15;0")]).light && !with(&[("COLORFGBG", "x")]).light && !with(&[]).light);
    }

    #[test]
    fn pictures_go_to_terminals_that_are_known_to_take_them() {
        let with = |variables: &[(&str, &str)]| {
            takes(|name| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| OsString::from(value)))
        };
        assert!(with(&[("TERM", "xterm-kitty")]) && with(&[("TERM", "xterm-256color"), ("TERM_PROGRAM", "WezTerm")]));
        assert!(!with(&[("TERM", "xterm-256color")]) && !with(&[]));
        assert!(!with(&[("TERM", "tmux-256color"), ("TERM_PROGRAM", "WezTerm")]), "tmux stands between");
        assert!(!with(&[("TERM", "xterm-kitty"), ("TMUX", "/tmp/tmux-0/default,1,0")]));
    }

    #[test]
    fn no_color_is_respected() {
        assert!(with(&[]).colour);
        assert!(with(&[("NO_COLOR", "")]).colour);
        assert!(!with(&[("NO_COLOR", "1")]).colour);
    }
}
