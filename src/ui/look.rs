//! What things look like: roles instead of colours, on the terminal's own sixteen.
//!
//! Cyan and magenta are the two colours that read on dark and on light grounds in every common palette, and they stay
//! apart for the common kinds of colour blindness by their lightness; D and Q differ by their line pattern as well.
//! What is faint uses the attribute, never bright black, which several palettes have made their background.

use ratatui::style::{Color, Modifier, Style};

/// How the terminal can be drawn on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Look {
    /// Colours may be used.
    pub colour: bool,
    /// Only ASCII may be used.
    pub ascii: bool,
    /// How many colours there are for shades, where colours may be used.
    pub shades: Shades,
    /// The ground is known to be light.
    pub light: bool,
}

/// How many colours there are beyond the terminal's sixteen. They are used for pictures of shapes alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shades {
    /// None.
    #[default]
    Few,
    /// The palette of 256.
    Many,
    /// All of them.
    All,
}

impl Default for Look {
    fn default() -> Self {
        Self { colour: true, ascii: false, shades: Shades::Few, light: false }
    }
}

/// What something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Plain,
    Strong,
    Faint,
    /// What the keys act on.
    Chosen,
    /// The letter that chooses something.
    Letter,
    /// On the training models D.
    Train,
    /// On the query models Q.
    Query,
    Good,
    Warn,
    Bad,
    /// The class of this place in a list of classes.
    Class(usize),
}

/// A mark for each class of Figure 4, in Unicode and in ASCII; they repeat after these.
const MARKS: [(char, char); 8] =
    [('×', 'x'), ('○', 'o'), ('□', '#'), ('△', '^'), ('◇', '%'), ('+', '+'), ('▽', 'v'), ('•', '*')];

impl Look {
    /// The style of a role.
    pub(super) fn style(self, role: Role) -> Style {
        let style = Style::new();
        let (style, colour) = match role {
            Role::Plain => (style, None),
            Role::Strong => (style.add_modifier(Modifier::BOLD), None),
            Role::Faint => (style.add_modifier(Modifier::DIM), None),
            Role::Chosen => (style.add_modifier(Modifier::REVERSED), None),
            Role::Letter => (style.add_modifier(Modifier::UNDERLINED), None),
            Role::Train => (style, Some(Color::Cyan)),
            Role::Query => (style, Some(Color::Magenta)),
            Role::Good => (style, Some(Color::Green)),
            Role::Warn => (style, Some(Color::Yellow)),
            Role::Bad => (style.add_modifier(Modifier::BOLD), Some(Color::Red)),
            Role::Class(place) => (style, Some(CLASSES[place % CLASSES.len()])),
        };
        match colour {
            Some(colour) if self.colour => style.fg(colour),
            _ => style,
        }
    }

    /// The mark of the class at this place in a list of classes.
    pub(super) const fn mark(self, place: usize) -> char {
        let (fine, plain) = MARKS[place % MARKS.len()];
        if self.ascii { plain } else { fine }
    }
}

const CLASSES: [Color; 6] = [Color::Cyan, Color::Magenta, Color::Yellow, Color::Green, Color::Red, Color::Blue];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_colour_there_is_none() {
        let look = Look { colour: false, ..Look::default() };
        for role in [Role::Train, Role::Query, Role::Good, Role::Warn, Role::Bad, Role::Class(3)] {
            assert_eq!(look.style(role).fg, None);
            assert_ne!(Look::default().style(role).fg, None);
        }
        assert_eq!(look.style(Role::Bad).add_modifier, Modifier::BOLD);
    }

    #[test]
    fn neighbouring_classes_have_different_marks() {
        for place in 0..20 {
            assert_ne!(Look::default().mark(place), Look::default().mark(place + 1));
        }
    }
}
