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
use std::arch::x86_64::{__m128, __m256, __m256d, __m512, __m512d, _MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};

pub(super) use self::buffer::Buffer;

mod buffer;

/// Vectors per block.
pub(super) const WIDTH: usize = 8;

/// One row of a block: entry i of eight vectors.
pub(super) type Row = [f64; WIDTH];

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
    fn wide(self, values: &[f32; 16]) -> Self::Wide;
    fn wide_splat(self, value: f32) -> Self::Wide;
    fn wide_row(self, value: Self::Wide) -> [f32; 16];
    /// `a b + c`
    fn wide_add_mul(self, c: Self::Wide, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// Has these numbers fetched to the first cache, for they are needed soon, where [`MANY`](Self::MANY).
    fn fetch(self, _values: &[f32; 16]) {}
    /// The same for the second cache, where there is room for more.
    fn fetch_near(self, _values: &[f32; 16]) {}
    fn wide_add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// Two rows in single precision, the second behind the first.
    fn narrow(self, rows: [Self::Reg; 2]) -> Self::Wide;
    /// The first and the last eight in double precision.
    fn widen(self, value: Self::Wide) -> [Self::Reg; 2];
    /// Sixteen rows, rounded to single precision, as eight columns.
    fn columns(self, rows: &[Row; 16]) -> [Self::Wide; WIDTH];
    /// Eight columns as sixteen rows in double precision.
    fn rows(self, columns: [Self::Wide; WIDTH]) -> [Self::Reg; 16];

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
    fn wide(self, values: &[f32; 16]) -> __m512 {
        pulp::cast(*values)
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> __m512 {
        self.0.avx512f._mm512_set1_ps(value)
    }
    #[inline(always)]
    fn wide_row(self, value: __m512) -> [f32; 16] {
        pulp::cast(value)
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
    fn narrow(self, [a, b]: [__m512d; 2]) -> __m512 {
        pulp::cast([self.0.avx512f._mm512_cvtpd_ps(a), self.0.avx512f._mm512_cvtpd_ps(b)])
    }
    #[inline(always)]
    fn fetch(self, values: &[f32; 16]) {
        fetch::<_MM_HINT_T0>(values);
    }
    #[inline(always)]
    fn fetch_near(self, values: &[f32; 16]) {
        fetch::<_MM_HINT_T1>(values);
    }
    #[inline(always)]
    fn widen(self, value: __m512) -> [__m512d; 2] {
        let halves: [__m256; 2] = pulp::cast(value);
        halves.map(|half| self.0.avx512f._mm512_cvtps_pd(half))
    }
    #[inline(always)]
    fn columns(self, rows: &[Row; 16]) -> [__m512; WIDTH] {
        let mut halves = [[pulp::cast([0.0_f32; 8]); 8]; 2];
        for (row, to) in rows.iter().zip(halves.as_flattened_mut()) {
            *to = self.0.avx512f._mm512_cvtpd_ps(self.load(row));
        }
        let (low, high) = (transpose(self.0.avx, halves[0]), transpose(self.0.avx, halves[1]));
        std::array::from_fn(|at| pulp::cast([low[at], high[at]]))
    }
    #[inline(always)]
    fn rows(self, columns: [__m512; WIDTH]) -> [__m512d; 16] {
        let halves: [[__m256; 2]; WIDTH] = columns.map(pulp::cast);
        let low = transpose(self.0.avx, halves.map(|[low, _]| low));
        let high = transpose(self.0.avx, halves.map(|[_, high]| high));
        std::array::from_fn(|at| self.0.avx512f._mm512_cvtps_pd(if at < 8 { low[at] } else { high[at - 8] }))
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
    fn wide(self, values: &[f32; 16]) -> [__m256; 2] {
        let (halves, _) = values.as_chunks::<8>();
        [pulp::cast(halves[0]), pulp::cast(halves[1])]
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> [__m256; 2] {
        [self.0.avx._mm256_set1_ps(value); 2]
    }
    #[inline(always)]
    fn wide_row(self, value: [__m256; 2]) -> [f32; 16] {
        pulp::cast(value)
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
    fn narrow(self, [a, b]: [[__m256d; 2]; 2]) -> [__m256; 2] {
        [self.singles(a), self.singles(b)]
    }
    #[inline(always)]
    fn widen(self, value: [__m256; 2]) -> [[__m256d; 2]; 2] {
        value.map(|half| self.doubles(half))
    }
    #[inline(always)]
    fn columns(self, rows: &[Row; 16]) -> [[__m256; 2]; WIDTH] {
        let mut halves = [[pulp::cast([0.0_f32; 8]); 8]; 2];
        for (row, to) in rows.iter().zip(halves.as_flattened_mut()) {
            *to = self.singles(self.load(row));
        }
        let (low, high) = (transpose(self.0.avx, halves[0]), transpose(self.0.avx, halves[1]));
        std::array::from_fn(|at| [low[at], high[at]])
    }
    #[inline(always)]
    fn rows(self, columns: [[__m256; 2]; WIDTH]) -> [[__m256d; 2]; 16] {
        let low = transpose(self.0.avx, columns.map(|[low, _]| low));
        let high = transpose(self.0.avx, columns.map(|[_, high]| high));
        std::array::from_fn(|at| self.doubles(if at < 8 { low[at] } else { high[at - 8] }))
    }
}

#[cfg(target_arch = "x86_64")]
impl Avx2 {
    #[inline(always)]
    fn singles(self, [low, high]: [__m256d; 2]) -> __m256 {
        pulp::cast([self.0.avx._mm256_cvtpd_ps(low), self.0.avx._mm256_cvtpd_ps(high)])
    }
    #[inline(always)]
    fn doubles(self, value: __m256) -> [__m256d; 2] {
        let [low, high]: [__m128; 2] = pulp::cast(value);
        [self.0.avx._mm256_cvtps_pd(low), self.0.avx._mm256_cvtps_pd(high)]
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn fetch<const HINT: i32>(values: &[f32; 16]) {
    #[expect(unsafe_code, reason = "the instruction has no safe name")]
    // SAFETY: it may be given any address, and changes nothing but what a cache holds.
    unsafe {
        _mm_prefetch::<HINT>(values.as_ptr().cast());
    }
}

/// Eight by eight numbers, turned over.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn transpose(avx: pulp::core_arch::x86::Avx, rows: [__m256; 8]) -> [__m256; 8] {
    let [a, b, c, d, e, f, g, h] = rows;
    let pairs = |x, y| (avx._mm256_unpacklo_ps(x, y), avx._mm256_unpackhi_ps(x, y));
    // Two rows, then four, then eight in a register.
    let fours = |(xl, xh), (yl, yh)| {
        [
            avx._mm256_shuffle_ps::<0x44>(xl, yl),
            avx._mm256_shuffle_ps::<0xee>(xl, yl),
            avx._mm256_shuffle_ps::<0x44>(xh, yh),
            avx._mm256_shuffle_ps::<0xee>(xh, yh),
        ]
    };
    let upper = fours(pairs(a, b), pairs(c, d));
    let lower = fours(pairs(e, f), pairs(g, h));
    std::array::from_fn(|at| {
        if at < 4 {
            avx._mm256_permute2f128_ps::<0x20>(upper[at], lower[at])
        } else {
            avx._mm256_permute2f128_ps::<0x31>(upper[at - 4], lower[at - 4])
        }
    })
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
    fn wide(self, values: &[f32; 16]) -> [f32; 16] {
        *values
    }
    #[inline(always)]
    fn wide_splat(self, value: f32) -> [f32; 16] {
        [value; 16]
    }
    #[inline(always)]
    fn wide_row(self, value: [f32; 16]) -> [f32; 16] {
        value
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
    fn narrow(self, rows: [[f64; WIDTH]; 2]) -> [f32; 16] {
        std::array::from_fn(|at| rows[at / WIDTH][at % WIDTH] as f32)
    }
    #[inline(always)]
    fn widen(self, value: [f32; 16]) -> [[f64; WIDTH]; 2] {
        std::array::from_fn(|half| std::array::from_fn(|at| f64::from(value[8 * half + at])))
    }
    #[inline(always)]
    fn columns(self, rows: &[Row; 16]) -> [[f32; 16]; WIDTH] {
        std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column] as f32))
    }
    #[inline(always)]
    fn rows(self, columns: [[f32; 16]; WIDTH]) -> [[f64; WIDTH]; 16] {
        std::array::from_fn(|row| std::array::from_fn(|column| f64::from(columns[column][row])))
    }
}
