//! Colours and attributes of what is written, and the shortest way from one to another (SGR of ECMA-48).

use ratatui::{
    buffer::Cell,
    style::{Color, Modifier},
};

use super::SHOWING;

/// What characters are written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pen {
    fore: Color,
    ground: Color,
    modifier: Modifier,
}

impl Default for Pen {
    fn default() -> Self {
        Self { fore: Color::Reset, ground: Color::Reset, modifier: Modifier::empty() }
    }
}

/// Attributes with the numbers that turn them on and off. Bold and dim are turned off together, as are the two blinks.
const ATTRIBUTES: [(Modifier, u8, u8); 9] = [
    (Modifier::BOLD, 1, 22),
    (Modifier::DIM, 2, 22),
    (Modifier::ITALIC, 3, 23),
    (Modifier::UNDERLINED, 4, 24),
    (Modifier::SLOW_BLINK, 5, 25),
    (Modifier::RAPID_BLINK, 6, 25),
    (Modifier::REVERSED, 7, 27),
    (Modifier::HIDDEN, 8, 28),
    (Modifier::CROSSED_OUT, 9, 29),
];

impl Pen {
    pub(super) const fn of(cell: &Cell) -> Self {
        Self { fore: cell.fg, ground: cell.bg, modifier: cell.modifier }
    }

    /// True when a blank written with it can be seen.
    pub(super) fn shows_on_blanks(self) -> bool {
        self.ground != Color::Reset || self.modifier.intersects(SHOWING)
    }

    /// The sequence that makes another pen of this one.
    pub(super) fn change(self, to: Self) -> Vec<u8> {
        if self == to {
            return Vec::new();
        }
        let turned = sequence(&self.turned(to));
        // An empty parameter is 0, which resets.
        let anew = Self::default().turned(to);
        let anew = if anew.is_empty() { sequence("") } else { sequence(&format!(";{anew}")) };
        if anew.len() < turned.len() { anew } else { turned }
    }

    fn turned(self, to: Self) -> String {
        let mut codes: Vec<String> = Vec::new();
        let gone = self.modifier.difference(to.modifier);
        let mut kept = self.modifier.intersection(to.modifier);
        for (modifier, _, off) in ATTRIBUTES {
            let code = off.to_string();
            if gone.contains(modifier) && !codes.contains(&code) {
                codes.push(code);
                for (other, _, same) in ATTRIBUTES {
                    if same == off {
                        kept.remove(other);
                    }
                }
            }
        }
        let new = to.modifier.difference(kept);
        codes.extend(
            ATTRIBUTES.iter().filter(|(modifier, ..)| new.contains(*modifier)).map(|(_, on, _)| on.to_string()),
        );
        if self.fore != to.fore {
            codes.push(colour(to.fore, 30));
        }
        if self.ground != to.ground {
            codes.push(colour(to.ground, 40));
        }
        codes.join(";")
    }
}

fn sequence(codes: &str) -> Vec<u8> {
    format!("\x1b[{codes}m").into_bytes()
}

/// The code of a colour; `base` is 30 for what is written and 40 for its ground.
fn colour(colour: Color, base: u8) -> String {
    let number = match colour {
        Color::Reset => 9,
        Color::Black => 0,
        Color::Red => 1,
        Color::Green => 2,
        Color::Yellow => 3,
        Color::Blue => 4,
        Color::Magenta => 5,
        Color::Cyan => 6,
        Color::Gray => 7,
        Color::DarkGray => 60,
        Color::LightRed => 61,
        Color::LightGreen => 62,
        Color::LightYellow => 63,
        Color::LightBlue => 64,
        Color::LightMagenta => 65,
        Color::LightCyan => 66,
        Color::White => 67,
        Color::Indexed(index) => return format!("{};5;{index}", base + 8),
        Color::Rgb(red, green, blue) => return format!("{};2;{red};{green};{blue}", base + 8),
    };
    (base + number).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pen(fore: Color, modifier: Modifier) -> Pen {
        Pen { fore, modifier, ..Pen::default() }
    }

    fn change(from: Pen, to: Pen) -> String {
        String::from_utf8(from.change(to)).unwrap().replace('\x1b', "")
    }

    #[test]
    fn the_shortest_way_is_taken() {
        let plain = Pen::default();
        let cyan = pen(Color::Cyan, Modifier::empty());
        let bold = pen(Color::Red, Modifier::BOLD);
        assert_eq!(change(plain, plain), "");
        assert_eq!(change(plain, cyan), "[36m");
        assert_eq!(change(cyan, plain), "[m", "shorter than [39m");
        assert_eq!(change(bold, pen(Color::Red, Modifier::DIM)), "[22;2m");
        assert_eq!(change(bold, cyan), "[;36m");
        assert_eq!(
            change(pen(Color::Reset, Modifier::BOLD | Modifier::DIM), pen(Color::Reset, Modifier::BOLD)),
            "[;1m"
        );
        assert_eq!(change(cyan, pen(Color::Rgb(1, 2, 3), Modifier::empty())), "[38;2;1;2;3m");
        assert_eq!(change(plain, Pen { ground: Color::White, ..plain }), "[107m");
    }
}
