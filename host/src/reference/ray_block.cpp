// SPDX-License-Identifier: Apache-2.0
// The inside tests of ray_triangle_moller and ray_triangle_watertight for a packet of rays, written
// for vectorisation: every ray gets the same operations, without branches. The results equal the
// templates bit for bit.
#include "reference/ray_block.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "cde/reference/pipes/ray_triangle.hpp"

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
#define CDE_VECTOR __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CDE_VECTOR
#endif

void RayBlock::set(std::size_t i, const Ray& ray) {
  ox[i] = ray.o.x(), oy[i] = ray.o.y(), oz[i] = ray.o.z();
  dx[i] = ray.d.x(), dy[i] = ray.d.y(), dz[i] = ray.d.z();
  const DominantAxis<float> of(ray.d);
  axis[i] = of.z_over_both ? 2 : of.y_over_x ? 1 : 0;
  const float sz = 1.0f / of.largest(ray.d);
  sx[i] = of.next(ray.d) * sz, sy[i] = of.after_next(ray.d) * sz;
}

namespace {

using HitMask = std::array<std::uint8_t, RayBlock::kRays>;

/// Writes a block's hits. Most blocks have no hit, so bytes are written only if this block or an
/// earlier one has a hit.
void note(HitMask& mask, unsigned base, const std::uint32_t* hit, std::uint32_t some,
          std::uint32_t any) {
  if (some != 0) {
    for (unsigned j = 0; j < kBlock; ++j) mask[base + j] = static_cast<std::uint8_t>(hit[j]);
    if (any == 0) std::fill_n(mask.begin(), base, std::uint8_t{0});
  } else if (any != 0) {
    std::fill_n(mask.begin() + base, kBlock, std::uint8_t{0});
  }
}

CDE_VECTOR
bool inside_moller(const RayBlock& r, const Triangle& triangle, HitMask& mask) {
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
    note(mask, base, hit, some, any);
    any |= some;
  }
  return any != 0;
}

/// The value that belongs to this axis.
inline float picked(std::uint32_t axis, float of_x, float of_y, float of_z) {
  return axis == 2 ? of_z : axis == 1 ? of_y : of_x;
}

CDE_VECTOR
bool inside_watertight(const RayBlock& r, const Triangle& triangle, HitMask& mask) {
  const Eigen::Vector3f &v0 = triangle.v0, &v1 = triangle.v1, &v2 = triangle.v2;
  const float x0 = v0.x(), y0 = v0.y(), z0 = v0.z(), x1 = v1.x(), y1 = v1.y(), z1 = v1.z(),
              x2 = v2.x(), y2 = v2.y(), z2 = v2.z();
  std::uint32_t any = 0;
  for (unsigned base = 0; base < r.count; base += kBlock) {
    alignas(64) std::uint32_t hit[kBlock];
    std::uint32_t some = 0;
    for (unsigned j = 0; j < kBlock; ++j) {
      const unsigned i = base + j;
      const float ox = r.ox[i], oy = r.oy[i], oz = r.oz[i], sx = r.sx[i], sy = r.sy[i];
      const std::uint32_t k = r.axis[i];
      const float xa = x0 - ox, ya = y0 - oy, za = z0 - oz, xb = x1 - ox, yb = y1 - oy,
                  zb = z1 - oz, xc = x2 - ox, yc = y2 - oy, zc = z2 - oz;
      const float al = picked(k, xa, ya, za), bl = picked(k, xb, yb, zb),
                  cl = picked(k, xc, yc, zc);
      const float ax = picked(k, ya, za, xa) - sx * al, ay = picked(k, za, xa, ya) - sy * al;
      const float bx = picked(k, yb, zb, xb) - sx * bl, by = picked(k, zb, xb, yb) - sy * bl;
      const float cx = picked(k, yc, zc, xc) - sx * cl, cy = picked(k, zc, xc, yc) - sy * cl;
      const float u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
      const float det = (u + v) + w;
      const std::uint32_t sign = bits(det) & 0x80000000u;
      const std::uint32_t h = static_cast<std::uint32_t>(0.0f <= flip(u, sign)) &
                              static_cast<std::uint32_t>(0.0f <= flip(v, sign)) &
                              static_cast<std::uint32_t>(0.0f <= flip(w, sign)) &
                              static_cast<std::uint32_t>(0.0f < flip(det, sign));
      hit[j] = h;
      some |= h;
    }
    note(mask, base, hit, some, any);
    any |= some;
  }
  return any != 0;
}

}  // namespace

InsideTest inside_test(Algorithm algorithm) {
  return algorithm == Algorithm::kMoller       ? inside_moller
         : algorithm == Algorithm::kWatertight ? inside_watertight
                                               : nullptr;
}

}  // namespace cde::reference
