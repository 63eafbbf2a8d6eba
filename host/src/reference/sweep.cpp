// SPDX-License-Identifier: Apache-2.0
// The inside test of ray_triangle_moller (reference.hpp) for a packet of rays, in a form that
// compilers turn into vector code: the same operations on every ray, no branch. tests/board holds
// it against the template bit for bit.
#include "reference/sweep.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cde::reference {
namespace {

constexpr unsigned kBlock = 64;

std::uint32_t bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}
float flip(float x, std::uint32_t sign) {
  return std::bit_cast<float>(bits(x) ^ sign);
}

}  // namespace

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
bool inside(const RayBlock& r, const Triangle& triangle, std::array<std::uint8_t, RayBlock::kRays>& mask) {
  const float x0 = triangle.v0.x(), y0 = triangle.v0.y(), z0 = triangle.v0.z();
  const float e1x = triangle.v1.x() - x0, e1y = triangle.v1.y() - y0, e1z = triangle.v1.z() - z0;
  const float e2x = triangle.v2.x() - x0, e2y = triangle.v2.y() - y0, e2z = triangle.v2.z() - z0;
  std::uint32_t any = 0;
  for (unsigned base = 0; base < r.count; base += kBlock) {
    alignas(64) std::uint32_t hit[kBlock];
    std::uint32_t some = 0;
    for (unsigned j = 0; j < kBlock; ++j) {
      const unsigned i = base + j;
      const float tx = r.ox[i] - x0, ty = r.oy[i] - y0, tz = r.oz[i] - z0;
      const float dx = r.dx[i], dy = r.dy[i], dz = r.dz[i];
      const float px = dy * e2z - dz * e2y, py = dz * e2x - dx * e2z, pz = dx * e2y - dy * e2x;
      const float qx = ty * e1z - tz * e1y, qy = tz * e1x - tx * e1z, qz = tx * e1y - ty * e1x;
      const float det = (px * e1x + py * e1y) + pz * e1z;
      const float u = (px * tx + py * ty) + pz * tz;
      const float v = (qx * dx + qy * dy) + qz * dz;
      const std::uint32_t sign = bits(det) & 0x80000000u;
      const float size = flip(det, sign), us = flip(u, sign), vs = flip(v, sign),
                  uvs = flip(u + v, sign);
      const std::uint32_t h =
          static_cast<std::uint32_t>(0.0f <= us) & static_cast<std::uint32_t>(us <= size) &
          static_cast<std::uint32_t>(0.0f <= vs) & static_cast<std::uint32_t>(vs <= size) &
          static_cast<std::uint32_t>(uvs <= size) & static_cast<std::uint32_t>(0.0f < size);
      hit[j] = h;
      some |= h;
    }
    // Nearly every block has no hit at all.
    if (some != 0) {
      for (unsigned j = 0; j < kBlock; ++j) mask[base + j] = static_cast<std::uint8_t>(hit[j]);
    } else if (any != 0) {
      std::fill_n(mask.begin() + base, kBlock, std::uint8_t{0});
    }
    if (some != 0 && any == 0) std::fill_n(mask.begin(), base, std::uint8_t{0});
    any |= some;
  }
  return any != 0;
}

}  // namespace cde::reference
