// SPDX-License-Identifier: Apache-2.0
#include <immintrin.h>

#include "baselines/baseline_kernel.hpp"

namespace cde::baseline {
namespace {

struct Avx2 {
  using V = __m256;
  static constexpr unsigned kWidth = 8;
  static V set(float x) { return _mm256_set1_ps(x); }
  static V load(const float* p) { return _mm256_load_ps(p); }
  static V sub(V a, V b) { return _mm256_sub_ps(a, b); }
  static V div(V a, V b) { return _mm256_div_ps(a, b); }
  static V cross(V a, V b, V c, V d) { return _mm256_fmsub_ps(a, b, _mm256_mul_ps(c, d)); }
  static V dot(V a, V b, V c, V d, V e, V f) {
    return _mm256_fmadd_ps(a, b, _mm256_fmadd_ps(c, d, _mm256_mul_ps(e, f)));
  }
  static V sign() { return _mm256_set1_ps(-0.0f); }
  static V flip(V x, V det) { return _mm256_xor_ps(x, _mm256_and_ps(det, sign())); }
  static V abs(V x) { return _mm256_andnot_ps(sign(), x); }
  static V inside(V u, V v, V size) {
    const V zero = _mm256_setzero_ps();
    const V low =
        _mm256_and_ps(_mm256_cmp_ps(u, zero, _CMP_GE_OQ), _mm256_cmp_ps(v, zero, _CMP_GE_OQ));
    const V high = _mm256_and_ps(_mm256_cmp_ps(_mm256_add_ps(u, v), size, _CMP_LE_OQ),
                                 _mm256_cmp_ps(size, zero, _CMP_GT_OQ));
    return _mm256_and_ps(low, high);
  }
  static bool none(V mask) { return _mm256_movemask_ps(mask) == 0; }
  static void update(V mask, V t, const float* tmin, float* best, std::uint32_t* index,
                     std::uint32_t n) {
    const V old = load(best);
    const __m256i old_index = _mm256_load_si256(reinterpret_cast<const __m256i*>(index));
    const V first = _mm256_castsi256_ps(_mm256_cmpeq_epi32(old_index, _mm256_set1_epi32(-1)));
    const V tie = _mm256_and_ps(_mm256_cmp_ps(t, old, _CMP_EQ_OQ), first);
    const V better = _mm256_or_ps(_mm256_cmp_ps(t, old, _CMP_LT_OQ), tie);
    mask = _mm256_and_ps(_mm256_and_ps(mask, better), _mm256_cmp_ps(t, load(tmin), _CMP_GE_OQ));
    _mm256_store_ps(best, _mm256_blendv_ps(old, t, mask));
    const __m256i chosen = _mm256_blendv_epi8(old_index, _mm256_set1_epi32(static_cast<int>(n)),
                                              _mm256_castps_si256(mask));
    _mm256_store_si256(reinterpret_cast<__m256i*>(index), chosen);
  }
};

}  // namespace

void avx2_kernel(Tile& tile, const float* triangles, std::size_t count) {
  vector_kernel<Avx2>(tile, triangles, count);
}

}  // namespace cde::baseline
