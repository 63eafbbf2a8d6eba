// SPDX-License-Identifier: Apache-2.0
// Compiled without vectorisation: one pair at a time, as a careful programmer would write it.
#include "baselines/baseline_kernel.hpp"

namespace cde::baseline {

void scalar_kernel(Tile& r, const float* tri, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n, tri += 9) {
    const float x0 = tri[0], y0 = tri[1], z0 = tri[2];
    const float ax = tri[3] - x0, ay = tri[4] - y0, az = tri[5] - z0;
    const float bx = tri[6] - x0, by = tri[7] - y0, bz = tri[8] - z0;
    for (unsigned i = 0; i < r.count; ++i) {
      const float dx = r.dx[i], dy = r.dy[i], dz = r.dz[i];
      const float px = dy * bz - dz * by, py = dz * bx - dx * bz, pz = dx * by - dy * bx;
      const float det = px * ax + py * ay + pz * az;
      const float tx = r.ox[i] - x0, ty = r.oy[i] - y0, tz = r.oz[i] - z0;
      // Scaled by det, the test is 0 <= u det <= det^2, without a branch on the sign of det.
      const float u = (px * tx + py * ty + pz * tz) * det, square = det * det;
      if (u < 0 || u > square) continue;
      const float qx = ty * az - tz * ay, qy = tz * ax - tx * az, qz = tx * ay - ty * ax;
      const float v = (qx * dx + qy * dy + qz * dz) * det;
      if (v < 0 || u + v > square || det == 0) continue;
      const float t = (qx * bx + qy * by + qz * bz) / det;
      if (t >= r.tmin[i] && (t < r.t[i] || (t == r.t[i] && r.index[i] == ~0u))) {
        r.t[i] = t;
        r.index[i] = static_cast<std::uint32_t>(n);
      }
    }
  }
}

}  // namespace cde::baseline
