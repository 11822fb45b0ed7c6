//! Eight numbers at a time: the arithmetic that every kernel of the solver is written in.
//!
//! Blocks of vectors are kept as rows of eight contiguous values, one per vector. A row is one AVX-512 register, two
//! AVX2 registers or an array that the compiler makes the best of. The choice is made at run time; the results of the
//! first two are the same bits, because both fuse every multiplication with its addition in the same order.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{__m256d, __m512d};

/// Vectors per block.
pub(super) const WIDTH: usize = 8;

/// One row of a block: entry i of eight vectors.
pub(super) type Row = [f64; WIDTH];

/// Numbers that start at a cache line, so that no row straddles two.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    data: Vec<f64>,
    offset: usize,
    len: usize,
}

impl Buffer {
    /// At least this many numbers; what was in it is lost when it has to grow.
    pub(super) fn reserve(&mut self, len: usize) {
        if self.data.len() < len + WIDTH {
            self.data = vec![0.0; len + WIDTH];
            let away = self.data.as_ptr().align_offset(64);
            self.offset = if away < WIDTH { away } else { 0 };
        }
        self.len = len;
    }

    /// All numbers.
    #[inline(always)]
    pub(super) fn flat(&mut self) -> &mut [f64] {
        &mut self.data[self.offset..self.offset + self.len]
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(super) fn rows(&self) -> &[Row] {
        self.data[self.offset..self.offset + self.len].as_chunks().0
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(super) fn rows_mut(&mut self) -> &mut [Row] {
        self.data[self.offset..self.offset + self.len].as_chunks_mut().0
    }
}

/// Arithmetic on rows held in registers.
pub(super) trait Lanes: Copy {
    /// Eight numbers in registers.
    type Reg: Copy;
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
    fn mul(self, a: Self::Reg, b: Self::Reg) -> Self::Reg;

    #[inline(always)]
    fn zero(self) -> Self::Reg {
        self.splat(0.0)
    }
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
        if let Some(simd) = pulp::x86::V4::try_new() {
            return simd.vectorize(Wide(kernel, Avx512(simd)));
        }
        if let Some(simd) = pulp::x86::V3::try_new() {
            return simd.vectorize(Wide(kernel, Avx2(simd)));
        }
    }
    kernel.run(Plain)
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx512(pulp::x86::V4);

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx512 {
    type Reg = __m512d;
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
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx2(pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx2 {
    type Reg = [__m256d; 2];
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
}

/// Arrays, for processors without the above: not fused, since that would be a call into a library.
#[derive(Clone, Copy)]
struct Plain;

impl Lanes for Plain {
    type Reg = [f64; WIDTH];
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
        std::array::from_fn(|at| a[at] * b[at] + c[at])
    }
    #[inline(always)]
    fn sub_mul(self, c: [f64; WIDTH], a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| c[at] - a[at] * b[at])
    }
    #[inline(always)]
    fn sub(self, a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at] - b[at])
    }
    #[inline(always)]
    fn mul(self, a: [f64; WIDTH], b: [f64; WIDTH]) -> [f64; WIDTH] {
        std::array::from_fn(|at| a[at] * b[at])
    }
}
