// SPDX-License-Identifier: Apache-2.0
#include "cde/image/image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cde/support/error.hpp"

namespace cde {
namespace {

using Eigen::Vector3f;

/// Colours are linear light until the image is written.
Vector3f linear(float r, float g, float b) {
  const auto decode = [](float c) {
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
  };
  return {decode(r / 255.0f), decode(g / 255.0f), decode(b / 255.0f)};
}

std::uint8_t encode(float c) {
  c = std::clamp(c, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(s * 255.0f + 0.5f);
}

Vector3f mix(const Vector3f& a, const Vector3f& b, float t) {
  return a + (b - a) * std::clamp(t, 0.0f, 1.0f);
}

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// Compresses highlights instead of clipping them, per channel (Narkowicz's fit of the ACES curve).
Vector3f tone_map(const Vector3f& c) {
  const auto x = c.array().max(0.0f) * 0.8f;
  return (x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f)).matrix();
}

template <typename Row>
void check_span(const Row& span, const PixelHits& hits, const char* field) {
  if (span.size() != hits.size.pixels()) {
    throw Error(ErrorCode::kUsage,
                fmt::format("picture of {} x {}: {} has {} entries", hits.size.width,
                            hits.size.height, field, span.size()));
  }
}

/// Area-weighted vertex normals. They use binary64, because areas of small far triangles underflow
/// in binary32.
std::vector<Vector3f> vertex_normals(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    const Eigen::Vector3d n = (t.v1 - t.v0).cast<double>().cross((t.v2 - t.v0).cast<double>());
    for (const auto corner : mesh.faces[i]) sums[corner] += n;
  }
  std::vector<Vector3f> normals;
  normals.reserve(sums.size());
  for (const auto& n : sums) normals.push_back(n.normalized().cast<float>());
  return normals;
}

Vector3f face_normal(const Mesh& mesh, std::uint32_t face) {
  const Triangle t = mesh.triangle(face);
  return (t.v1 - t.v0)
      .cast<double>()
      .cross((t.v2 - t.v0).cast<double>())
      .normalized()
      .cast<float>();
}

/// The interpolated normal at a point of a face. At edges sharper than about 40 degrees the face
/// keeps its own normal.
Vector3f smooth_normal(const Mesh& mesh, const std::vector<Vector3f>& normals, std::uint32_t face,
                       const Vector3f& point) {
  constexpr float kCrease =
      0.94f;  // cosine of half of 40 degrees: the vertex normal lies between the two face normals
  const Triangle t = mesh.triangle(face);
  Vector3f own = face_normal(mesh, face);
  const Eigen::Vector3d a = t.v0.cast<double>(), b = t.v1.cast<double>(), c = t.v2.cast<double>(),
                        p = point.cast<double>();
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double area = n.squaredNorm();
  if (!(area > 0.0)) return own;
  const double w0 = (b - p).cross(c - p).dot(n) / area;
  const double w1 = (c - p).cross(a - p).dot(n) / area;
  const double weights[3] = {w0, w1, 1.0 - w0 - w1};
  Vector3f sum = Vector3f::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3f& v = normals[mesh.faces[face][i]];
    sum += static_cast<float>(std::clamp(weights[i], 0.0, 1.0)) * (v.dot(own) < kCrease ? own : v);
  }
  return sum.normalized();
}

/// Cheap value noise that breaks up bands of one colour.
float grain(const Vector3f& p) {
  const auto lattice = [](std::int64_t x, std::int64_t y) {
    auto h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
             static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu;
    h = (h ^ h >> 31) * 0xbf58476d1ce4e5b9u;
    return static_cast<float>(h >> 40) * 0x1p-24f;
  };
  const float x = std::floor(p.x()), y = std::floor(p.y());
  if (!(std::fabs(x) < 1e15f && std::fabs(y) < 1e15f)) return 0.5f;
  const auto i = static_cast<std::int64_t>(x), j = static_cast<std::int64_t>(y);
  const float u = smoothstep(0, 1, p.x() - x), v = smoothstep(0, 1, p.y() - y);
  const float low = lattice(i, j) + (lattice(i + 1, j) - lattice(i, j)) * u;
  const float high = lattice(i, j + 1) + (lattice(i + 1, j + 1) - lattice(i, j + 1)) * u;
  return low + (high - low) * v;
}

/// Meadows at the bottom, forest, rock on steep or high ground, snow at the top.
Vector3f landscape(float height, float flatness, float noise) {
  static const Vector3f kSand = linear(172, 156, 112), kMeadow = linear(118, 130, 76),
                        kForest = linear(62, 86, 52);
  static const Vector3f kHeath = linear(150, 134, 92), kRock = linear(128, 120, 112),
                        kSnow = linear(244, 246, 250);
  const float h = height + 0.10f * (noise - 0.5f);
  Vector3f c = mix(kSand, kMeadow, smoothstep(0.01f, 0.09f, h));
  c = mix(c, kForest, 0.85f * smoothstep(0.12f, 0.30f, h));
  c = mix(c, kHeath, smoothstep(0.40f, 0.62f, h));
  c = mix(c, kRock, smoothstep(0.62f, 0.80f, h));
  c = mix(c, kRock, 1.0f - smoothstep(0.62f, 0.82f, flatness + 0.06f * (noise - 0.5f)));
  c = mix(c, kSnow, smoothstep(0.66f, 0.78f, h) * smoothstep(0.58f, 0.76f, flatness));
  return c * (0.90f + 0.20f * noise);
}

struct Scene {
  Vector3f sun;
  Vector3f sky_zenith = linear(96, 144, 204);
  Vector3f sky_horizon = linear(206, 222, 236);
  float lowest = 0.0f;
  float range = 1.0f;
  float grain_scale = 1.0f;
  float nearest = std::numeric_limits<float>::infinity();
  float farthest = 0.0f;
};

Vector3f surface(const Scene& scene, const ShadeOptions& options, const Vector3f& normal,
                 const Vector3f& point, bool shadowed) {
  const float height = (point.z() - scene.lowest) / scene.range;
  const float noise =
      0.6f * grain(point * scene.grain_scale) + 0.4f * grain(point * (3.1f * scene.grain_scale));
  static const Vector3f kClay = linear(168, 152, 136);
  const Vector3f albedo =
      options.palette == Palette::kLandscape ? landscape(height, normal.z(), noise) : kClay;
  const float direct = shadowed ? 0.0f : std::max(0.0f, normal.dot(scene.sun));
  const float skyward = 0.5f + 0.5f * normal.z();
  // Light scattered back by the ground opposite the sun keeps shaded slopes readable.
  const float bounce =
      std::max(0.0f, normal.dot(Vector3f(-scene.sun.x(), -scene.sun.y(), 0.25f).normalized()));
  const Vector3f light = 1.95f * direct * Vector3f(1.0f, 0.93f, 0.80f) +
                         (0.18f + 0.42f * skyward) * Vector3f(0.62f, 0.78f, 1.0f) +
                         0.16f * bounce * Vector3f(1.0f, 0.88f, 0.72f);
  return albedo.cwiseProduct(light);
}

void draw_marker(Image& image, std::array<std::uint32_t, 2> centre) {
  constexpr float kRadius = 5.0f;
  for (int dy = -8; dy <= 8; ++dy) {
    for (int dx = -8; dx <= 8; ++dx) {
      const std::int64_t x = std::int64_t{centre[0]} + dx, y = std::int64_t{centre[1]} + dy;
      if (x < 0 || y < 0 || x >= image.size.width || y >= image.size.height) continue;
      const float off =
          std::fabs(std::hypot(static_cast<float>(dx), static_cast<float>(dy)) - kRadius);
      // A red ring with a white rim stands out on grass, rock and snow.
      const float white = std::clamp(2.9f - off, 0.0f, 1.0f),
                  red = std::clamp(1.7f - off, 0.0f, 1.0f);
      auto& pixel =
          image
              .pixels[static_cast<std::size_t>(y) * image.size.width + static_cast<std::size_t>(x)];
      const std::array<float, 3> kRed = {214, 32, 40};
      for (std::size_t c = 0; c < 3; ++c) {
        float value = pixel[c];
        value += (255.0f - value) * white;
        value += (kRed[c] - value) * red;
        pixel[c] = static_cast<std::uint8_t>(value + 0.5f);
      }
    }
  }
}

void check_hits(const PixelHits& hits) {
  check_span(hits.rays, hits, "rays");
  check_span(hits.hit, hits, "hit");
  check_span(hits.t, hits, "t");
  check_span(hits.index, hits, "index");
  check_span(hits.point, hits, "point");
}

void check_index(const PixelHits& hits, std::size_t i, const Mesh& mesh) {
  if (hits.index[i] >= mesh.faces.size()) {
    throw Error(ErrorCode::kBadInput, fmt::format("pixel {}: face {}, but there are {} faces", i,
                                                  hits.index[i], mesh.faces.size()));
  }
}

Vector3f unit_sun(const Vector3f& sun) {
  if (!sun.allFinite() || sun.isZero(0.0f))
    throw Error(ErrorCode::kUsage, "the direction to the sun must be finite and not zero");
  return sun.cast<double>().normalized().cast<float>();
}

Scene scene_of(const PixelHits& hits, const Mesh& mesh, const ShadeOptions& options) {
  Scene scene;
  scene.sun = unit_sun(options.sun);
  const Eigen::AlignedBox3f box = bounds(mesh);
  if (!box.isEmpty()) {
    scene.lowest = box.min().z();
    scene.range = std::max(box.sizes().z(), std::numeric_limits<float>::min());
    scene.grain_scale = 80.0f / std::max(box.sizes().maxCoeff(), std::numeric_limits<float>::min());
  }
  for (std::size_t i = 0; i < hits.t.size(); ++i) {
    if (hits.hit[i] == 0) continue;
    scene.nearest = std::min(scene.nearest, hits.t[i]);
    scene.farthest = std::max(scene.farthest, hits.t[i]);
  }
  return scene;
}

}  // namespace

Image shade(const PixelHits& hits, const Mesh& mesh, const ShadeOptions& options) {
  check_hits(hits);
  if (!options.shadow.empty()) check_span(options.shadow, hits, "shadow");
  const Scene scene = scene_of(hits, mesh, options);
  const std::vector<Vector3f> normals = vertex_normals(mesh);
  Image image{hits.size, std::vector<std::array<std::uint8_t, 3>>(hits.size.pixels())};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const float down =
        static_cast<float>(i / hits.size.width) / static_cast<float>(hits.size.height);
    const Vector3f sky = mix(scene.sky_zenith, scene.sky_horizon, 1.25f * down);
    Vector3f colour = sky;
    if (hits.hit[i] != 0) {
      check_index(hits, i, mesh);
      Vector3f normal = smooth_normal(mesh, normals, hits.index[i], hits.point[i]);
      if (options.palette == Palette::kLandscape && normal.z() < 0.0f)
        normal = -normal;  // two-sided ground
      const bool shadowed = !options.shadow.empty() && options.shadow[i] != 0;
      colour = tone_map(surface(scene, options, normal, hits.point[i], shadowed));
      if (options.haze && scene.farthest > scene.nearest) {
        const float depth = (hits.t[i] - scene.nearest) / (scene.farthest - scene.nearest);
        colour = mix(colour, scene.sky_horizon, 0.30f * depth * depth);
      }
    }
    for (int c = 0; c < 3; ++c) image.pixels[i][static_cast<std::size_t>(c)] = encode(colour[c]);
  }
  for (const auto& marker : options.markers) draw_marker(image, marker);
  return image;
}

GreyImage depth_image(const PixelHits& hits) {
  check_span(hits.hit, hits, "hit");
  check_span(hits.t, hits, "t");
  constexpr double kNear = 65535.0, kFar = 8192.0;
  double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (std::size_t i = 0; i < hits.t.size(); ++i) {
    if (hits.hit[i] == 0) continue;
    nearest = std::min<double>(nearest, hits.t[i]);
    farthest = std::max<double>(farthest, hits.t[i]);
  }
  GreyImage image{hits.size, std::vector<std::uint16_t>(hits.size.pixels(), 0)};
  for (std::size_t i = 0; i < hits.t.size(); ++i) {
    if (hits.hit[i] == 0) continue;
    const double depth = farthest > nearest ? (hits.t[i] - nearest) / (farthest - nearest) : 0.0;
    image.pixels[i] = static_cast<std::uint16_t>(std::lround(kNear + (kFar - kNear) * depth));
  }
  return image;
}

std::vector<Ray> sun_rays(const PixelHits& hits, const Mesh& mesh, const Vector3f& sun,
                          float offset) {
  check_hits(hits);
  const Vector3f direction = unit_sun(sun);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<Ray> rays(hits.size.pixels(), {Vector3f::Zero(), direction, kInfinity, 0.0f});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits.hit[i] == 0) continue;
    check_index(hits, i, mesh);
    const Vector3f normal = face_normal(mesh, hits.index[i]);
    const float side = normal.dot(hits.rays[i].d) > 0.0f ? -offset : offset;
    rays[i] = {hits.point[i] + side * normal, direction};
  }
  return rays;
}

}  // namespace cde
