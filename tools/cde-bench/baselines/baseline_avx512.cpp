// SPDX-License-Identifier: Apache-2.0
#include <immintrin.h>

#include "baselines/baseline_kernel.hpp"

namespace cde::baseline {
namespace {

struct Avx512 {
  using V = __m512;
  static constexpr unsigned kWidth = 16;
  static V set(float x) { return _mm512_set1_ps(x); }
  static V load(const float* p) { return _mm512_load_ps(p); }
  static V sub(V a, V b) { return _mm512_sub_ps(a, b); }
  static V div(V a, V b) { return _mm512_div_ps(a, b); }
  static V cross(V a, V b, V c, V d) { return _mm512_fmsub_ps(a, b, _mm512_mul_ps(c, d)); }
  static V dot(V a, V b, V c, V d, V e, V f) {
    return _mm512_fmadd_ps(a, b, _mm512_fmadd_ps(c, d, _mm512_mul_ps(e, f)));
  }
  static V flip(V x, V det) {
    // x ^ (det & sign) is one instruction.
    const __m512i r = _mm512_ternarylogic_epi32(_mm512_castps_si512(x), _mm512_castps_si512(det),
                                                _mm512_set1_epi32(INT32_MIN), 0x78);
    return _mm512_castsi512_ps(r);
  }
  static V abs(V x) { return _mm512_abs_ps(x); }
  static __mmask16 inside(V u, V v, V size) {
    const V zero = _mm512_setzero_ps();
    __mmask16 m = _mm512_cmp_ps_mask(u, zero, _CMP_GE_OQ);
    m = _mm512_mask_cmp_ps_mask(m, v, zero, _CMP_GE_OQ);
    m = _mm512_mask_cmp_ps_mask(m, _mm512_add_ps(u, v), size, _CMP_LE_OQ);
    return _mm512_mask_cmp_ps_mask(m, size, zero, _CMP_GT_OQ);
  }
  static bool none(__mmask16 mask) { return mask == 0; }
  static void update(__mmask16 mask, V t, const float* tmin, float* best, std::uint32_t* index,
                     std::uint32_t n) {
    const V old = load(best);
    const __mmask16 first =
        _mm512_cmpeq_epi32_mask(_mm512_load_si512(index), _mm512_set1_epi32(-1));
    const __mmask16 tie = _mm512_mask_cmp_ps_mask(first, t, old, _CMP_EQ_OQ);
    const auto better = static_cast<__mmask16>(_mm512_cmp_ps_mask(t, old, _CMP_LT_OQ) | tie);
    mask =
        _mm512_mask_cmp_ps_mask(static_cast<__mmask16>(mask & better), t, load(tmin), _CMP_GE_OQ);
    _mm512_mask_store_ps(best, mask, t);
    _mm512_mask_store_epi32(index, mask, _mm512_set1_epi32(static_cast<int>(n)));
  }
};

}  // namespace

void avx512_kernel(Tile& tile, const float* triangles, std::size_t count) {
  vector_kernel<Avx512>(tile, triangles, count);
}

}  // namespace cde::baseline
