//! Eight numbers at a time: the arithmetic that every kernel of the solver is written in.
//!
//! Blocks of vectors are kept as rows of eight contiguous values, one per vector. A row is one AVX-512 register, two
//! AVX2 registers or an array that the compiler makes the best of. The choice is made at run time; the results are the
//! same bits, because all of them fuse every multiplication with its addition and add in the same order. Machines that
//! share a store of spectra may therefore differ.
//!
//! Where a kernel makes an array of registers by some arithmetic, it does so in a loop. A closure for
//! `array::from_fn` or `map` is compiled for no instruction set: where the compiler leaves it a function of its own,
//! every operation in it is a call.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{__m128, __m256, __m256d, __m512, __m512d, _MM_HINT_T0, _mm_prefetch};

use bytemuck::{Pod, Zeroable};

pub(super) use self::buffer::Buffer;

mod buffer;

/// Vectors per block.
pub(super) const WIDTH: usize = 8;

/// One row of a block: entry i of eight vectors.
pub(super) type Row = [f64; WIDTH];

/// Two rows in single precision, number beside number.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Twin(pub [[f32; 2]; WIDTH]);

/// Arithmetic on rows held in registers.
pub(super) trait Lanes: Copy {
    /// Eight numbers in registers.
    type Reg: Copy;
    /// Sixteen single-precision numbers in registers.
    type Wide: Copy;
    /// True when 16 or more accumulators fit the registers.
    const MANY: bool;
    fn load(self, row: &Row) -> Self::Reg;
    fn splat(self, value: f64) -> Self::Reg;
    fn row(self, value: Self::Reg) -> Row;
    /// `a b + c`
    fn add_mul(self, c: Self::Reg, a: Self::Reg, b: Self::Reg) -> Self::Reg;
    /// `c − a b`
    fn sub_mul(self, c: Self::Reg, a: Self::Reg, b: Self::Reg) -> Self::Reg;
    fn sub(self, a: Self::Reg, b: Self::Reg) -> Self::Reg;
    fn add(self, a: Self::Reg, b: Self::Reg) -> Self::Reg;
    fn mul(self, a: Self::Reg, b: Self::Reg) -> Self::Reg;
    /// The sums of the eight numbers in each, added up as by [`sum`].
    fn sums(self, values: [Self::Reg; WIDTH]) -> Self::Reg;
    fn wide(self, values: &Twin) -> Self::Wide;
    fn wide_splat(self, value: f32) -> Self::Wide;
    /// Two numbers by turns.
    fn wide_splat_two(self, values: [f32; 2]) -> Self::Wide;
    fn twin(self, value: Self::Wide) -> Twin;
    /// `a b + c`
    fn wide_add_mul(self, c: Self::Wide, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// Has these numbers fetched to the first cache, for they are needed soon, where [`MANY`](Self::MANY).
    fn fetch(self, _values: &Twin) {}
    fn wide_add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// Two rows in single precision, number beside number.
    fn beside(self, rows: [Self::Reg; 2]) -> Self::Wide;
    /// Two such rows in double precision.
    fn apart(self, value: Self::Wide) -> [Self::Reg; 2];

    #[inline(always)]
    fn zero(self) -> Self::Reg {
        self.splat(0.0)
    }
}

/// The sum of eight numbers: of pairs, then of pairs of those.
#[inline(always)]
pub(super) fn sum([a, b, c, d, e, f, g, h]: &Row) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// Work that is compiled once for each instruction set. Implementations of `run` must be `#[inline(always)]`, as must
/// everything hot that they call.
pub(super) trait Kernel {
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs a kernel with the best instructions that this machine has.
#[inline]
pub(super) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        struct Wide<K, L>(K, L);
        impl<K: Kernel, L: Lanes> pulp::NullaryFnOnce for Wide<K, L> {
            type Output = K::Output;
            #[inline(always)]
            fn call(self) -> K::Output {
                self.0.run(self.1)
            }
        }
        let sets = sets();
        if let Some(simd) = pulp::x86::V4::try_new().filter(|_| sets > 1) {
            return simd.vectorize(Wide(kernel, Avx512(simd)));
        }
        if let Some(simd) = pulp::x86::V3::try_new().filter(|_| sets > 0) {
            return simd.vectorize(Wide(kernel, Avx2(simd)));
        }
    }
    kernel.run(Plain)
}

/// How many of the instruction sets above plain arrays may be used.
#[cfg(not(test))]
const fn sets() -> u8 {
    2
}

#[cfg(test)]
fn sets() -> u8 {
    SETS.get()
}

#[cfg(test)]
thread_local! {
    /// For tests that compare them: on this thread.
    pub(super) static SETS: std::cell::Cell<u8> = const { std::cell::Cell::new(2) };
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx512(pulp::x86::V4);

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx512 {
    type Reg = __m512d;
    type Wide = __m512;
    const MANY: bool = true;

    #[inline(always)]
    fn load(self, row: &Row) -> __m512d {
        pulp::cast(*row)
    }
    #[inline(always)]
    fn splat(self, value: f64) -> __m512d {
        self.0.avx512f._mm512_set1_pd(value)
    }
    #[inline(always)]
    fn row(self, value: __m512d) -> Row {
        pulp::cast(value)
    }
    #[inline(always)]
    fn add_mul(self, c: __m512d, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_fmadd_pd(a, b, c)
    }
    #[inline(always)]
    fn sub_mul(self, c: __m512d, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_fnmadd_pd(a, b, c)
    }
    #[inline(always)]
    fn sub(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_sub_pd(a, b)
    }
    #[inline(always)]
    fn mul(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_mul_pd(a, b)
    }
    #[inline(always)]
    fn add(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_add_pd(a, b)
    }
    #[inline(always)]
    fn sums(self, [a, b, c, d, e, f, g, h]: [__m512d; WIDTH]) -> __m512d {
        let avx = self.0.avx512f;
        let twos = |x, y| self.add(avx._mm512_unpacklo_pd(x, y), avx._mm512_unpackhi_pd(x, y));
        let fours = |x, y| self.add(avx._mm512_shuffle_f64x2::<0x88>(x, y), avx._mm512_shuffle_f64x2::<0xdd>(x, y));
        fours(fours(twos(a, b), twos(c, d)), fours(twos(e, f), twos(g, h)))
    }
    #[inline(always)]
    fn wide(self, values: &Twin) -> __m512 {
        pulp::cast(values.0)
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> __m512 {
        self.0.avx512f._mm512_set1_ps(value)
    }
    #[inline(always)]
    fn wide_splat_two(self, values: [f32; 2]) -> __m512 {
        pulp::cast(self.splat(pulp::cast(values)))
    }
    #[inline(always)]
    fn twin(self, value: __m512) -> Twin {
        Twin(pulp::cast(value))
    }
    #[inline(always)]
    fn wide_add_mul(self, c: __m512, a: __m512, b: __m512) -> __m512 {
        self.0.avx512f._mm512_fmadd_ps(a, b, c)
    }
    #[inline(always)]
    fn wide_add(self, a: __m512, b: __m512) -> __m512 {
        self.0.avx512f._mm512_add_ps(a, b)
    }
    #[inline(always)]
    fn fetch(self, values: &Twin) {
        #[expect(unsafe_code, reason = "the instruction has no safe name")]
        // SAFETY: it may be given any address, and changes nothing but what a cache holds.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>((&raw const *values).cast());
        }
    }
    #[inline(always)]
    fn beside(self, [a, b]: [__m512d; 2]) -> __m512 {
        let both = pulp::cast([self.0.avx512f._mm512_cvtpd_ps(a), self.0.avx512f._mm512_cvtpd_ps(b)]);
        let order: [i32; 16] = [0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15];
        self.0.avx512f._mm512_permutexvar_ps(pulp::cast(order), both)
    }
    #[inline(always)]
    fn apart(self, value: __m512) -> [__m512d; 2] {
        let order: [i32; 16] = [0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15];
        let [a, b]: [__m256; 2] = pulp::cast(self.0.avx512f._mm512_permutexvar_ps(pulp::cast(order), value));
        [self.0.avx512f._mm512_cvtps_pd(a), self.0.avx512f._mm512_cvtps_pd(b)]
    }
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx2(pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx2 {
    type Reg = [__m256d; 2];
    type Wide = [__m256; 2];
    const MANY: bool = false;

    #[inline(always)]
    fn load(self, row: &Row) -> [__m256d; 2] {
        let [a, b, c, d, e, f, g, h] = *row;
        [pulp::cast([a, b, c, d]), pulp::cast([e, f, g, h])]
    }
    #[inline(always)]
    fn splat(self, value: f64) -> [__m256d; 2] {
        [self.0.avx._mm256_set1_pd(value); 2]
    }
    #[inline(always)]
    fn row(self, value: [__m256d; 2]) -> Row {
        let [a, b, c, d]: [f64; 4] = pulp::cast(value[0]);
        let [e, f, g, h]: [f64; 4] = pulp::cast(value[1]);
        [a, b, c, d, e, f, g, h]
    }
    #[inline(always)]
    fn add_mul(self, c: [__m256d; 2], a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        [self.0.fma._mm256_fmadd_pd(a[0], b[0], c[0]), self.0.fma._mm256_fmadd_pd(a[1], b[1], c[1])]
    }
    #[inline(always)]
    fn sub_mul(self, c: [__m256d; 2], a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        [self.0.fma._mm256_fnmadd_pd(a[0], b[0], c[0]), self.0.fma._mm256_fnmadd_pd(a[1], b[1], c[1])]
    }
    #[inline(always)]
    fn sub(self, a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        [self.0.avx._mm256_sub_pd(a[0], b[0]), self.0.avx._mm256_sub_pd(a[1], b[1])]
    }
    #[inline(always)]
    fn mul(self, a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        [self.0.avx._mm256_mul_pd(a[0], b[0]), self.0.avx._mm256_mul_pd(a[1], b[1])]
    }
    #[inline(always)]
    fn add(self, a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        [self.0.avx._mm256_add_pd(a[0], b[0]), self.0.avx._mm256_add_pd(a[1], b[1])]
    }
    #[inline(always)]
    fn sums(self, values: [[__m256d; 2]; WIDTH]) -> [__m256d; 2] {
        let avx = self.0.avx;
        let mut sums = values[0];
        for (to, [a, b, c, d]) in sums.iter_mut().zip(values.as_chunks().0) {
            let mut fours = *a;
            for (half, to) in fours.iter_mut().enumerate() {
                let (x, y) = (avx._mm256_hadd_pd(a[half], b[half]), avx._mm256_hadd_pd(c[half], d[half]));
                let (left, right) =
                    (avx._mm256_permute2f128_pd::<0x20>(x, y), avx._mm256_permute2f128_pd::<0x31>(x, y));
                *to = avx._mm256_add_pd(left, right);
            }
            *to = avx._mm256_add_pd(fours[0], fours[1]);
        }
        sums
    }
    #[inline(always)]
    fn wide(self, values: &Twin) -> [__m256; 2] {
        pulp::cast(values.0)
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> [__m256; 2] {
        [self.0.avx._mm256_set1_ps(value); 2]
    }
    #[inline(always)]
    fn wide_splat_two(self, values: [f32; 2]) -> [__m256; 2] {
        pulp::cast(self.splat(pulp::cast(values)))
    }
    #[inline(always)]
    fn twin(self, value: [__m256; 2]) -> Twin {
        Twin(pulp::cast(value))
    }
    #[inline(always)]
    fn wide_add_mul(self, c: [__m256; 2], a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.0.fma._mm256_fmadd_ps(a[0], b[0], c[0]), self.0.fma._mm256_fmadd_ps(a[1], b[1], c[1])]
    }
    #[inline(always)]
    fn wide_add(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.0.avx._mm256_add_ps(a[0], b[0]), self.0.avx._mm256_add_ps(a[1], b[1])]
    }
    #[inline(always)]
    fn beside(self, rows: [[__m256d; 2]; 2]) -> [__m256; 2] {
        let avx = self.0.avx;
        let mut halves = [avx._mm256_setzero_ps(); 2];
        for (half, to) in halves.iter_mut().enumerate() {
            let (a, b) = (avx._mm256_cvtpd_ps(rows[0][half]), avx._mm256_cvtpd_ps(rows[1][half]));
            *to = pulp::cast([self.0.sse._mm_unpacklo_ps(a, b), self.0.sse._mm_unpackhi_ps(a, b)]);
        }
        halves
    }
    #[inline(always)]
    fn apart(self, value: [__m256; 2]) -> [[__m256d; 2]; 2] {
        let avx = self.0.avx;
        let mut rows = [[avx._mm256_setzero_pd(); 2]; 2];
        for (half, value) in value.into_iter().enumerate() {
            let [low, high]: [__m128; 2] = pulp::cast(value);
            rows[0][half] = avx._mm256_cvtps_pd(self.0.sse._mm_shuffle_ps::<0x88>(low, high));
            rows[1][half] = avx._mm256_cvtps_pd(self.0.sse._mm_shuffle_ps::<0xdd>(low, high));
        }
        rows
    }
}

/// Arrays, for processors without the above. Where they cannot fuse a multiplication with an addition (x86-64 from
/// before 2013) every one is a call into a library: slow, but the same bits.
#[derive(Clone, Copy)]
struct Plain;

impl Lanes for Plain {
    type Reg = [f64; WIDTH];
    type Wide = [f32; 16];
    const MANY: bool = false;

    #[inline(always)]
    fn load(self, row: &Row) -> [f64; WIDTH] {
        *row
    }
    #[inline(always)]
    fn splat(self, value: f64) -> [f64; WIDTH] {
        [value; WIDTH]
    }
    #[inline(always)]
    fn row(self, value: [f64; WIDTH]) -> Row {
        value
    }
    #[inline(always)]
    fn add_mul(self, c: [f64; WIDTH], a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at].mul_add(b[at], c[at]))
    }
    #[inline(always)]
    fn sub_mul(self, c: [f64; WIDTH], a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| (-a[at]).mul_add(b[at], c[at]))
    }
    #[inline(always)]
    fn sub(self, a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at] - b[at])
    }
    #[inline(always)]
    fn mul(self, a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at] * b[at])
    }
    #[inline(always)]
    fn add(self, a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at] + b[at])
    }
    #[inline(always)]
    fn sums(self, values: [[f64; WIDTH]; WIDTH]) -> [f64; WIDTH] {
        values.map(|values| sum(&values))
    }
    #[inline(always)]
    fn wide(self, values: &Twin) -> [f32; 16] {
        pulp::cast(values.0)
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> [f32; 16] {
        [value; 16]
    }
    #[inline(always)]
    fn wide_splat_two(self, values: [f32; 2]) -> [f32; 16] {
        std::array::from_fn(|at| values[at % 2])
    }
    #[inline(always)]
    fn twin(self, value: [f32; 16]) -> Twin {
        Twin(pulp::cast(value))
    }
    #[inline(always)]
    fn wide_add_mul(self, c: [f32; 16], a: [f32; 16], b: [f32; 16]) -> [f32; 16] {
        std::array::from_fn(|at| a[at].mul_add(b[at], c[at]))
    }
    #[inline(always)]
    fn wide_add(self, a: [f32; 16], b: [f32; 16]) -> [f32; 16] {
        std::array::from_fn(|at| a[at] + b[at])
    }
    #[inline(always)]
    fn beside(self, rows: [[f64; WIDTH]; 2]) -> [f32; 16] {
        std::array::from_fn(|at| rows[at % 2][at / 2] as f32)
    }
    #[inline(always)]
    fn apart(self, value: [f32; 16]) -> [[f64; WIDTH]; 2] {
        std::array::from_fn(|row| std::array::from_fn(|at| f64::from(value[2 * at + row])))
    }
}
