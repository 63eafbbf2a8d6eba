// SPDX-License-Identifier: Apache-2.0
#include "cde/image/image.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cde/mesh/terrain.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;
using testing::Folder;
using testing::small_mesh;

/// The card's answers, computed by brute force in binary64.
struct Answers {
  Resolution size;
  std::vector<Ray> rays;
  std::vector<std::uint8_t> hit;
  std::vector<float> t;
  std::vector<std::uint32_t> index;
  std::vector<Eigen::Vector3f> point;

  [[nodiscard]] PixelHits pixels() const { return {size, rays, hit, t, index, point}; }
};

Answers cast(const Mesh& mesh, Resolution size, std::vector<Ray> rays) {
  Answers a{size, std::move(rays), {}, {}, {}, {}};
  for (const Ray& ray : a.rays) {
    const Eigen::Vector3d o = ray.o.cast<double>(), d = ray.d.cast<double>();
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t face = 0xffffffffu;
    for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
      const Triangle tri = mesh.triangle(i);
      const Eigen::Vector3d v0 = tri.v0.cast<double>(), e1 = tri.v1.cast<double>() - v0,
                            e2 = tri.v2.cast<double>() - v0;
      const Eigen::Vector3d p = d.cross(e2);
      const double det = p.dot(e1);
      if (det == 0.0) continue;
      const Eigen::Vector3d s = o - v0, q = s.cross(e1);
      const double u = s.dot(p) / det, v = d.dot(q) / det, t = e2.dot(q) / det;
      if (u < 0 || v < 0 || u + v > 1 || t < ray.tmin || t > ray.tmax || t >= best) continue;
      best = t;
      face = static_cast<std::uint32_t>(i);
    }
    const bool hit = face != 0xffffffffu;
    a.hit.push_back(hit ? 1 : 0);
    a.t.push_back(static_cast<float>(best));
    a.index.push_back(face);
    a.point.push_back(hit ? Eigen::Vector3f((o + best * d).cast<float>())
                          : Eigen::Vector3f::Zero());
  }
  return a;
}

struct Decoded {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;
};

Decoded decode(const std::filesystem::path& path, std::uint32_t format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  Decoded out;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0)
    throw std::runtime_error(image.message);
  image.format = format;
  out.width = image.width;
  out.height = image.height;
  out.bytes.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, out.bytes.data(), 0, nullptr) == 0)
    throw std::runtime_error(image.message);
  return out;
}

double brightness(const std::array<std::uint8_t, 3>& p) {
  return (p[0] + p[1] + p[2]) / 3.0;
}

TEST(ImageTest, ColourPng_DecodesToTheSamePixels) {
  const Folder folder;
  Image image{{5, 3}, {}};
  for (std::uint8_t i = 0; i < 15; ++i)
    image.pixels.push_back(
        {i, static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(17 * i)});
  write_png(image, folder / "a.png");
  write_png(image, folder / "a.png");  // replaces the file
  const Decoded back = decode(folder / "a.png", PNG_FORMAT_RGB);
  EXPECT_EQ(back.width, 5u);
  EXPECT_EQ(back.height, 3u);
  for (std::size_t i = 0; i < 45; ++i) ASSERT_EQ(back.bytes[i], image.pixels[i / 3][i % 3]) << i;
  EXPECT_EQ(folder.files(), 1u) << "a temporary file was left behind";
}

TEST(ImageTest, GreyPng_KeepsSixteenBits) {
  const Folder folder;
  write_png(GreyImage{{3, 1}, {0, 0x1234, 65535}}, folder / "g.png");
  const std::string bytes = testing::bytes_of(folder / "g.png");
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes[24], 16) << "bit depth in IHDR";
  EXPECT_EQ(bytes[25], 0) << "grey";
  const Decoded back = decode(folder / "g.png", PNG_FORMAT_LINEAR_Y);
  std::uint16_t values[3];
  std::memcpy(values, back.bytes.data(), 6);
  // Without a gAMA chunk libpng treats 16-bit samples as linear, so they come back unchanged.
  EXPECT_EQ(values[0], 0);
  EXPECT_EQ(values[1], 0x1234);
  EXPECT_EQ(values[2], 65535);
}

TEST(ImageTest, UnwritablePng_IsAnError) {
  const Folder folder;
  const Image image{{1, 1}, {{1, 2, 3}}};
  expect_error(ErrorCode::kFile, "x.png: cannot create: No such file",
               [&] { write_png(image, folder / "no/x.png"); });
  expect_error(ErrorCode::kUsage, "2 x 2 with 1 pixels", [&] {
    write_png(Image{{2, 2}, image.pixels}, folder / "x.png");
  });
  expect_error(ErrorCode::kUsage, "0 x 0", [&] { write_png(Image{}, folder / "x.png"); });
  EXPECT_EQ(folder.files(), 0u);
}

TEST(ImageTest, NearDepth_IsBrighter) {
  const std::vector<std::uint8_t> hit = {1, 0, 1, 1};
  const std::vector<float> t = {10, std::numeric_limits<float>::infinity(), 20, 15};
  const GreyImage image = depth_image({{2, 2}, {}, hit, t, {}, {}});
  EXPECT_EQ(image.pixels, (std::vector<std::uint16_t>{65535, 0, 8192, 36864}));
  const std::vector<std::uint8_t> none(4, 0);
  EXPECT_EQ(depth_image({{2, 2}, {}, none, t, {}, {}}).pixels, std::vector<std::uint16_t>(4, 0));
}

TEST(ImageTest, SlopesTowardsTheSun_AreBrighter) {
  // A roof: two slopes of 45 degrees, with the ridge along y.
  Mesh roof;
  roof.vertices = {{-1, 0, 0}, {0, 0, 1}, {0, 2, 1}, {-1, 2, 0}, {1, 0, 0}, {1, 2, 0}};
  roof.faces = {{0, 1, 2}, {0, 2, 3}, {4, 5, 2}, {4, 2, 1}};  // windings disagree: two-sided
  const Answers a = cast(roof, {8, 8}, grid_rays(bounds(roof), {8, 8}));
  ShadeOptions options;
  options.haze = false;
  options.palette = Palette::kClay;
  options.sun = {-1, 0, 1};
  const Image west = shade(a.pixels(), roof, options);
  options.sun = {1, 0, 1};
  const Image east = shade(a.pixels(), roof, options);
  EXPECT_GT(brightness(west.pixels[8]), brightness(west.pixels[15]) + 30);
  EXPECT_LT(brightness(east.pixels[8]), brightness(east.pixels[15]) - 30);
  const std::vector<std::uint8_t> shadow(64, 1);
  options.shadow = shadow;
  EXPECT_LT(brightness(shade(a.pixels(), roof, options).pixels[15]),
            brightness(east.pixels[15]) - 30);
}

TEST(ImageTest, SunRays_FindShadows) {
  // A plate over a floor, with the sun straight above.
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0},
                   {0, 0, 2}, {4, 0, 2}, {4, 8, 2}, {0, 8, 2}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  const Eigen::Vector3f sun(1, 0, 1);
  const Answers a = cast(mesh, {8, 8}, grid_rays(bounds(mesh), {8, 8}));
  const Answers s = cast(mesh, {8, 8}, sun_rays(a.pixels(), mesh, {-1, 0, 1}, 1e-3f));
  const Answers other = cast(mesh, {8, 8}, sun_rays(a.pixels(), mesh, sun, 1e-3f));
  for (std::size_t x = 0; x < 8; ++x) {
    EXPECT_EQ(a.hit[x], 1);
    // The plate's shadow falls two cells to the east, on cells 4 and 5. With the sun in the east no
    // cell is shaded.
    EXPECT_EQ(s.hit[x], x == 4 || x == 5 ? 1 : 0) << x;
    EXPECT_EQ(other.hit[x], 0) << x;
  }
}

TEST(ImageTest, SkyAndMarkers_AreDrawnAndBadArgumentsRefused) {
  const Mesh cube = load_mesh(small_mesh("cube.obj"));
  const Resolution size{48, 32};
  Answers a = cast(cube, size, camera_for(bounds(cube), size).rays(size));
  const auto hits = static_cast<std::size_t>(std::count(a.hit.begin(), a.hit.end(), 1));
  EXPECT_GT(hits, size.pixels() / 5);
  EXPECT_LT(hits, size.pixels() * 9 / 10);
  const Image plain = shade(a.pixels(), cube, {});
  EXPECT_GT(plain.pixels[0][2], plain.pixels[0][0]) << "the sky is blue";
  ShadeOptions options;
  options.markers = {{24, 16}, {0, 0}, {47, 31}, {4000000000u, 5}};
  const Image marked = shade(a.pixels(), cube, options);
  const auto& ring = marked.pixels[16 * 48 + 24 + 5];
  EXPECT_GT(ring[0], 180);
  EXPECT_LT(ring[1], 70);
  EXPECT_EQ(marked.pixels[16 * 48 + 24], plain.pixels[16 * 48 + 24])
      << "the marked pixel stays visible";
  options.sun = {0, 0, 0};
  expect_error(ErrorCode::kUsage, "the direction to the sun",
               [&] { (void)shade(a.pixels(), cube, options); });
  const auto first =
      static_cast<std::size_t>(std::find(a.hit.begin(), a.hit.end(), 1) - a.hit.begin());
  a.index[first] = 12;
  expect_error(ErrorCode::kBadInput, "face 12, but there are 12 faces",
               [&] { (void)shade(a.pixels(), cube, {}); });
  a.t.pop_back();
  expect_error(ErrorCode::kUsage, "t has 1535 entries", [&] { (void)shade(a.pixels(), cube, {}); });
}

TEST(ImageTest, TerrainPicture_IsNotFlatOrClipped) {
  const Mesh terrain = make_terrain({60, 60, 1});
  const Resolution size{96, 64};
  const Answers a = cast(terrain, size, camera_for(bounds(terrain), size).rays(size));
  const Image image = shade(a.pixels(), terrain, {});
  double sum = 0.0, squares = 0.0, count = 0.0, clipped = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (a.hit[i] == 0) continue;
    const double b = brightness(image.pixels[i]);
    sum += b;
    squares += b * b;
    count += 1.0;
    clipped += b < 8 || b > 250 ? 1.0 : 0.0;
  }
  ASSERT_GT(count, 1000.0);
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  EXPECT_GT(mean, 70.0);
  EXPECT_LT(mean, 190.0);
  EXPECT_GT(deviation, 15.0) << "flat lighting";
  EXPECT_LT(clipped / count, 0.02) << "too many white or black pixels";
}

}  // namespace
}  // namespace cde
