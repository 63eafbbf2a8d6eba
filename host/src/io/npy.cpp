// SPDX-License-Identifier: Apache-2.0
#include "cde/io/npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <istream>
#include <iterator>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {
namespace {

constexpr std::string_view kMagic("\x93NUMPY", 6);

[[noreturn]] void fail(const std::string& path, const std::string& why,
                       ErrorCode code = ErrorCode::kFile) {
  throw Error(code, fmt::format("{}: {}", path, why));
}

std::string bytes_of(std::istream& in, const std::string& path) {
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) fail(path, "cannot be read");
  return bytes;
}

struct Array {
  bool wide = false;  ///< binary64
  std::uint64_t rows = 0, columns = 0;
  std::string_view data;
};

Array parse_array(const std::string& path, std::string_view bytes) {
  if (!bytes.starts_with(kMagic) || bytes.size() < 10) fail(path, "is not a NumPy array (.npy)");
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const unsigned version = at(6);
  const std::size_t start = version == 1 ? 10 : 12;
  if (version < 1 || version > 3 || bytes.size() < start)
    fail(path, fmt::format("NumPy format {}.{}, expected 1.0 to 3.0", version, at(7)));
  std::size_t length = at(8) | at(9) << 8;
  if (version > 1) length |= std::size_t{at(10)} << 16 | std::size_t{at(11)} << 24;
  if (length > bytes.size() - start) fail(path, "is cut short in its header");
  const std::string header(bytes.substr(start, length));
  const auto value = [&header](std::string_view key) {
    const std::string quoted = fmt::format("'{}':", key);
    const std::size_t at = header.find(quoted);
    std::string_view text(header);
    text.remove_prefix(at != std::string::npos ? at + quoted.size() : text.size());
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    return text;
  };
  // With its delimiters, or nothing.
  const auto delimited = [](std::string_view text, char first, char last) {
    const std::size_t end = text.starts_with(first) ? text.find(last, 1) : std::string_view::npos;
    return std::string(text.substr(0, end != std::string_view::npos ? end + 1 : 0));
  };
  Array array;
  std::string type = delimited(value("descr"), '\'', '\'');
  if (!type.empty()) type = type.substr(1, type.size() - 2);
  if (const std::string fields = delimited(value("descr"), '[', ']');
      type.empty() && !fields.empty())
    fail(path, fmt::format("its elements are structures, {}; rays are rows of numbers, '<f4' or "
                           "'<f8'",
                           printable(fields)));
  if (type != "<f4" && type != "<f8")
    fail(path, fmt::format("its numbers are {}; rays are '<f4' or '<f8'", in_quotes(type)));
  array.wide = type == "<f8";
  if (!value("fortran_order").starts_with("False"))
    fail(path, "is in Fortran order; rays are rows in C order");
  const std::string shape = delimited(value("shape"), '(', ')');
  int used = 0;
  unsigned long long rows = 0, columns = 0;
  if (shape.find('-') != std::string::npos ||
      std::sscanf(shape.c_str(), "(%19llu, %19llu)%n", &rows, &columns, &used) != 2 ||
      static_cast<std::size_t>(used) != shape.size() || columns < 6 || columns > 8)
    fail(path, fmt::format("its shape is {}; rays are N x 6, 7 or 8: ox, oy, oz, dx, dy, dz, "
                           "tmin, tmax",
                           shape.empty() ? "none" : printable_name(shape)));
  array.rows = rows;
  array.columns = columns;
  array.data = bytes.substr(start + length);
  const std::size_t row = columns * (array.wide ? 8 : 4);
  if (array.data.size() % row != 0 || array.data.size() / row != rows)
    fail(path, fmt::format("has {} bytes behind its header, not those of {} x {} numbers",
                           array.data.size(), rows, columns));
  return array;
}

}  // namespace

std::string npy_header(std::string_view type, const std::vector<std::uint64_t>& shape) {
  const bool named = type.starts_with('[');
  std::string header =
      fmt::format("{{'descr': {0}{1}{0}, 'fortran_order': False, 'shape': ({2}{3}), }}",
                  named ? "" : "'", type, fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  // Data begin on a multiple of 64 bytes, behind a line's end.
  header.append(63 - (kMagic.size() + 4 + header.size()) % 64, ' ').push_back('\n');
  std::string all(kMagic);
  all += {'\x01', '\x00', static_cast<char>(header.size() & 0xff),
          static_cast<char>(header.size() >> 8)};
  return all + header;
}

std::vector<Ray> read_rays_npy(std::istream& in, const std::string& path) {
  const std::string bytes = bytes_of(in, path);
  const Array array = parse_array(path, bytes);
  std::vector<Ray> rays;
  rays.reserve(array.rows);
  for (std::uint64_t i = 0; i < array.rows; ++i) {
    Ray ray;
    float values[8] = {0, 0, 0, 0, 0, 0, ray.tmin, ray.tmax};
    for (std::uint64_t c = 0; c < array.columns; ++c) {
      const std::uint64_t n = i * array.columns + c;
      double wide = 0;
      if (array.wide)
        std::memcpy(&wide, array.data.data() + 8 * n, 8);
      else
        std::memcpy(&values[c], array.data.data() + 4 * n, 4);
      if (array.wide) {
        values[c] = static_cast<float>(wide);
        if (std::isfinite(wide) && !std::isfinite(values[c]))
          fail(path, fmt::format("ray {}: {} overflows a float", i, wide), ErrorCode::kBadInput);
      }
    }
    ray = {
        {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, values[6], values[7]};
    if (const auto why = defect(ray))
      fail(path, fmt::format("ray {}: {}", i, *why), ErrorCode::kBadInput);
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace cde
