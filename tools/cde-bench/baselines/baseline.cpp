// SPDX-License-Identifier: Apache-2.0
#include "baselines/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "baselines/baseline_kernel.hpp"
#include "cde/support/error.hpp"

namespace cde::baseline {
namespace {

#if defined(__x86_64__)
constexpr Kernel kKernels[] = {scalar_kernel, avx2_kernel, avx512_kernel};
#else
constexpr Kernel kKernels[] = {scalar_kernel, nullptr, nullptr};
#endif

}  // namespace

const char* name_of(Kind kind) {
  constexpr std::array kNames = {"scalar", "AVX2", "AVX-512"};
  return kNames.at(static_cast<std::size_t>(kind));
}

bool available(Kind kind) {
#if defined(__x86_64__)
  if (kind == Kind::kAvx2)
    return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  if (kind == Kind::kAvx512)
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
#endif
  return kind == Kind::kScalar;
}

std::vector<ClosestHit> closest(Kind kind, std::span<const Ray> rays,
                                std::span<const Triangle> triangles) {
  if (!available(kind))
    throw Error(ErrorCode::kUsage, fmt::format("this processor has no {}", name_of(kind)));
  static_assert(sizeof(Triangle) == 9 * sizeof(float));
  const auto* corners = reinterpret_cast<const float*>(triangles.data());
  std::vector<ClosestHit> hits(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += kTile) {
    const auto tile = std::make_unique<Tile>();
    tile->count = static_cast<unsigned>(std::min<std::size_t>(kTile, rays.size() - first));
    for (unsigned i = 0; i < tile->count; ++i) {
      const Ray& ray = rays[first + i];
      tile->ox[i] = ray.o.x(), tile->oy[i] = ray.o.y(), tile->oz[i] = ray.o.z();
      tile->dx[i] = ray.d.x(), tile->dy[i] = ray.d.y(), tile->dz[i] = ray.d.z();
      tile->tmin[i] = ray.tmin, tile->t[i] = ray.tmax;
    }
    std::fill(std::begin(tile->index), std::end(tile->index), ~0u);
    kKernels[static_cast<int>(kind)](*tile, corners, triangles.size());
    for (unsigned i = 0; i < tile->count; ++i) {
      if (tile->index[i] != ~0u) hits[first + i] = {tile->t[i], tile->index[i]};
    }
  }
  return hits;
}

}  // namespace cde::baseline
