//! Which top-level modules a source file names: every path that starts at the root of the crate.

/// A module of the crate's root that a file names, and in which line.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    pub line: usize,
    pub module: String,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Token {
    Word(String),
    Colons,
    Mark(char),
}

/// The root modules named in `source`, which is a module `depth` levels below the crate's root (`src/a.rs` is one level
/// below). Comments, documentation and literals do not count.
pub fn imports(source: &str, depth: usize) -> Vec<Import> {
    let tokens = tokens(source);
    let word = |i: usize, text: &str| matches!(tokens.get(i), Some((_, Token::Word(word))) if word == text);
    let mark = |i: usize, mark: char| tokens.get(i).is_some_and(|(_, token)| *token == Token::Mark(mark));
    let colons = |i: usize| tokens.get(i).is_some_and(|(_, token)| *token == Token::Colons);

    let mut found = Vec::new();
    // The brace depths at which inline modules were opened: inside each, `super` starts one level lower.
    let (mut braces, mut inline) = (0_usize, Vec::new());
    for i in 0..tokens.len() {
        if mark(i, '{') {
            braces += 1;
            if i >= 2 && word(i - 2, "mod") {
                inline.push(braces);
            }
        } else if mark(i, '}') {
            if inline.last() == Some(&braces) {
                inline.pop();
            }
            braces = braces.saturating_sub(1);
        }
        if i > 0 && colons(i - 1) {
            continue; // The middle of a path.
        }
        // Behind this, a path goes on from the crate's root.
        let mut root = None;
        if word(i, "crate") && colons(i + 1) {
            root = Some(i + 2);
        } else if word(i, "super") || word(i, "self") && colons(i + 1) && word(i + 2, "super") {
            let first = if word(i, "self") { i + 2 } else { i };
            let supers =
                (0..tokens.len()).take_while(|n| word(first + 2 * n, "super") && colons(first + 2 * n + 1)).count();
            if supers == depth + inline.len() {
                root = Some(first + 2 * supers);
            }
        }
        if let Some(next) = root {
            found.extend(heads(&tokens[next..]));
        }
    }
    found.sort();
    found.dedup();
    found
}

/// The first segments of the path, or of every path of the group, that `tokens` start with.
fn heads(tokens: &[(usize, Token)]) -> Vec<Import> {
    let head = |(line, token): &(usize, Token)| match token {
        Token::Word(word) => Some(Import { line: *line, module: word.clone() }),
        _ => None,
    };
    if !matches!(tokens.first(), Some((_, Token::Mark('{')))) {
        return tokens.first().and_then(head).into_iter().collect();
    }
    let (mut depth, mut starts, mut heads) = (0, false, Vec::new());
    for token in tokens {
        match token.1 {
            Token::Mark('{') => {
                depth += 1;
                starts = depth == 1;
            }
            Token::Mark('}') => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            Token::Mark(',') => starts = depth == 1,
            _ => {
                if starts {
                    heads.extend(head(token));
                }
                starts = false;
            }
        }
    }
    heads
}

/// The crates and root modules that paths in `source` start with: `a` of `a::b`, and of `use a as c`.
pub fn roots(source: &str) -> Vec<Import> {
    let tokens = tokens(source);
    let mut found = Vec::new();
    for (i, (line, token)) in tokens.iter().enumerate() {
        let Token::Word(word) = token else { continue };
        let before = i.checked_sub(1).map(|i| &tokens[i].1);
        let after = tokens.get(i + 1).map(|(_, token)| token);
        let used = matches!(before, Some(Token::Word(word)) if word == "use");
        if before != Some(&Token::Colons) && (after == Some(&Token::Colons) || used) {
            found.push(Import { line: *line, module: word.clone() });
        }
    }
    found
}

/// Words, `::` and other marks with their lines; comments and literals are left out.
fn tokens(source: &str) -> Vec<(usize, Token)> {
    let text: Vec<char> = source.chars().collect();
    let at = |i: usize| text.get(i).copied().unwrap_or('\0');
    let (mut tokens, mut i, mut line) = (Vec::new(), 0, 1);
    while i < text.len() {
        let start = i;
        match at(i) {
            '/' if at(i + 1) == '/' => i = end_of_line(&text, i),
            '/' if at(i + 1) == '*' => i = end_of_comment(&text, i),
            '"' => i = end_of_string(&text, i),
            '\'' => i = end_of_quote(&text, i),
            ':' if at(i + 1) == ':' => {
                tokens.push((line, Token::Colons));
                i += 2;
            }
            c if c.is_alphanumeric() || c == '_' => {
                while at(i).is_alphanumeric() || at(i) == '_' {
                    i += 1;
                }
                let word: String = text[start..i].iter().collect();
                let literal = matches!(word.as_str(), "r" | "b" | "c" | "br" | "cr");
                let hashes = (i..text.len()).take_while(|i| at(*i) == '#').count();
                if literal && word.ends_with('r') && at(i + hashes) == '"' {
                    i = end_of_raw(&text, i + hashes, hashes);
                } else if literal && at(i) == '"' {
                    i = end_of_string(&text, i);
                } else if word == "b" && at(i) == '\'' {
                    i = end_of_quote(&text, i);
                } else {
                    tokens.push((line, Token::Word(word)));
                }
            }
            c => {
                if !c.is_whitespace() {
                    tokens.push((line, Token::Mark(c)));
                }
                i += 1;
            }
        }
        line += text[start..i.min(text.len())].iter().filter(|c| **c == '\n').count();
    }
    tokens
}

fn end_of_line(text: &[char], start: usize) -> usize {
    text[start..].iter().position(|c| *c == '\n').map_or(text.len(), |length| start + length)
}

fn end_of_comment(text: &[char], start: usize) -> usize {
    let (mut depth, mut i) = (0, start);
    while i < text.len() {
        match text[i..].get(..2) {
            Some(['/', '*']) => (depth, i) = (depth + 1, i + 2),
            Some(['*', '/']) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

fn end_of_string(text: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < text.len() && text[i] != '"' {
        i += if text[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

fn end_of_raw(text: &[char], quote: usize, hashes: usize) -> usize {
    let mut i = quote + 1;
    while i < text.len() {
        if text[i] == '"' && text[i + 1..].iter().take_while(|c| **c == '#').count() >= hashes {
            return i + 1 + hashes;
        }
        i += 1;
    }
    i
}

/// The end of a character; a lifetime ends after its quote.
fn end_of_quote(text: &[char], start: usize) -> usize {
    match (text.get(start + 1), text.get(start + 2)) {
        (Some('\\'), _) => {
            let mut i = start + 3;
            while i < text.len() && text[i] != '\'' {
                i += 1;
            }
            i + 1
        }
        (Some(_), Some('\'')) => start + 3,
        _ => start + 1,
    }
}

#[cfg(test)]
mod tests {
    use super::{imports, roots};

    fn modules(source: &str, depth: usize) -> Vec<String> {
        imports(source, depth).into_iter().map(|import| import.module).collect()
    }

    #[test]
    fn every_way_to_name_a_module_is_seen() {
        let source = "use crate::mesh;\nuse crate::{spectrum::{a, b as c}, study::*, ui};\nfn f() -> crate::query::X {}\n\
                      pub(crate) fn g(x: &'a u8) { let _ = <crate::store::Y>::new('\\'', b'x'); }\n";
        let seen = imports(source, 1);
        let lines: Vec<_> = seen.iter().map(|import| (import.line, import.module.as_str())).collect();
        assert_eq!(lines, [(1, "mesh"), (2, "spectrum"), (2, "study"), (2, "ui"), (3, "query"), (4, "store")]);
    }

    #[test]
    fn super_reaches_the_root_from_the_right_depth() {
        assert_eq!(modules("use super::mesh; use super::super::x;", 1), ["mesh"]);
        assert_eq!(modules("use super::mesh; use super::super::{ui, cli::x};", 2), ["cli", "ui"]);
        assert_eq!(modules("use self::super::mesh;", 1), ["mesh"]);
        assert_eq!(modules("mod tests { use super::x; use super::super::ui; } use super::mesh;", 1), ["mesh", "ui"]);
        assert_eq!(modules("fn f() { super::mesh::g() }", 1), ["mesh"]);
        assert_eq!(modules("a::super_::b(); let superb = 1;", 1), Vec::<String>::new());
    }

    #[test]
    fn comments_and_literals_are_not_code() {
        let source = "// crate::a\n/* crate::b /* crate::c */ crate::d */ //! crate::e\n\
                      \"crate::f \\\" crate::g\" r#\"crate::h\" crate::i\"# b\"crate::j\" '\"' crate::k::l '\\u{22}' 'x'\n\
                      fn f<'a>(x: &'a str) { crate::m() } br##\"\"# crate::n\"##";
        assert_eq!(modules(source, 1), ["k", "m"]);
    }

    #[test]
    fn roots_are_the_heads_of_paths() {
        let source = "use bincode::config; use salsa as s; let x: std::io::Error = ratatui::init(); // clap::x";
        let found: Vec<_> = roots(source).into_iter().map(|import| import.module).collect();
        assert_eq!(found, ["bincode", "salsa", "std", "ratatui"]);
    }
}
