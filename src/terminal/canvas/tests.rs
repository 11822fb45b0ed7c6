//! A terminal that is told only what the canvas writes shows what was drawn.

use ratatui::{
    Terminal,
    backend::CrosstermBackend,
    buffer::Buffer,
    layout::Rect,
    style::{Color, Style},
};

use super::*;

/// Seeded numbers.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    fn style(&mut self) -> Style {
        const COLOURS: [Color; 8] = [
            Color::Reset,
            Color::Reset,
            Color::Reset,
            Color::Cyan,
            Color::Red,
            Color::LightBlue,
            Color::Indexed(200),
            Color::Rgb(1, 20, 255),
        ];
        let ground = if self.below(5) == 0 { COLOURS[self.below(8) as usize] } else { Color::Reset };
        let kinds = [Modifier::BOLD, Modifier::DIM, Modifier::REVERSED, Modifier::UNDERLINED, Modifier::ITALIC];
        let mut style = Style::new().fg(COLOURS[self.below(8) as usize]).bg(ground);
        for kind in kinds {
            if self.below(6) == 0 {
                style = style.add_modifier(kind);
            }
        }
        style
    }

    /// Words, lines, blanks and wide characters, some of them over each other.
    fn scribble(&mut self, buffer: &mut Buffer, most: u64) {
        const WORDS: [&str; 9] =
            ["λ", "eigenvalue", "                    ", "──────────", "⣿⡇⠁⢀", "象の形", "a", "x y z", "          "];
        let Rect { width, height, .. } = buffer.area;
        for _ in 0..self.below(most) {
            let (x, y) = (self.below(u64::from(width)) as u16, self.below(u64::from(height)) as u16);
            let style = self.style();
            buffer.set_stringn(x, y, WORDS[self.below(9) as usize], (width - x) as usize, style);
        }
        // What was written over the half of a wide character makes no sense: nothing is under it.
        for y in 0..height {
            for x in 0..width {
                // The terminal of the test knows no letters that are bold and dim at once.
                if buffer[(x, y)].modifier.contains(Modifier::BOLD) {
                    buffer[(x, y)].modifier.remove(Modifier::DIM);
                }
                if buffer[(x, y)].symbol().width() == 2 {
                    if x + 1 < width {
                        buffer[(x + 1, y)].reset();
                    } else {
                        buffer[(x, y)].reset();
                    }
                }
            }
        }
    }
}

/// What a terminal shows in a cell: text, colours, attributes; of a blank only what can be seen.
fn seen(screen: &vt100::Screen, row: u16, column: u16) -> Option<(String, String)> {
    let cell = screen.cell(row, column)?;
    if cell.is_wide_continuation() {
        return None;
    }
    let text = if cell.has_contents() { cell.contents().to_owned() } else { " ".to_owned() };
    let ground = cell.bgcolor();
    let look = (cell.inverse(), cell.underline(), ground);
    let fine = (cell.fgcolor(), cell.bold(), cell.dim(), cell.italic());
    // The colour of a reversed blank is its ground.
    let shown = if text == " " && !cell.inverse() { format!("{look:?}") } else { format!("{look:?} {fine:?}") };
    Some((text, shown))
}

/// The canvas and what it wrote, on a screen of its own.
fn canvas(columns: u16, rows: u16) -> (Terminal<Canvas>, Pending) {
    let pending = Pending::default();
    let size = Size::new(columns, rows);
    let canvas = Canvas::new(Pending::clone(&pending), Box::new(move || Ok(size))).unwrap();
    (Terminal::new(canvas).unwrap(), pending)
}

fn screen(columns: u16, rows: u16) -> vt100::Parser {
    let cells = |number| std::num::NonZeroU16::new(number).unwrap();
    vt100::Parser::new(cells(rows), cells(columns), 0)
}

#[test]
fn the_terminal_shows_what_was_drawn_whatever_was_there_before() {
    let mut numbers = Numbers(3);
    for (columns, rows) in [(80, 24), (33, 7), (9, 3), (2, 2), (1, 1)] {
        let (mut terminal, pending) = canvas(columns, rows);
        let mut eyes = screen(columns, rows);
        let mut before = Buffer::empty(Rect::new(0, 0, columns, rows));
        for turn in 0..150 {
            let mut drawn = Buffer::empty(Rect::new(0, 0, columns, rows));
            // Often little of the frame before changes.
            if turn % 3 > 0 {
                drawn.clone_from(&before);
                drawn.set_string(0, 0, "λ", numbers.style());
            }
            let scribbles = if turn % 3 > 0 { 5 } else { 120 };
            numbers.scribble(&mut drawn, scribbles);
            before.clone_from(&drawn);
            terminal.draw(|frame| frame.buffer_mut().clone_from(&drawn)).unwrap();
            eyes.process(&std::mem::take(&mut *pending.borrow_mut()));
            // A terminal that is told everything, cell by cell, with all it has.
            let mut whole = screen(columns, rows);
            let mut plain = Vec::new();
            let cells = drawn.content.iter().enumerate();
            let mut covered = 0;
            let mut of_all = Vec::new();
            for (place, cell) in cells {
                let (x, y) = (place as u16 % columns, place as u16 / columns);
                covered = if x == 0 { 0 } else { covered };
                if covered > 0 {
                    covered -= 1;
                    continue;
                }
                covered = cell.symbol().width().saturating_sub(1);
                of_all.push((x, y, cell));
            }
            CrosstermBackend::new(&mut plain).draw(of_all.into_iter()).unwrap();
            whole.process(&plain);
            for row in 0..rows {
                for column in 0..columns {
                    let (is, should) = (seen(eyes.screen(), row, column), seen(whole.screen(), row, column));
                    assert_eq!(is, should, "{columns}×{rows}, turn {turn}, row {row}, column {column}");
                }
            }
        }
    }
}

#[test]
fn a_frame_costs_little_more_than_half_of_what_it_costs_cell_by_cell() {
    let mut numbers = Numbers(8);
    let (mut terminal, pending) = canvas(80, 24);
    let mut before = Buffer::empty(Rect::new(0, 0, 80, 24));
    let (mut ours, mut others) = (0, 0);
    for _ in 0..30 {
        // Lines of text of which some are coloured, as tables are.
        let mut next = Buffer::empty(before.area);
        for y in 0..24 {
            for x in [0, 12, 30] {
                let style = Style::new().fg([Color::Reset, Color::Cyan, Color::Magenta][numbers.below(3) as usize]);
                let number = numbers.below(10_000).to_string();
                next.set_string(x, y, number, style);
            }
        }
        let mut plain = Vec::new();
        CrosstermBackend::new(&mut plain).draw(before.diff(&next).into_iter()).unwrap();
        terminal.draw(|frame| frame.buffer_mut().clone_from(&next)).unwrap();
        others += plain.len();
        ours += std::mem::take(&mut *pending.borrow_mut()).len();
        before = next;
    }
    assert!(5 * ours < 3 * others, "{ours} against {others} bytes");
}

#[test]
fn what_looks_the_same_is_not_written() {
    let (mut terminal, pending) = canvas(20, 2);
    let draw = |terminal: &mut Terminal<Canvas>, text: &str, style: Style| {
        terminal
            .draw(|frame| {
                frame.buffer_mut().set_string(0, 0, text, style);
            })
            .unwrap();
        String::from_utf8(std::mem::take(&mut *pending.borrow_mut())).unwrap()
    };
    assert_eq!(draw(&mut terminal, "a    b", Style::new()), "\x1b[1Ha    b");
    assert_eq!(draw(&mut terminal, "a    b", Style::new()), "");
    assert_eq!(draw(&mut terminal, "a    b", Style::new().fg(Color::Cyan)), "\x1b[1H\x1b[36ma    b\x1b[m");
    assert_eq!(draw(&mut terminal, "a", Style::new().fg(Color::Cyan)), "\x1b[1;6H ");
    assert_eq!(draw(&mut terminal, "a eigenvalues", Style::new()), "\x1b[1Ha eigenvalues");
    assert_eq!(draw(&mut terminal, "a", Style::new()), "\x1b[1;3H\x1b[K");
    terminal.clear().unwrap();
    assert_eq!(draw(&mut terminal, "a", Style::new()), "\x1b[m\x1b[2J\x1b[1Ha");
}
