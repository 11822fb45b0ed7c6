//! Sorting a few hundred numbers, thousands of times.

/// The numbers 0…`count` − 1 in the order of their values, those of equal values ascending.
pub(super) fn ascending(count: usize, value: impl Fn(usize) -> f64) -> Vec<u32> {
    // Integers in the order of the values: the bits, and for negative ones their complement.
    let key = |at: u64| {
        let bits = value(at as usize).to_bits();
        bits ^ (((bits as i64 >> 63) as u64) | 1 << 63)
    };
    // The last bits make room for the number: single integers are sorted in half the time of pairs.
    let room = (count as u64).next_power_of_two() - 1;
    let mut keys: Vec<u64> = (0..count as u64).map(|at| (key(at) & !room) | at).collect();
    keys.sort_unstable();
    // Values that differ in those bits alone stand side by side, by number instead of value.
    for end in 1..count {
        let mut at = end;
        while at > 0 && (keys[at] ^ keys[at - 1]) <= room && key(keys[at] & room) < key(keys[at - 1] & room) {
            keys.swap(at, at - 1);
            at -= 1;
        }
    }
    keys.into_iter().map(|key| (key & room) as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::ascending;
    use crate::metrics::samples::Lcg;

    #[test]
    fn orders_as_a_stable_sort_does() {
        let mut random = Lcg(3);
        for count in [0, 1, 2, 5, 64, 300] {
            for levels in [1.0, 4.0, 1e3, 1e18] {
                let mut values: Vec<f64> =
                    (0..count).map(|_| ((random.next() - 0.5) * levels).round() / levels).collect();
                // Neighbours that differ in their last bits alone, either way round.
                for at in 2..count {
                    if at % 3 == 0 {
                        values[at] = if at % 2 == 0 { values[at - 1].next_up() } else { values[at - 2].next_down() };
                    }
                }
                let mut expected: Vec<u32> = (0..count as u32).collect();
                expected.sort_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]));
                assert_eq!(ascending(count, |at| values[at]), expected, "{count} {levels}");
            }
        }
    }
}
