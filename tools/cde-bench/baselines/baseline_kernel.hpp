// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

/// Interface between baseline.cpp and the kernels. Kernels are compiled for specific processors.
/// The interface has only plain pointers, so that no inline function of a kernel is linked into
/// other code.
namespace cde::baseline {

inline constexpr unsigned kTile = 256;

/// Up to kTile rays by component. Unused places have a zero direction and never hit.
struct Tile {
  alignas(64) float ox[kTile], oy[kTile], oz[kTile], dx[kTile], dy[kTile], dz[kTile], tmin[kTile],
      t[kTile];
  alignas(64) std::uint32_t index[kTile];
  unsigned count;
};

/// `triangles` has 9 floats per triangle. `t` is tmax on entry and the nearest hit on return.
using Kernel = void (*)(Tile& tile, const float* triangles, std::size_t count);
void scalar_kernel(Tile& tile, const float* triangles, std::size_t count);
void avx2_kernel(Tile& tile, const float* triangles, std::size_t count);
void avx512_kernel(Tile& tile, const float* triangles, std::size_t count);

/// The loop of both vector kernels. `S` has the operations of an instruction set.
template <typename S>
inline __attribute__((always_inline)) void vector_kernel(Tile& r, const float* tri,
                                                         std::size_t count) {
  using V = typename S::V;
  for (std::size_t n = 0; n < count; ++n, tri += 9) {
    const V x0 = S::set(tri[0]), y0 = S::set(tri[1]), z0 = S::set(tri[2]);
    const V ax = S::set(tri[3] - tri[0]), ay = S::set(tri[4] - tri[1]),
            az = S::set(tri[5] - tri[2]);
    const V bx = S::set(tri[6] - tri[0]), by = S::set(tri[7] - tri[1]),
            bz = S::set(tri[8] - tri[2]);
    for (unsigned i = 0; i < r.count; i += S::kWidth) {
      const V dx = S::load(r.dx + i), dy = S::load(r.dy + i), dz = S::load(r.dz + i);
      const V tx = S::sub(S::load(r.ox + i), x0), ty = S::sub(S::load(r.oy + i), y0),
              tz = S::sub(S::load(r.oz + i), z0);
      const V px = S::cross(dy, bz, dz, by), py = S::cross(dz, bx, dx, bz),
              pz = S::cross(dx, by, dy, bx);
      const V det = S::dot(px, ax, py, ay, pz, az);
      const V u = S::flip(S::dot(px, tx, py, ty, pz, tz), det);
      const V qx = S::cross(ty, az, tz, ay), qy = S::cross(tz, ax, tx, az),
              qz = S::cross(tx, ay, ty, ax);
      const V v = S::flip(S::dot(qx, dx, qy, dy, qz, dz), det);
      const auto inside = S::inside(u, v, S::abs(det));
      if (S::none(inside)) [[likely]]
        continue;
      const V t = S::div(S::dot(qx, bx, qy, by, qz, bz), det);
      S::update(inside, t, r.tmin + i, r.t + i, r.index + i, static_cast<std::uint32_t>(n));
    }
  }
}

}  // namespace cde::baseline
