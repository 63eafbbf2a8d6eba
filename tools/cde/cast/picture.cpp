// SPDX-License-Identifier: Apache-2.0
// cde render: rays of a picture, and pictures from its records.
#include "cast/picture.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cde/card/machine.hpp"
#include "cde/io/npy.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/suffix.hpp"
#include "options/help.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using Eigen::Vector3f;

/// Converts to the frame in which z is up. It is exact: coordinates only change places and signs.
/// The front stays in front: with y up, +z points towards the viewer.
Vector3f to_z_up(const Vector3f& v, char up) {
  if (up == 'y') return {v.x(), -v.z(), v.y()};
  if (up == 'x') return {-v.z(), v.y(), v.x()};
  return v;
}

Vector3f from_z_up(const Vector3f& v, char up) {
  if (up == 'y') return {v.x(), v.z(), -v.y()};
  if (up == 'x') return {v.z(), v.y(), -v.x()};
  return v;
}

/// Bounds in the frame in which z is up.
Eigen::AlignedBox3f upright_bounds(const Mesh& mesh, char up) {
  const Eigen::AlignedBox3f box = bounds(mesh);
  Eigen::AlignedBox3f turned;
  if (box.isEmpty()) return box;
  turned.extend(to_z_up(box.min(), up));
  turned.extend(to_z_up(box.max(), up));
  return turned;
}

/// 4:3, from 128x96 to 640x480, for at most about two thousand million tests.
Resolution size_for(std::size_t triangles) {
  constexpr double kTests = 2e9;
  const double pixels = kTests / static_cast<double>(std::max<std::size_t>(triangles, 1));
  const auto steps =
      static_cast<std::uint32_t>(std::clamp(std::sqrt(pixels / (64 * 48)), 2.0, 10.0));
  return {64 * steps, 48 * steps};
}

/// The box, enlarged in the plane so that the grid's cells are squares.
Eigen::AlignedBox3f with_square_cells(const Eigen::AlignedBox3f& box, Resolution grid) {
  const Eigen::Vector3d size = (box.max().cast<double>() - box.min().cast<double>());
  const double cell = std::max(size.x() / grid.width, size.y() / grid.height);
  const Eigen::Vector3d half(0.5 * cell * grid.width, 0.5 * cell * grid.height, 0.5 * size.z());
  const Eigen::Vector3d centre = 0.5 * (box.min().cast<double>() + box.max().cast<double>());
  return {(centre - half).cast<float>(), (centre + half).cast<float>()};
}

enum class Format { kPng, kPfm, kNpy, kOther };

/// A name without a known suffix is a PNG.
Format format_of(const std::string& path) {
  const Suffix name = suffix_of(path);
  if (name.text == ".pfm") return Format::kPfm;
  if (name.text == ".npy") return Format::kNpy;
  return name.nameless || name.text == ".png" ? Format::kPng : Format::kOther;
}

std::string_view bytes_of(std::span<const float> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

/// Portable float map, little endian, rows from the bottom up.
std::string pfm(std::span<const float> numbers, Resolution size, unsigned channels) {
  std::string text =
      fmt::format("{}\n{} {}\n-1.0\n", channels == 3 ? "PF" : "Pf", size.width, size.height);
  const std::size_t row = std::size_t{size.width} * channels;
  for (std::uint32_t y = size.height; y-- > 0;) text += bytes_of(numbers.subspan(y * row, row));
  return text;
}

std::uint8_t byte(float x) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(x, 0.0f, 1.0f)));
}

}  // namespace

void aim(const RaySource& o, CastJob& job) {
  const char up = o.up;
  const Eigen::AlignedBox3f box = upright_bounds(job.mesh, up);
  if (o.grid) {
    job.picture = o.grid;
    job.rays = grid_pixels(with_square_cells(box, *job.picture), *job.picture);
    if (up != 'z') job.rays = job.rays.turned([up](const Vector3f& v) { return from_z_up(v, up); });
    return;
  }
  // With a BVH the number of triangles hardly matters.
  const std::size_t met = job.config.traversal_units != 0 ? 1 : job.mesh.faces.size();
  job.picture = o.size.value_or(size_for(met));
  Camera camera;
  if (!o.camera) {
    std::vector<Vector3f> turned;
    if (up != 'z')
      for (const Vector3f& vertex : job.mesh.vertices) turned.push_back(to_z_up(vertex, up));
    camera = camera_for(up == 'z' ? job.mesh.vertices : turned, *job.picture);
    camera.eye = from_z_up(camera.eye, up);
    camera.target = from_z_up(camera.target, up);
  } else {
    camera = *o.camera;
  }
  camera.up = from_z_up(Vector3f::UnitZ(), up);
  job.rays = camera.pixels(*job.picture);
}

void check_picture_names(const PictureFiles& o) {
  struct Wanted {
    const char* option;
    const std::string& path;
    const char* may_be;
    bool pfm, npy;
  };
  for (const Wanted& w : {Wanted{"--image", o.depth, ".png, .pfm or .npy", true, true},
                          Wanted{"--normals", o.normals, ".png, .pfm or .npy", true, true},
                          Wanted{"--indices", o.indices, ".png or .npy", false, true},
                          Wanted{"--shaded", o.shaded, ".png", false, false}}) {
    if (w.path.empty()) continue;
    const Format is = format_of(w.path);
    const bool fits =
        is == Format::kPng || (is == Format::kPfm && w.pfm) || (is == Format::kNpy && w.npy);
    if (!fits) wrong_suffix(w.option, w.path, w.may_be);
  }
}

CastPicture::CastPicture(const CastTask& task, const CastJob& job)
    : o_(task),
      job_(job),
      shaded_(!o_.picture.shaded.empty()),
      faces_(shaded_ || !o_.picture.normals.empty() || !o_.picture.indices.empty()) {
  const std::size_t pixels = job_.picture->pixels();
  std::uint64_t each = 1;
  each += shaded_ || !o_.picture.depth.empty() ? sizeof(float) : 0;
  each += faces_ ? sizeof(std::uint32_t) : 0;
  each += shaded_ ? sizeof(Vector3f) + 3 : 0;
  each += shaded_ && o_.source.up != 'z' ? sizeof(Vector3f) : 0;
  each += o_.picture.shadows ? 2 * sizeof(Ray) + sizeof(std::size_t) + 1 : 0;
  each += o_.picture.normals.empty() ? 0 : 2 * sizeof(Vector3f) + 3;
  each += o_.picture.depth.empty() ? 0 : sizeof(float);
  const std::uint64_t most = memory_limit();
  if (each * pixels > most) {
    throw Error(
        ErrorCode::kCapacity,
        fmt::format("a picture of {} x {} pixels takes {} MB with these outputs; the limit on this "
                    "machine is {} MB (records of -o take none)",
                    job_.picture->width, job_.picture->height, (each * pixels) >> 20, most >> 20));
  }
  hit_.reserve(pixels);
  if (shaded_ || !o_.picture.depth.empty()) t_.reserve(pixels);
  if (faces_) index_.reserve(pixels);
  if (shaded_) point_.reserve(pixels);
}

void CastPicture::add(std::span<const Record> records) {
  for (const Record& r : records) {
    hit_.push_back(r.f ? 1 : 0);
    if (shaded_ || !o_.picture.depth.empty()) t_.push_back(r.t);
    if (faces_) index_.push_back(r.index);
    if (shaded_) point_.push_back(r.cp);
  }
}

PixelHits CastPicture::hits() const {
  return {*job_.picture, job_.rays, hit_, t_, index_, point_};
}

void CastPicture::look_at_sun(const CastAgain& cast) {
  if (!o_.picture.shadows) return;
  CastJob job{.mesh = job_.mesh,
              .triangles = job_.triangles,
              .parts = job_.parts,
              .listed = {},
              .rays = {},
              .picture = job_.picture,
              .mode = job_.bvh ? Mode::kOccluded : Mode::kAny,
              .config = job_.config,
              .bvh = job_.bvh};
  // The offset keeps a shadow ray from hitting its own triangle by rounding.
  const float offset = 1e-4f * bounds(job_.mesh).sizes().norm();
  const Vector3f sun = from_z_up(ShadeOptions{}.sun, o_.source.up);
  const std::vector<Ray> all = sun_rays(hits(), job_.mesh, sun, offset);
  std::vector<std::size_t> pixels;  // pixels with a hit
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (hit_[i] == 0) continue;
    job.listed.push_back(all[i]);
    pixels.push_back(i);
  }
  shadow_.assign(all.size(), 0);
  if (job.listed.empty()) return;
  job.rays = job.listed;
  std::size_t next = 0;
  cast(job, [&](std::span<const Record> records) {
    for (const Record& r : records) shadow_[pixels[next++]] = r.f ? 1 : 0;
  });
}

Image CastPicture::sunlit() const {
  const Progress busy("drawing", o_.quiet);
  const char up = o_.source.up;
  ShadeOptions look;
  if (job_.mesh.name != "terrain") look.palette = Palette::kClay;
  look.haze = !o_.source.grid && look.palette == Palette::kLandscape;
  look.shadow = shadow_;
  if (up == 'z') return shade(hits(), job_.mesh, look);
  // Light falls from above in the frame where z is up.
  Mesh mesh = job_.mesh;
  for (Vector3f& v : mesh.vertices) v = to_z_up(v, up);
  const RayView rays = job_.rays.turned([up](const Vector3f& v) { return to_z_up(v, up); });
  std::vector<Vector3f> points = point_;
  for (Vector3f& p : points) p = to_z_up(p, up);
  return shade({*job_.picture, rays, hit_, t_, index_, points}, mesh, look);
}

Vector3f CastPicture::normal(std::size_t i) const {
  if (hit_[i] == 0) return Vector3f::Zero();
  const Triangle t = job_.mesh.triangle(index_[i]);
  const Vector3f n =
      (t.v1 - t.v0).cast<double>().cross((t.v2 - t.v0).cast<double>()).normalized().cast<float>();
  return n.dot(job_.rays[i].d) > 0 ? Vector3f(-n) : n;
}

void CastPicture::write_depth() const {
  const Resolution size = *job_.picture;
  switch (format_of(o_.picture.depth)) {
    case Format::kPng:
      return write_png(depth_image(hits()), o_.picture.depth);
    case Format::kPfm:
      return write_file(o_.picture.depth, pfm(t_, size, 1));
    default:
      return write_file(o_.picture.depth,
                        npy_header("<f4", {size.height, size.width}) + std::string(bytes_of(t_)));
  }
}

void CastPicture::write_normals() const {
  const Resolution size = *job_.picture;
  std::vector<float> numbers;
  numbers.reserve(3 * size.pixels());
  Image image{size, {}};
  for (std::size_t i = 0; i < size.pixels(); ++i) {
    const Vector3f n = normal(i);
    numbers.insert(numbers.end(), {n.x(), n.y(), n.z()});
    image.pixels.push_back(
        {byte(0.5f + 0.5f * n.x()), byte(0.5f + 0.5f * n.y()), byte(0.5f + 0.5f * n.z())});
  }
  switch (format_of(o_.picture.normals)) {
    case Format::kPng:
      return write_png(image, o_.picture.normals);
    case Format::kPfm:
      return write_file(o_.picture.normals, pfm(numbers, size, 3));
    default:
      return write_file(o_.picture.normals, npy_header("<f4", {size.height, size.width, 3}) +
                                                std::string(bytes_of(numbers)));
  }
}

void CastPicture::write_indices() const {
  const Resolution size = *job_.picture;
  if (format_of(o_.picture.indices) == Format::kNpy) {
    return write_file(o_.picture.indices,
                      npy_header("<u4", {size.height, size.width}) +
                          std::string(reinterpret_cast<const char*>(index_.data()),
                                      index_.size() * sizeof(std::uint32_t)));
  }
  Image image{size, {}};  // a colour per triangle, black without a hit
  for (std::size_t i = 0; i < size.pixels(); ++i) {
    std::uint32_t h = (index_[i] + 1) * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x85ebca77u;
    h ^= h >> 13;
    const auto channel = [h](unsigned shift) {
      return static_cast<std::uint8_t>(64 + (h >> shift & 0xff) * 191 / 255);
    };
    image.pixels.push_back(hit_[i] == 0
                               ? std::array<std::uint8_t, 3>{0, 0, 0}
                               : std::array<std::uint8_t, 3>{channel(0), channel(8), channel(16)});
  }
  write_png(image, o_.picture.indices);
}

std::string own_picture_name(const std::string& mesh) {
  const std::string name = mesh.starts_with("terrain:") ? "terrain" : mesh;
  return std::filesystem::path(name).stem().string() + ".render.png";
}

void CastPicture::write() const {
  if (!o_.picture.depth.empty()) write_depth();
  if (!o_.picture.normals.empty()) write_normals();
  if (!o_.picture.indices.empty()) write_indices();
  if (o_.picture.shaded.empty()) return;
  const Image image = sunlit();
  const std::string& path = o_.picture.shaded;
  write_png(image, path);
  if (!o_.picture.shows_itself || o_.quiet) return;
  if (on_terminal(STDOUT_FILENO)) {
    winsize terminal{};
    (void)::ioctl(STDOUT_FILENO, TIOCGWINSZ, &terminal);
    const unsigned columns = std::clamp<unsigned>(terminal.ws_col, 40, 100);
    OutputFile terminal_file("-");
    terminal_file.write(as_text(image, columns, may_colour(STDOUT_FILENO)));
    terminal_file.commit();
  }
  log("{:<16} {}, {} x {}\n", "picture", printable_name(path), image.size.width, image.size.height);
}

std::string as_text(const Image& image, unsigned columns, bool colour) {
  columns = std::min<unsigned>(columns, image.size.width);
  // A character is about twice as high as wide.
  const unsigned rows = std::max<unsigned>(
      1, static_cast<unsigned>(0.5 * columns * image.size.height / image.size.width + 0.5));
  const unsigned lines = colour ? 2 * rows : rows;
  // Mean of the pixels under a cell.
  const auto cell = [&](unsigned x, unsigned y) {
    std::array<unsigned, 3> sum{};
    unsigned count = 0;
    const auto edge = [](unsigned i, std::uint32_t all, unsigned of) {
      return static_cast<std::uint32_t>(std::uint64_t{i} * all / of);
    };
    const std::uint32_t y0 = edge(y, image.size.height, lines),
                        y1 = std::max(y0 + 1, edge(y + 1, image.size.height, lines)),
                        x0 = edge(x, image.size.width, columns),
                        x1 = std::max(x0 + 1, edge(x + 1, image.size.width, columns));
    for (std::uint32_t v = y0; v < y1; ++v) {
      for (std::uint32_t u = x0; u < x1; ++u, ++count) {
        const auto& pixel = image.pixels[std::size_t{v} * image.size.width + u];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += pixel[c];
      }
    }
    for (unsigned& c : sum) c /= count;
    return sum;
  };
  constexpr std::string_view kLight = " .:-=+*#%@";
  std::string text;
  for (unsigned row = 0; row < rows; ++row) {
    for (unsigned x = 0; x < columns; ++x) {
      if (colour) {
        const auto above = cell(x, 2 * row), below = cell(x, 2 * row + 1);
        text += fmt::format("\033[38;2;{};{};{};48;2;{};{};{}m\u2580", above[0], above[1], above[2],
                            below[0], below[1], below[2]);
      } else {
        const auto c = cell(x, row);
        text += kLight[(c[0] + c[1] + c[2]) * (kLight.size() - 1) / (3 * 255)];
      }
    }
    text += colour ? "\033[0m\n" : "\n";
  }
  return text;
}

}  // namespace cde::cli
