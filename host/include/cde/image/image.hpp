// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cde/image/camera.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde {

/// 8-bit sRGB picture: pixels row by row, top row first.
struct Image {
  Resolution size;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

/// 16-bit grey picture, linear.
struct GreyImage {
  Resolution size;
  std::vector<std::uint16_t> pixels;
};

/// Results of the card for the rays of a picture, one entry per pixel. Without a hit the other
/// entries are ignored.
struct PixelHits {
  Resolution size;
  RayView rays;  ///< the rays; surfaces are two-sided and lit on the side that the ray hits
  std::span<const std::uint8_t> hit;       ///< F: 0 or 1
  std::span<const float> t;                ///< T, along the ray
  std::span<const std::uint32_t> index;    ///< face of the mesh
  std::span<const Eigen::Vector3f> point;  ///< CP
};

enum class Palette {
  kLandscape,  ///< by height and slope: meadow, forest, rock, snow
  kClay,       ///< one warm grey, for objects
};

struct ShadeOptions {
  Eigen::Vector3f sun = {-0.55f, 0.35f, 0.62f};  ///< towards the sun, any length
  Palette palette = Palette::kLandscape;
  std::span<const std::uint8_t> shadow =
      {};            ///< one per pixel, 1 if the sun is occluded (sun_rays); or empty
  bool haze = true;  ///< far points fade towards the sky; off for orthographic views
  std::vector<std::array<std::uint32_t, 2>> markers =
      {};  ///< pixels (x, y) to circle, e.g. the hits of single rays
};

/// Picture lit by sun and sky. Normals are smoothed except over creases, where a face is more than
/// 37 degrees off the mean of its neighbours. Pixels without a hit show the sky. Error kUsage if a
/// span does not have one entry per pixel; kBadInput if an index is not a face of the mesh.
[[nodiscard]] Image shade(const PixelHits& hits, const Mesh& mesh,
                          const ShadeOptions& options = {});

/// Distance as brightness: the nearest hit is 65535, the farthest 8192, no hit 0.
[[nodiscard]] GreyImage depth_image(const PixelHits& hits);

/// Rays from the hit points to the sun for a second pass on the card, one per pixel. Its F is
/// ShadeOptions::shadow. A pixel without a hit has a valid ray with an empty interval. Rays start
/// off the surface by `offset` along the normal of the sunny side.
[[nodiscard]] std::vector<Ray> sun_rays(const PixelHits& hits, const Mesh& mesh,
                                        const Eigen::Vector3f& sun, float offset);

/// Writes a PNG. A reader never sees a partial file. Error kFile if it cannot be written.
void write_png(const Image& image, const std::filesystem::path& path);
void write_png(const GreyImage& image, const std::filesystem::path& path);
/// The same as bytes.
[[nodiscard]] std::string png_bytes(const Image& image);

}  // namespace cde
