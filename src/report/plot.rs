//! A curve as a few lines of Braille.

/// Dots across and down in one character.
const DOTS: (usize, usize) = (2, 4);

/// A curve drawn with `width` by `height` characters between its least and its greatest value; empty when there is
/// nothing to draw. Each column of dots spans the values that fall into it, so a lone minimum is never lost.
pub(super) fn braille(values: &[f64], width: usize, height: usize) -> Vec<String> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return Vec::new();
    }
    let (across, down) = (width * DOTS.0, height * DOTS.1);
    let span = if high > low { high - low } else { 1.0 };
    let row = |value: f64| ((high - value) / span * (down - 1) as f64).round() as usize;

    let mut cells = vec![vec![0_u8; width]; height];
    let mut dot = |x: usize, y: usize| {
        // Unicode numbers the dots of U+2800 down the left column, then the right one, with the bottom row last.
        let bit = match (x % DOTS.0, y % DOTS.1) {
            (0, 3) => 6,
            (1, 3) => 7,
            (column, line) => column * 3 + line,
        };
        cells[y / DOTS.1][x / DOTS.0] |= 1 << bit;
    };
    for x in 0..across {
        let from = x * values.len() / across;
        let to = ((x + 1) * values.len() / across).max(from + 1);
        let column = values[from..to.min(values.len())].iter().copied().filter(|value| value.is_finite());
        let (mut top, mut bottom) = (usize::MAX, 0);
        for value in column {
            top = top.min(row(value));
            bottom = bottom.max(row(value));
        }
        (top..=bottom).for_each(|y| dot(x, y));
    }
    // Some fonts draw the empty pattern U+2800 as rings: a space stands for it.
    let letter = |&bits: &u8| char::from_u32(0x2800 + u32::from(bits)).filter(|_| bits != 0).unwrap_or(' ');
    cells.iter().map(|line| line.iter().map(letter).collect::<String>().trim_end().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_falling_line_goes_from_the_top_left_to_the_bottom_right() {
        assert_eq!(braille(&[1.0, 0.0], 1, 1), ["⢁"]);
        assert_eq!(braille(&[3.0, 2.0, 1.0, 0.0], 2, 1), ["⠑⢄"]);
    }

    #[test]
    fn a_lone_minimum_among_thousands_is_drawn() {
        let mut values = vec![1.0; 5000];
        values[2500] = 0.0;
        let lines = braille(&values, 20, 3);
        assert!(!lines[2].is_empty(), "{lines:?}");
    }

    #[test]
    fn nothing_constant_or_undefined_does_no_harm() {
        assert!(braille(&[], 10, 2).is_empty());
        assert!(braille(&[f64::NAN], 10, 2).is_empty());
        assert_eq!(braille(&[0.5; 3], 2, 1), ["⠉⠉"]);
        assert_eq!(braille(&[0.5, f64::NAN, 0.5, 0.5], 2, 1), ["⠁⠉"]);
    }
}
