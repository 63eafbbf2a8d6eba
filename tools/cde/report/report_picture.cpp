// SPDX-License-Identifier: Apache-2.0
#include "report/report_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cde::cli {
namespace {

constexpr int kFine = 2;  // subpixels per pixel along a side
constexpr Colour kStage = {0.0052f, 0.0080f, 0.0120f};

std::uint8_t srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float y = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * y));
}

/// A surface of revolution: rows of points around the z axis, joined to a closed or open surface.
Surface turned(const std::vector<Eigen::Vector2f>& profile, std::uint32_t around) {
  Surface s;
  for (const Eigen::Vector2f& p : profile) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const float angle =
          2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(around);
      s.points.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  }
  for (std::uint32_t row = 0; row + 1 < profile.size(); ++row) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = row * around + i, b = row * around + (i + 1) % around;
      s.corners.insert(s.corners.end(), {a, b, b + around, a, b + around, a + around});
    }
  }
  return s;
}

}  // namespace

Surface unit_surface(Drawn drawn) {
  if (drawn == Drawn::kBall) {
    std::vector<Eigen::Vector2f> profile;
    for (int i = 0; i <= 10; ++i) {
      const float angle = std::numbers::pi_v<float> * static_cast<float>(i) / 10;
      profile.emplace_back(std::sin(angle), -std::cos(angle));
    }
    return turned(profile, 20);
  }
  if (drawn == Drawn::kCylinder) return turned({{0, -1}, {1, -1}, {1, 1}, {0, 1}}, 32);
  if (drawn == Drawn::kPlane)
    return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {0, 1, 2, 0, 2, 3}};
  Surface cube;
  for (int i = 0; i < 8; ++i)
    cube.points.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  cube.corners = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                  2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
  return cube;
}

Picture::Picture(const Camera& camera, Resolution size)
    : size_{kFine * size.width, kFine * size.height},
      eye_(camera.eye),
      colours_(size_.pixels(), kStage),
      depths_(size_.pixels(), INFINITY) {
  const Eigen::Vector3f forward = (camera.target - camera.eye).normalized();
  const Eigen::Vector3f right = forward.cross(camera.up).normalized();
  rotation_ << right.transpose(), right.cross(forward).transpose(), forward.transpose();
  const float half = std::tan(camera.fov_degrees * std::numbers::pi_v<float> / 360);
  scale_ = 0.5f * static_cast<float>(size_.height) / half;
  near_ = 1e-3f * (camera.target - camera.eye).norm();
}

Eigen::Vector3f Picture::in_view(const Eigen::Vector3f& point) const {
  return rotation_ * (point - eye_);
}

Picture::Seen Picture::project(const Eigen::Vector3f& view) const {
  const float x = scale_ * view.x() / view.z(), y = scale_ * view.y() / view.z();
  return {{0.5f * static_cast<float>(size_.width) + x, 0.5f * static_cast<float>(size_.height) - y},
          view.z()};
}

void Picture::pixel(int x, int y, float depth, const Colour& colour, float opacity, bool solid) {
  if (x < 0 || y < 0 || x >= static_cast<int>(size_.width) || y >= static_cast<int>(size_.height))
    return;
  const std::size_t i = static_cast<std::size_t>(y) * size_.width + static_cast<std::size_t>(x);
  if (depth >= depths_[i]) return;
  if (solid) depths_[i] = depth;
  for (int k = 0; k < 3; ++k) colours_[i][k] += opacity * (colour[k] - colours_[i][k]);
}

void Picture::triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                       const Colour& colour) {
  const Eigen::Vector3f va = in_view(a), vb = in_view(b), vc = in_view(c);
  if (std::min({va.z(), vb.z(), vc.z()}) < near_) return;
  const Eigen::Vector3f n = (b - a).cross(c - a).normalized();
  if (!n.allFinite()) return;
  const Eigen::Vector3f sun = Eigen::Vector3f(-0.55f, 0.35f, 0.62f).normalized();
  const float towards = n.dot(eye_ - a) < 0 ? -1.0f : 1.0f;  // the visible side
  const float light = 0.22f + 0.78f * std::max(0.0f, towards * n.dot(sun));
  const Colour lit = {light * colour[0], light * colour[1], light * colour[2]};
  const Seen p = project(va), q = project(vb), r = project(vc);
  const auto edge = [](const Eigen::Vector2f& u, const Eigen::Vector2f& v, float x, float y) {
    return (v.x() - u.x()) * (y - u.y()) - (v.y() - u.y()) * (x - u.x());
  };
  const float area = edge(p.at, q.at, r.at.x(), r.at.y());
  if (area == 0) return;
  const auto from = [](float u, float v, float w) { return static_cast<int>(std::min({u, v, w})); };
  const auto to = [](float u, float v, float w, std::uint32_t most) {
    return std::min(static_cast<int>(std::max({u, v, w})) + 1, static_cast<int>(most) - 1);
  };
  const auto clamp = [](int x) { return std::max(x, 0); };
  const int y1 = to(p.at.y(), q.at.y(), r.at.y(), size_.height);
  const int x1 = to(p.at.x(), q.at.x(), r.at.x(), size_.width);
  for (int y = clamp(from(p.at.y(), q.at.y(), r.at.y())); y <= y1; ++y) {
    for (int x = clamp(from(p.at.x(), q.at.x(), r.at.x())); x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const float wa = edge(q.at, r.at, px, py) / area, wb = edge(r.at, p.at, px, py) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      pixel(x, y, 1 / (wa / p.depth + wb / q.depth + wc / r.depth), lit, 1, true);
    }
  }
}

void Picture::surface(const Surface& surface, const Transform& pose, const Colour& colour) {
  const auto point = [&](std::uint32_t i) -> Eigen::Vector3f {
    return pose.rotation * surface.points[i] + pose.translation;
  };
  for (std::size_t i = 0; i < surface.corners.size(); i += 3)
    triangle(point(surface.corners[i]), point(surface.corners[i + 1]),
             point(surface.corners[i + 2]), colour);
}

void Picture::line(const Eigen::Vector3f& from, const Eigen::Vector3f& to, const Colour& colour,
                   float opacity) {
  Eigen::Vector3f a = in_view(from), b = in_view(to);
  if (a.z() < near_ && b.z() < near_) return;
  if (a.z() > b.z()) std::swap(a, b);
  if (a.z() < near_) a += (b - a) * ((near_ - a.z()) / (b.z() - a.z()));
  const Seen p = project(a), q = project(b);
  const float length = (q.at - p.at).cwiseAbs().maxCoeff();
  const int steps = static_cast<int>(std::clamp(length, 1.0f, 20'000.0f));
  for (int i = 0; i <= steps; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(steps);
    const Eigen::Vector2f at = p.at + share * (q.at - p.at);
    const float depth = 1 / ((1 - share) / p.depth + share / q.depth);
    pixel(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())),
          depth * 0.9995f, colour, opacity, false);
  }
}

void Picture::dot(const Eigen::Vector3f& at, const Colour& colour, float radius) {
  const Eigen::Vector3f view = in_view(at);
  if (view.z() < near_) return;
  const Seen p = project(view);
  const float r = kFine * radius;
  for (int y = static_cast<int>(p.at.y() - r); y <= static_cast<int>(p.at.y() + r); ++y) {
    for (int x = static_cast<int>(p.at.x() - r); x <= static_cast<int>(p.at.x() + r); ++x) {
      const float dx = static_cast<float>(x) + 0.5f - p.at.x();
      const float dy = static_cast<float>(y) + 0.5f - p.at.y();
      if (dx * dx + dy * dy <= r * r) pixel(x, y, p.depth * 0.995f, colour, 1, false);
    }
  }
}

Image Picture::image() const {
  Image image{{size_.width / kFine, size_.height / kFine}, {}};
  for (std::uint32_t y = 0; y < image.size.height; ++y) {
    for (std::uint32_t x = 0; x < image.size.width; ++x) {
      Colour sum{};
      for (std::uint32_t i = 0; i < kFine * kFine; ++i) {
        const std::size_t at =
            std::size_t{kFine * y + i / kFine} * size_.width + kFine * x + i % kFine;
        for (int k = 0; k < 3; ++k) sum[k] += colours_[at][k] / (kFine * kFine);
      }
      image.pixels.push_back({srgb(sum[0]), srgb(sum[1]), srgb(sum[2])});
    }
  }
  return image;
}

}  // namespace cde::cli
