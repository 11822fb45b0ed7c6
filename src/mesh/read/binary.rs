//! Numbers of a binary file.

/// A position in bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
    big: bool,
}

impl<'a> Bytes<'a> {
    /// Bytes from offset `at`; `big` is true where the most significant byte comes first.
    pub(super) fn new(bytes: &'a [u8], at: usize, big: bool) -> Self {
        Self { all: bytes, at: at.min(bytes.len()), big }
    }

    /// Where the next byte stands, from the beginning of the file.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// How many bytes there still are.
    pub(super) fn left(&self) -> usize {
        self.all.len() - self.at
    }

    /// Passes over bytes; `None` where there are fewer.
    pub(super) fn skip(&mut self, count: usize) -> Option<()> {
        if count > self.left() {
            return None;
        }
        self.at += count;
        Some(())
    }

    /// The next bytes in little-endian order.
    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut value: [u8; N] = *self.all[self.at..].first_chunk()?;
        self.at += N;
        if self.big {
            value.reverse();
        }
        Some(value)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }
}

/// The f64 of an f32's shortest decimal.
pub(super) fn widen(value: f32) -> f64 {
    let wide = f64::from(value);
    // Most of what programs write has up to nine decimals and is below 2²³ in units of the last. There the product
    // is exact (24 bits of the value, 21 of 5⁹), at most one such decimal lies nearer to this f32 than to others, and
    // it is too far from the middle between two of them for the f64 in between to matter.
    for power in [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9] {
        let whole = (wide * power).round();
        if whole.abs() >= 8_388_608.0 {
            break;
        }
        let decimal = whole / power;
        if decimal as f32 == value {
            return decimal;
        }
    }
    if value.is_finite() { format!("{value:e}").parse().unwrap_or(wide) } else { wide }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn both_byte_orders() {
        let bytes = [1, 2, 3, 4, 5];
        assert_eq!(Bytes::new(&bytes, 0, false).u32(), Some(0x0403_0201));
        let mut big = Bytes::new(&bytes, 1, true);
        assert_eq!((big.u32(), big.at(), big.left(), big.u32()), (Some(0x0203_0405), 5, 0, None));
        assert_eq!(Bytes::new(&bytes, 9, true).left(), 0);
    }

    #[test]
    fn shortest_decimals() {
        assert_eq!(widen(0.1), 0.1);
        assert_eq!(widen(-1.234_567e-20), -1.234_567e-20);
        assert_eq!(widen(3.0).to_bits(), 3.0f64.to_bits());
        assert_eq!(widen(-0.0).to_bits(), (-0.0f64).to_bits());
        assert_eq!(widen(f32::MAX), 3.402_823_5e38);
        assert!(widen(f32::NAN).is_nan());
    }

    proptest! {
        #[test]
        fn an_f32_is_kept(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(widen(value).to_bits(), value.to_string().parse::<f64>().unwrap().to_bits());
            prop_assert_eq!((widen(value) as f32).to_bits(), bits);
        }

        #[test]
        fn an_f32_of_common_size_is_its_shortest_decimal(value in -1000.0..1000.0f32, decimals in 0..9usize) {
            for value in [value, format!("{value:.decimals$}").parse().unwrap()] {
                prop_assert_eq!(widen(value).to_bits(), value.to_string().parse::<f64>().unwrap().to_bits());
            }
        }

        #[test]
        fn six_digits_survive(digits in 100_000..1_000_000i32, power in -30..30i32) {
            let text = format!("{digits}e{power}");
            prop_assert_eq!(widen(text.parse().unwrap()), text.parse::<f64>().unwrap());
        }
    }
}
