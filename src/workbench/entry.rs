//! A line of text being typed: the value of a parameter, a name, a search.

/// The longest text that is taken.
const LONGEST: usize = 200;

/// Text with a caret, and what is wrong with it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Entry {
    text: Vec<char>,
    caret: usize,
    /// Why the text was not taken, until it changes.
    pub error: Option<String>,
}

impl Entry {
    /// An entry that holds a text already, the caret at its end.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let mut entry = Self::default();
        text.chars().for_each(|character| entry.insert(character));
        entry
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> String {
        self.text.iter().collect()
    }

    /// The text before and after the caret.
    #[must_use]
    pub fn parts(&self) -> (String, String) {
        let (before, after) = self.text.split_at(self.caret);
        (before.iter().collect(), after.iter().collect())
    }

    /// Types a character; control characters and what is too long are not taken.
    pub fn insert(&mut self, character: char) {
        if !character.is_control() && self.text.len() < LONGEST {
            self.text.insert(self.caret, character);
            self.caret += 1;
            self.error = None;
        }
    }

    /// Deletes the character before the caret. Says whether there was one.
    pub fn erase(&mut self) -> bool {
        let erased = self.caret > 0;
        if erased {
            self.caret -= 1;
            self.text.remove(self.caret);
            self.error = None;
        }
        erased
    }

    /// Deletes everything before the caret.
    pub fn erase_all(&mut self) {
        self.text.drain(..self.caret);
        self.caret = 0;
        self.error = None;
    }

    /// Moves the caret.
    pub fn shift(&mut self, by: isize) {
        self.caret = self.caret.saturating_add_signed(by).min(self.text.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_and_erasing_happen_at_the_caret() {
        let mut entry = Entry::default();
        "15λ0".chars().for_each(|c| entry.insert(c));
        entry.shift(-1);
        assert!(entry.erase());
        assert_eq!(entry.parts(), ("15".to_owned(), "0".to_owned()));
        entry.shift(-9);
        assert!(!entry.erase());
        entry.shift(9);
        entry.insert('\u{1b}');
        assert_eq!(entry.text(), "150");
        entry.erase_all();
        assert_eq!(entry.text(), "");
    }

    #[test]
    fn an_endless_paste_is_cut() {
        let mut entry = Entry::default();
        (0..10_000).for_each(|_| entry.insert('9'));
        assert_eq!(entry.text().len(), LONGEST);
    }

    #[test]
    fn typing_clears_the_error() {
        let mut entry = Entry { error: Some("no".to_owned()), ..Entry::default() };
        entry.insert('1');
        assert_eq!(entry.error, None);
    }
}
