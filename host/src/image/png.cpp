// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <png.h>

#include <bit>

#include "cde/image/image.hpp"
#include "cde/support/error.hpp"
#include "cde/support/output_file.hpp"

namespace cde {
namespace {

extern "C" {
static void append_bytes(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}
static void no_flush(png_structp /*png*/) {}
// libpng's error callback must not return, so it throws through C frames, which Debian builds with
// unwind tables.
[[noreturn]] static void throw_error(png_structp /*png*/, png_const_charp message) {
  throw Error(ErrorCode::kFile, fmt::format("PNG: {}", message));
}
}

struct Format {
  int bits;
  int colour;
  std::size_t pixel_bytes;
};

std::string encoded(const void* pixels, std::size_t count, Resolution size, Format format) {
  if (count != size.pixels() || count == 0) {
    throw Error(ErrorCode::kUsage,
                fmt::format("picture of {} x {} with {} pixels", size.width, size.height, count));
  }
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, throw_error, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const auto destroy = [&] { png_destroy_write_struct(&png, &info); };
  try {
    if (info == nullptr) throw Error(ErrorCode::kFile, "PNG: out of memory");
    png_set_write_fn(png, &bytes, append_bytes, no_flush);
    png_set_IHDR(png, info, size.width, size.height, format.bits, format.colour, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (format.colour == PNG_COLOR_TYPE_RGB) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    if (format.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
    const auto* row = static_cast<png_const_bytep>(pixels);
    for (std::uint32_t y = 0; y < size.height; ++y, row += size.width * format.pixel_bytes)
      png_write_row(png, row);
    png_write_end(png, info);
  } catch (...) {
    destroy();
    throw;
  }
  destroy();
  return bytes;
}

}  // namespace

std::string png_bytes(const Image& image) {
  return encoded(image.pixels.data(), image.pixels.size(), image.size, {8, PNG_COLOR_TYPE_RGB, 3});
}

void write_png(const Image& image, const std::filesystem::path& path) {
  write_file(path, png_bytes(image));
}

void write_png(const GreyImage& image, const std::filesystem::path& path) {
  write_file(path, encoded(image.pixels.data(), image.pixels.size(), image.size,
                           {16, PNG_COLOR_TYPE_GRAY, 2}));
}

}  // namespace cde
