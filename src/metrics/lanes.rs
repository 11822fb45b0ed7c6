//! What pulp has no word for.

use std::any::Any;

use pulp::{Simd, bytemuck::cast};

/// `sums`, and `more` on top in the lanes of `mask`: one instruction where there are registers for masks, of which a
/// compiler that is told of an addition and a selection makes two.
#[inline(always)]
pub(crate) fn add_where_u32s<S: Simd>(simd: S, mask: S::m32s, sums: S::u32s, more: S::u32s) -> S::u32s {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(v4) = (&simd as &dyn Any).downcast_ref::<pulp::x86::V4>() {
        return cast(v4.avx512f._mm512_mask_add_epi32(cast(sums), cast(mask), cast(sums), cast(more)));
    }
    simd.select_u32s(mask, simd.add_u32s(sums, more), sums)
}

/// The same for wider lanes.
#[inline(always)]
pub(crate) fn add_where_u64s<S: Simd>(simd: S, mask: S::m64s, sums: S::u64s, more: S::u64s) -> S::u64s {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(v4) = (&simd as &dyn Any).downcast_ref::<pulp::x86::V4>() {
        return cast(v4.avx512f._mm512_mask_add_epi64(cast(sums), cast(mask), cast(sums), cast(more)));
    }
    simd.select_u64s(mask, simd.add_u64s(sums, more), sums)
}

/// How many lanes of a mask are set.
#[inline(always)]
pub(crate) fn count_u32s<S: Simd>(simd: S, mask: S::m32s) -> usize {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if (&simd as &dyn Any).is::<pulp::x86::V4>() {
        return cast::<_, u16>(mask).count_ones() as usize;
    }
    let ones = [simd.select_u32s(mask, simd.splat_u32s(1), simd.splat_u32s(0))];
    bytemuck::cast_slice::<_, u32>(&ones).iter().sum::<u32>() as usize
}
