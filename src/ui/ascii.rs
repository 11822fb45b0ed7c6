//! The frame in plain ASCII, for terminals and fonts that have nothing else.

use ratatui::buffer::Buffer;

/// Replaces every character that is not ASCII. What has no likeness becomes `?`.
pub(super) fn plain(buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        if !cell.symbol().is_ascii() {
            let character = cell.symbol().chars().next().unwrap_or(' ');
            cell.set_char(likeness(character));
        }
    }
}

const fn likeness(character: char) -> char {
    match character {
        '─' | '–' | '−' | '—' => '-',
        '│' | '┊' | '▏' | '▕' => '|',
        '┬' | '┴' | '├' | '┤' | '└' | '┘' | '┌' | '┐' | '┼' | '╭' | '╮' | '╰' | '╯' | '✓' => {
            '+'
        }
        '█' | '━' | '▉' | '▊' | '▓' => '#',
        '▋' | '▌' | '▒' => '=',
        '▍' | '▎' | '░' | '·' | '┅' => '.',
        '▸' | '›' | '→' | '⟩' | '≥' => '>',
        '‹' | '←' | '⟨' | '≤' => '<',
        '↑' | '▲' => '^',
        '↓' | '▽' | '▼' => 'v',
        '●' => '@',
        '•' | '◆' => '*',
        '○' | '◌' => 'o',
        '◐' => '%',
        '×' | '✗' => 'x',
        '…' => '~',
        'ε' => 'e',
        'λ' => 'l',
        'α' => 'a',
        'π' => 'p',
        'Σ' => 'S',
        'ᵀ' => 'T',
        _ => '?',
    }
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;

    use super::*;

    #[test]
    fn nothing_but_ascii_is_left() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 12, 1));
        buffer.set_string(0, 0, "ε 0.2 │ 象⣿é", ratatui::style::Style::new());
        plain(&mut buffer);
        let row: String = buffer.content.iter().map(ratatui::buffer::Cell::symbol).collect();
        assert_eq!(row, "e 0.2 | ? ??");
    }
}
