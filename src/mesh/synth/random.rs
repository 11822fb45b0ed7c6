//! The generator's source of chance: the extendable output of blake3, the same on every platform.

/// A stream of numbers that depends on nothing but the words it was keyed with.
#[derive(Debug, Clone)]
pub struct Random {
    output: blake3::OutputReader,
    block: [u8; 64],
    used: usize,
}

impl Random {
    /// The stream of one attempt at one model. `purpose` keeps apart what is drawn for the shape and for its mesh, so
    /// that the number of vertices does not change the pose.
    pub fn new(seed: u64, class: &str, index: usize, attempt: u64, purpose: &str) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key("eigenselect procedural shapes, version 1");
        hasher.update(&seed.to_le_bytes());
        hasher.update(&(index as u64).to_le_bytes());
        hasher.update(&attempt.to_le_bytes());
        for word in [class, purpose] {
            hasher.update(&(word.len() as u64).to_le_bytes());
            hasher.update(word.as_bytes());
        }
        Self { output: hasher.finalize_xof(), block: [0; 64], used: 64 }
    }

    /// Uniform on [0, 1), 53 bits.
    pub fn unit(&mut self) -> f64 {
        if self.used == self.block.len() {
            self.output.fill(&mut self.block);
            self.used = 0;
        }
        let mut word = [0; 8];
        word.copy_from_slice(&self.block[self.used..self.used + 8]);
        self.used += 8;
        (u64::from_le_bytes(word) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform on [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform on [−spread, spread).
    pub fn about_zero(&mut self, spread: f64) -> f64 {
        self.between(-spread, spread)
    }

    /// `mean` times a factor in [1 − spread, 1 + spread).
    pub fn near(&mut self, mean: f64, spread: f64) -> f64 {
        mean * (1.0 + self.about_zero(spread))
    }

    /// A whole number below `count`, which must not be 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// Mean 0 and variance 1, bell-shaped, within ±4.9 (the sum of eight uniform numbers).
    pub fn bell(&mut self) -> f64 {
        let sum: f64 = (0..8).map(|_| self.unit()).sum();
        (sum - 4.0) * 1.5_f64.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |index, purpose| {
            let mut random = Random::new(7, "cup", index, 0, purpose);
            (0..20).map(|_| random.unit()).collect::<Vec<_>>()
        };
        assert_eq!(draw(1, "shape"), draw(1, "shape"));
        assert_ne!(draw(1, "shape"), draw(2, "shape"));
        assert_ne!(draw(1, "shape"), draw(1, "mesh"));
    }

    #[test]
    fn moments_are_those_promised() {
        let mut random = Random::new(1, "x", 0, 0, "test");
        let n = 20_000;
        let draws: Vec<f64> = (0..n).map(|_| random.bell()).collect();
        let mean = draws.iter().sum::<f64>() / f64::from(n);
        let variance = draws.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
        assert!((0..1000).all(|_| random.below(3) < 3));
    }
}
