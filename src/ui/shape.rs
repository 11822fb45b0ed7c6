//! One model as a shape, and small pictures of several.
//!
//! ```text
//!  12 human D  10 098 vertices   eigenfunction 5 of λ 3.21        dots, zoom 1.3
//!                    ⢀⣠⣤⣀
//!                   ⢠⣿⣿⣿⣷
//!                    ⢹⣿⣿⡏          (the whole width of the screen)
//! ```
//!
//! With many colours a dot or a block takes the colour of its shade. With sixteen, shades become patterns of dots and
//! the sign of the function becomes one of two colours; without colour, the function's value becomes density too.

use ratatui::{
    layout::Rect,
    style::{Color, Modifier, Style as Face},
};

use super::{
    heading::{Note, heading, nothing},
    look::{Look, Role, Shades},
    names::{self, Names},
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    dataset::Role as Member,
    query::{ModelState, Question},
    workbench::{
        Answered, State,
        shape::{Picture, Scene, Style},
    },
};

/// From dark to light, for screens with nothing but ASCII.
const RAMP: [char; 10] = ['.', ':', '-', '=', '+', '*', 'o', '#', '%', '@'];
/// From dark to light in blocks, for screens with sixteen colours.
const BLOCKS: [char; 4] = ['░', '▒', '▓', '█'];
/// An ordered pattern of 4 × 4 thresholds (Bayer 1973), in sixteenths.
const PATTERN: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
/// Bits of Unicode's Braille patterns, by column and row of the dot.
const BRAILLE: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let Some(model) = state.model() else {
        heading(pane, 0, "Shape", Note::Settled);
        return nothing(state, pane, 1);
    };
    title(state, model, pane);
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let width = (pane.width() as usize).saturating_sub(2);
    match state.answered(&Question::Shape(model)) {
        Answered::Nothing(reason) => {
            pane.put(1, 1, &text::fit(reason, width), Role::Warn);
        }
        Answered::Awaited if state.fatal.is_some() => {
            pane.put(1, 1, "the engine has ended", Role::Faint);
        }
        _ => match state.pictures.whole(model) {
            Some((scene, picture)) => cells(scene, picture, &mut pane.part(rest)),
            None => {
                pane.put(1, 1, "reading the file", Role::Faint);
            }
        },
    }
}

fn title(state: &State, model: usize, pane: &mut Pane<'_>) {
    let row = &state.answer.models[model];
    let names = Names::new(&state.answer);
    let width = pane.width() as usize;
    let x = pane.put(1, 0, &text::fit_end(names.of(row), width / 3), Role::Strong);
    let class = text::fit(names::class(&state.answer, row.class as usize), width / 4);
    let x = pane.put(x + 1, 0, &class, Role::Strong);
    let (letter, role) = match row.role {
        Member::Train => ("D", Role::Train),
        Member::Query => ("Q", Role::Query),
    };
    let mut x = pane.put(x + 1, 0, letter, role);
    let shown = match state.style {
        Style::Dots => "dots",
        Style::Blocks => "blocks",
        Style::Plain => "plain",
        Style::Pixels => "pixels",
    };
    let end = pane.width().saturating_sub(1);
    let function = state.function.map(|index| {
        let value = row.eigenvalues.as_ref().and_then(|values| values.get(index - 1));
        let value = value.map_or_else(String::new, |value| format!(" of λ {}", number::short(*value)));
        match state.answered(&Question::Function { model, index }) {
            Answered::Nothing(reason) => format!("eigenfunction {index}: {reason}"),
            Answered::Awaited => format!("eigenfunction {index} …"),
            Answered::Found(..) => format!("eigenfunction {index}{value}"),
        }
    });
    let right = format!("{shown} ×{:.1}", state.camera.scale());
    let room = |x: u16, said: &str| x as usize + 3 + text::width(said) + text::width(&right) + 2 < width;
    if let Some(said) = function {
        let free = width.saturating_sub(x as usize + 5 + text::width(&right));
        x = pane.put(x + 2, 0, &text::fit(&said, free), Role::Strong);
    }
    if let Some((vertices, triangles)) = row.size {
        let said = format!("{vertices} vertices · {triangles} triangles");
        if room(x, &said) {
            x = pane.put(x + 2, 0, &said, Role::Plain);
        }
    }
    if !row.defects.is_empty() || matches!(row.state, ModelState::Out { .. }) {
        let said = format!("! {}", number::count(row.defects.len().max(1), "defect"));
        if room(x, &said) {
            x = pane.put(x + 2, 0, &said, Role::Warn);
        }
    }
    if room(x, "") {
        pane.put_right(end, 0, &right, Role::Faint);
    }
}

/// Small pictures side by side, each with a line below; the one at `chosen` is what the keys act on.
pub(super) fn strip(state: &State, models: &[usize], chosen: Option<usize>, pane: &mut Pane<'_>) {
    let names = Names::new(&state.answer);
    let (wide, high) = crate::workbench::shape::THUMB;
    for (place, &model) in models.iter().enumerate() {
        let x = place as u16 * (wide + 2) + 1;
        if x + wide > pane.width() {
            return;
        }
        let Some(row) = state.answer.models.get(model) else { continue };
        let label = format!("{} {}", names.of(row), names::class(&state.answer, row.class as usize));
        let label = text::fit(&label, wide as usize);
        let at = x + (wide.saturating_sub(text::width(&label) as u16)) / 2;
        pane.put(at, high, &label, if chosen == Some(place) { Role::Chosen } else { Role::Plain });
        let area = Rect { x: pane.area().x + x, y: pane.area().y, width: wide, height: high };
        if let Some((scene, picture)) = state.pictures.small(model) {
            cells(scene, picture, &mut pane.part(area));
        }
    }
}

/// Writes a picture into the pane, from its upper left.
pub(super) fn cells(scene: &Scene, picture: &Picture, pane: &mut Pane<'_>) {
    let look = pane.look();
    let coloured = scene.function.is_some();
    let ink = Ink { look, coloured };
    // Over the cells of a picture that the terminal lays on them nothing is written.
    let Some((across, down)) = scene.style.parts() else { return };
    let (across, down) = (across as usize, down as usize);
    let rows = (picture.height / down).min(pane.height() as usize);
    let columns = (picture.width / across).min(pane.width() as usize);
    for row in 0..rows {
        for column in 0..columns {
            let pixel = |dx: usize, dy: usize| picture.at(column * across + dx, row * down + dy);
            let cell = match scene.style {
                Style::Dots => ink.dots((column, row), pixel),
                Style::Blocks => ink.blocks(pixel(0, 0), pixel(0, 1)),
                Style::Plain => pixel(0, 0).map(|seen| ink.plain(seen)),
                Style::Pixels => None,
            };
            if let Some((character, face)) = cell {
                pane.dot(column as u16, row as u16, character, face);
            }
        }
    }
}

/// How shades and values are put on this screen.
#[derive(Clone, Copy)]
struct Ink {
    look: Look,
    coloured: bool,
}

type Seen = (f32, f32);

impl Ink {
    /// Whether shades can be colours.
    fn fine(self) -> bool {
        self.look.colour && self.look.shades != Shades::Few
    }

    /// Two by four dots.
    fn dots(self, (column, row): (usize, usize), pixel: impl Fn(usize, usize) -> Option<Seen>) -> Option<(char, Face)> {
        let mut bits = 0;
        let (mut count, mut shades, mut values) = (0, 0.0, 0.0);
        for dx in 0..2 {
            for dy in 0..4 {
                let Some((shade, value)) = pixel(dx, dy) else { continue };
                count += 1;
                shades += shade;
                values += value;
                let threshold = f32::from(PATTERN[(4 * row + dy) % 4][(2 * column + dx) % 4]) + 0.5;
                if self.fine() || 16.0 * self.density((shade, value)) > threshold {
                    bits |= BRAILLE[dx][dy];
                }
            }
        }
        let character = char::from_u32(0x2800 + u32::from(bits)).filter(|_| bits != 0)?;
        let mean = (shades / count.max(1) as f32, values / count.max(1) as f32);
        Some((character, self.face(mean)))
    }

    /// Two pixels, one above the other.
    fn blocks(self, upper: Option<Seen>, lower: Option<Seen>) -> Option<(char, Face)> {
        if !self.fine() {
            let seen = upper.or(lower)?;
            let character = match (upper, lower) {
                (Some(_), None) => '▀',
                (None, Some(_)) => '▄',
                _ => BLOCKS[((self.density(seen) * 4.0) as usize).min(3)],
            };
            return Some((character, self.face(seen)));
        }
        match (upper, lower) {
            (Some(upper), Some(lower)) => {
                let (above, below) = (self.colour(upper), self.colour(lower));
                let face = Face::new().fg(above);
                Some(if above == below { ('█', face) } else { ('▀', face.bg(below)) })
            }
            (Some(upper), None) => Some(('▀', Face::new().fg(self.colour(upper)))),
            (None, Some(lower)) => Some(('▄', Face::new().fg(self.colour(lower)))),
            (None, None) => None,
        }
    }

    fn plain(self, seen: Seen) -> (char, Face) {
        let step = (self.density(seen) * RAMP.len() as f32) as usize;
        (RAMP[step.min(RAMP.len() - 1)], self.face(seen))
    }

    /// How much of the ground is covered, where colours do not show the shade.
    fn density(self, (shade, value): Seen) -> f32 {
        // Never so little that the shape loses its outline.
        let shade = 0.15 + 0.85 * shade;
        let lit = if self.coloured && !self.look.colour { shade * (0.3 + 0.35 * (value + 1.0)) } else { shade };
        // Dots on a light ground are dark: what is lit has few of them.
        if self.look.light { 1.12 - lit } else { lit }
    }

    fn face(self, seen: Seen) -> Face {
        if self.fine() {
            return Face::new().fg(self.colour(seen));
        }
        let face = match (self.coloured, seen.1 < 0.0) {
            (true, true) => self.look.style(Role::Train),
            (true, false) => self.look.style(Role::Query),
            (false, _) => self.look.style(Role::Plain),
        };
        face.remove_modifier(Modifier::DIM)
    }

    /// The colour of a shade and a value: white where the function is 0, blue below, orange above; these two stay apart
    /// for the common kinds of colour blindness.
    fn colour(self, (shade, value): Seen) -> Color {
        const BELOW: [f32; 3] = [0.25, 0.50, 1.0];
        const ABOVE: [f32; 3] = [1.0, 0.55, 0.12];
        /// Levels of a shade: fewer colours are fewer bytes.
        const LEVELS: f32 = 23.0;
        let shade = (shade * LEVELS).round() / LEVELS;
        if !self.coloured {
            return match self.look.shades {
                Shades::All => {
                    let part = |most: f32| (255.0 * most * (0.12 + 0.88 * shade)) as u8;
                    Color::Rgb(part(0.90), part(0.93), part(1.0))
                }
                _ => Color::Indexed(233 + (22.0 * shade) as u8),
            };
        }
        let strength = ((value.abs().powf(0.7) * 12.0).round() / 12.0).min(1.0);
        let towards = if value < 0.0 { BELOW } else { ABOVE };
        let parts = towards.map(|part| (1.0 + strength * (part - 1.0)) * (0.2 + 0.8 * shade));
        if self.look.shades == Shades::All {
            let [red, green, blue] = parts.map(|part| (255.0 * part) as u8);
            Color::Rgb(red, green, blue)
        } else {
            let [red, green, blue] = parts.map(|part| (5.0 * part).round() as u8);
            Color::Indexed(16 + 36 * red + 6 * green + blue)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ink(shades: Shades, coloured: bool) -> Ink {
        Ink { look: Look { shades, ..Look::default() }, coloured }
    }

    #[test]
    fn darker_shades_have_fewer_dots() {
        let dots = |shade: f32| {
            let (character, _) = ink(Shades::Few, false).dots((0, 0), |_, _| Some((shade, 0.0))).unwrap();
            (character as u32 - 0x2800).count_ones()
        };
        assert!(dots(0.0) > 0 && dots(0.0) < dots(0.5) && dots(0.5) < dots(1.0));
        assert_eq!(dots(1.0), 8);
        assert!(ink(Shades::Few, false).dots((0, 0), |_, _| None).is_none());
    }

    #[test]
    fn the_sign_of_a_function_is_a_colour_of_its_own() {
        for shades in [Shades::Few, Shades::Many, Shades::All] {
            let face = |value| ink(shades, true).face((0.8, value));
            assert_ne!(face(-1.0).fg, face(1.0).fg, "{shades:?}");
        }
        let still = Ink { look: Look { colour: false, ..Look::default() }, coloured: true };
        assert_eq!(still.face((0.5, 1.0)).fg, None);
        assert!(still.density((0.5, 1.0)) > still.density((0.5, -1.0)));
    }

    #[test]
    fn the_rim_of_a_block_leaves_the_ground_alone() {
        let fine = ink(Shades::All, false);
        let (character, face) = fine.blocks(None, Some((0.5, 0.0))).unwrap();
        assert_eq!((character, face.bg), ('▄', None));
        let (character, _) = fine.blocks(Some((0.5, 0.0)), Some((0.5, 0.0))).unwrap();
        assert_eq!(character, '█');
        assert!(fine.blocks(None, None).is_none());
    }
}
