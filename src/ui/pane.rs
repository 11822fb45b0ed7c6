//! A part of the frame that can be written on without ever leaving it.

use std::cell::RefCell;

use ratatui::{
    buffer::Buffer,
    layout::Rect,
    style::{Modifier, Style},
};

use super::{
    look::{Look, Role},
    text,
};
use crate::workbench::Action;

/// What clicks do where, in the order in which it was drawn.
pub(super) type Targets = RefCell<Vec<(Rect, Vec<Action>)>>;

/// A rectangle of the frame. Coordinates given to it count from its own corner; what lies outside is not drawn.
pub(super) struct Pane<'a> {
    buffer: &'a mut Buffer,
    area: Rect,
    look: Look,
    targets: Option<&'a Targets>,
}

impl<'a> Pane<'a> {
    pub(super) fn new(buffer: &'a mut Buffer, area: Rect, look: Look) -> Self {
        let area = area.intersection(buffer.area);
        Self { buffer, area, look, targets: None }
    }

    /// The same, noting what a click does where.
    pub(super) fn with_targets(self, targets: &'a Targets) -> Self {
        Self { targets: Some(targets), ..self }
    }

    /// A click on this rectangle, given in the pane's coordinates, lets these actions happen.
    pub(super) fn target(&self, area: Rect, actions: impl IntoIterator<Item = Action>) {
        let Some(targets) = self.targets else { return };
        let area = Rect { x: self.area.x.saturating_add(area.x), y: self.area.y.saturating_add(area.y), ..area };
        targets.borrow_mut().push((area.intersection(self.area), actions.into_iter().collect()));
    }

    /// The part of the pane in `area`, which is given in the frame's coordinates.
    pub(super) fn part(&mut self, area: Rect) -> Pane<'_> {
        Pane { area: area.intersection(self.area), buffer: self.buffer, look: self.look, targets: self.targets }
    }

    /// Its place in the frame.
    pub(super) const fn area(&self) -> Rect {
        self.area
    }

    pub(super) const fn width(&self) -> u16 {
        self.area.width
    }

    pub(super) const fn height(&self) -> u16 {
        self.area.height
    }

    pub(super) const fn look(&self) -> Look {
        self.look
    }

    pub(super) fn style(&self, role: Role) -> Style {
        self.look.style(role)
    }

    /// Writes text in one line and returns the column after it. Control characters are not written.
    pub(super) fn put(&mut self, x: u16, y: u16, text: &str, role: Role) -> u16 {
        let style = self.style(role);
        self.styled(x, y, text, style)
    }

    /// As [`Pane::put`], with a style.
    pub(super) fn styled(&mut self, x: u16, y: u16, text: &str, style: Style) -> u16 {
        if x >= self.area.width || y >= self.area.height {
            return x;
        }
        let room = self.area.width - x;
        let (end, _) = self.buffer.set_stringn(self.area.x + x, self.area.y + y, text, room as usize, style);
        end - self.area.x
    }

    /// Writes spans one after another and returns the column after the last.
    pub(super) fn spans<'s>(&mut self, x: u16, y: u16, spans: impl IntoIterator<Item = (&'s str, Role)>) -> u16 {
        spans.into_iter().fold(x, |x, (text, role)| self.put(x, y, text, role))
    }

    /// Writes text that ends at the column before `end`; cuts it when it is longer than `end`. Writes nothing where the
    /// end lies beyond the pane: without its last digits a number would be another one.
    pub(super) fn put_right(&mut self, end: u16, y: u16, text: &str, role: Role) {
        if end > self.area.width {
            return;
        }
        let text = text::fit(text, end as usize);
        let x = end - text::width(&text) as u16;
        self.put(x, y, &text, role);
    }

    /// Puts one character over whatever is there.
    pub(super) fn dot(&mut self, x: u16, y: u16, character: char, style: Style) {
        if x < self.area.width && y < self.area.height {
            let cell = &mut self.buffer[(self.area.x + x, self.area.y + y)];
            cell.reset();
            cell.set_char(character).set_style(style);
        }
    }

    /// Adds a style to a rectangle, given in the pane's coordinates.
    pub(super) fn paint(&mut self, area: Rect, style: Style) {
        let area = Rect { x: self.area.x.saturating_add(area.x), y: self.area.y.saturating_add(area.y), ..area };
        self.buffer.set_style(area.intersection(self.area), style);
    }

    /// Makes all of it faint: its values are no longer, or not yet, those that were asked for.
    pub(super) fn fade(&mut self) {
        let style = Style::new().add_modifier(Modifier::DIM).remove_modifier(Modifier::BOLD);
        self.buffer.set_style(self.area, style);
    }

    /// Empties it.
    pub(super) fn clear(&mut self) {
        for row in self.area.top()..self.area.bottom() {
            for column in self.area.left()..self.area.right() {
                self.buffer[(column, row)].reset();
            }
        }
    }

    /// A horizontal line over the whole width at the frame's row `y`.
    pub(super) fn rule(&mut self, y: u16) {
        let line = "─".repeat(self.area.width as usize);
        self.put(0, y.saturating_sub(self.area.y), &line, Role::Faint);
    }

    /// A vertical line at the frame's `x` and `y`, joined to a rule above it.
    pub(super) fn post(&mut self, x: u16, y: u16, height: u16, joined: bool) {
        let style = self.style(Role::Faint);
        let (x, y) = (x.saturating_sub(self.area.x), y.saturating_sub(self.area.y));
        if joined && y > 0 {
            self.dot(x, y - 1, '┬', style);
        }
        for row in y..y.saturating_add(height).min(self.area.height) {
            self.dot(x, row, '│', style);
        }
    }
}

/// Cuts up to `rows` rows off the top.
pub(super) fn cut_top(area: &mut Rect, rows: u16) -> Rect {
    let rows = rows.min(area.height);
    let cut = Rect { height: rows, ..*area };
    area.y += rows;
    area.height -= rows;
    cut
}

/// Cuts up to `rows` rows off the bottom.
pub(super) fn cut_bottom(area: &mut Rect, rows: u16) -> Rect {
    let rows = rows.min(area.height);
    area.height -= rows;
    Rect { y: area.y + area.height, height: rows, ..*area }
}

/// Cuts up to `columns` columns off the left.
pub(super) fn cut_left(area: &mut Rect, columns: u16) -> Rect {
    let columns = columns.min(area.width);
    let cut = Rect { width: columns, ..*area };
    area.x += columns;
    area.width -= columns;
    cut
}

/// A margin of `columns` on either side.
pub(super) fn inset(area: Rect, columns: u16) -> Rect {
    let columns = columns.min(area.width / 2);
    Rect { x: area.x + columns, width: area.width - 2 * columns, ..area }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_outside_is_not_drawn() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 6, 3));
        let mut whole = Pane::new(&mut buffer, Rect::new(0, 0, 60, 30), Look::default());
        let mut part = whole.part(Rect::new(2, 1, 3, 1));
        part.put(0, 0, "abcdef", Role::Plain);
        part.put(0, 1, "below", Role::Plain);
        part.put(9, 0, "right", Role::Plain);
        part.dot(3, 0, 'x', Style::new());
        part.put_right(2, 0, "12345", Role::Plain);
        part.put_right(4, 0, "0.7", Role::Plain);
        part.paint(Rect::new(0, 0, 99, 99), Style::new().add_modifier(Modifier::BOLD));
        assert_eq!(buffer[(1, 1)].symbol(), " ");
        assert_eq!((2..6).map(|x| buffer[(x, 1)].symbol()).collect::<String>(), "1…c ");
        assert!(buffer[(5, 1)].modifier.is_empty() && !buffer[(4, 1)].modifier.is_empty());
    }

    #[test]
    fn cuts_take_no_more_than_there_is() {
        let mut area = Rect::new(0, 0, 10, 5);
        assert_eq!(cut_top(&mut area, 2), Rect::new(0, 0, 10, 2));
        assert_eq!(cut_bottom(&mut area, 9), Rect::new(0, 2, 10, 3));
        assert_eq!(cut_left(&mut area, 4), Rect::new(0, 2, 4, 0));
        assert_eq!(area, Rect::new(4, 2, 6, 0));
        assert_eq!(inset(Rect::new(0, 0, 1, 1), 3), Rect::new(0, 0, 1, 1));
    }
}
