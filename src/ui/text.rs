//! Text from outside made safe, and cut to the width it may take.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Columns that a text takes.
pub(super) fn width(text: &str) -> usize {
    UnicodeWidthStr::width(text)
}

/// A text from a file's name or content, safe to print: whatever a terminal could take for a command, or that would
/// change the direction or the place of other text, becomes a replacement character.
#[must_use]
pub fn clean(text: &str) -> String {
    let mut before = 1;
    let mut kept = |c: char| {
        // One accent on a letter is writing; a tower of them reaches into other lines.
        let wide = c.width().unwrap_or(1);
        let kept = wide > 0 || before > 0;
        before = wide;
        kept
    };
    text.chars().map(|c| if harmless(c) { c } else { '\u{fffd}' }).filter(|c| kept(*c)).collect()
}

/// The names of keys in a terminal's own characters: arrows become words where there is only ASCII.
pub(super) fn keys(label: &str, ascii: bool) -> String {
    if !ascii {
        return label.to_owned();
    }
    let words = label.replace("←→↑↓", "Arrows").replace("←→", "Left/Right").replace("↑↓", "Up/Down");
    words.replace('←', "Left").replace('→', "Right").replace('↑', "Up").replace('↓', "Down")
}

/// Characters that take the columns that they say they take, and do nothing else.
fn harmless(character: char) -> bool {
    let invisible = matches!(character,
        '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
        | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}');
    !character.is_control() && !invisible
}

/// Cleans a text and cuts it to at most `columns`, with an ellipsis where something is missing.
pub(super) fn fit(text: &str, columns: usize) -> String {
    let text = clean(text);
    if width(&text) <= columns {
        return text;
    }
    let mut kept = String::new();
    let mut used = 0;
    for character in text.chars() {
        let wide = character.width().unwrap_or(0);
        if used + wide + 1 > columns {
            break;
        }
        used += wide;
        kept.push(character);
    }
    if columns > 0 {
        kept.push('…');
    }
    kept
}

/// As [`fit`], but keeps the end, which tells paths apart.
pub(super) fn fit_end(text: &str, columns: usize) -> String {
    let text = clean(text);
    if width(&text) <= columns {
        return text;
    }
    let mut kept = Vec::new();
    let mut used = 0;
    for character in text.chars().rev() {
        let wide = character.width().unwrap_or(0);
        if used + wide + 1 > columns {
            break;
        }
        used += wide;
        kept.push(character);
    }
    let ellipsis = if columns > 0 { "…" } else { "" };
    ellipsis.chars().chain(kept.into_iter().rev()).collect()
}

/// Fits a text and fills it up to exactly `columns` on its right.
pub(super) fn left(text: &str, columns: usize) -> String {
    let mut text = fit(text, columns);
    text.extend(std::iter::repeat_n(' ', columns.saturating_sub(width(&text))));
    text
}

/// Fits a text and fills it up to exactly `columns` on its left.
pub(super) fn right(text: &str, columns: usize) -> String {
    let text = fit(text, columns);
    let gap = " ".repeat(columns.saturating_sub(width(&text)));
    gap + &text
}

/// Breaks a text into lines of at most `columns`, between words where it can.
pub(super) fn wrap(text: &str, columns: usize) -> Vec<String> {
    let text = clean(text);
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let mut word = word;
        loop {
            let gap = usize::from(!line.is_empty());
            if width(&line) + gap + width(word) <= columns {
                if gap == 1 {
                    line.push(' ');
                }
                line.push_str(word);
                break;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
                continue;
            }
            let cut = head(word, columns.max(1));
            lines.push(word[..cut].to_owned());
            word = &word[cut..];
            if word.is_empty() {
                break;
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// Bytes of the longest beginning of `word` that takes at most `columns`, but at least one character.
fn head(word: &str, columns: usize) -> usize {
    let mut used = 0;
    for (at, character) in word.char_indices() {
        used += character.width().unwrap_or(0);
        if used > columns && at > 0 {
            return at;
        }
    }
    word.len()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn commands_and_overrides_do_not_get_through() {
        for hostile in
            ["\u{1b}[2J", "a\u{7}b", "a\nb\tc", "\u{9b}31m", "x\u{202e}fdp.exe", "zero\u{200b}width", "\u{feff}a"]
        {
            let safe = clean(hostile);
            assert!(safe.chars().all(harmless), "{safe:?}");
            assert!(safe.contains('\u{fffd}'));
        }
        assert_eq!(clean("Ünïcode 象 🐘"), "Ünïcode 象 🐘");
        assert_eq!(clean("e\u{301}\u{302}\u{303}a\u{301}"), "e\u{301}a\u{301}");
    }

    #[test]
    fn wide_characters_are_not_halved() {
        assert_eq!(fit("象象象", 6), "象象象");
        assert_eq!(fit("象象象", 5), "象象…");
        assert_eq!(fit("象象象", 4), "象…");
        assert_eq!(left("象象象", 4), "象… ");
        assert_eq!(right("象象象", 4), " 象…");
        assert_eq!(fit_end("data/象/ant", 6), "…/ant");
        assert_eq!(fit("abc", 0), "");
    }

    #[test]
    fn lines_break_between_words_and_long_words_anywhere() {
        assert_eq!(wrap("the quick brown", 9), ["the quick", "brown"]);
        assert_eq!(wrap("abcdefgh ij", 3), ["abc", "def", "gh", "ij"]);
        assert_eq!(wrap("", 5), Vec::<String>::new());
        assert_eq!(wrap("象象", 1), ["象", "象"]);
    }

    proptest! {
        #[test]
        fn a_fitted_text_fits(text in any::<String>(), columns in 0_usize..40) {
            prop_assert!(width(&fit(&text, columns)) <= columns);
            prop_assert!(width(&fit_end(&text, columns)) <= columns);
            prop_assert_eq!(width(&left(&text, columns)), columns);
            prop_assert_eq!(width(&right(&text, columns)), columns);
        }

        #[test]
        fn wrapped_lines_fit(text in any::<String>(), columns in 2_usize..40) {
            for line in wrap(&text, columns) {
                prop_assert!(width(&line) <= columns);
            }
        }
    }
}
