// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "mesh/readers.hpp"
#include "support/text.hpp"

// Reads STL: binary (80-byte header, little-endian count, 50 bytes per facet) or ascii, whose
// keywords may have any case. Facet normals are skipped: they follow from the corners and are often
// wrong.
namespace cde::mesh_readers {
namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kFacet = 50;

Mesh read_binary(std::string_view bytes, std::uint32_t count, const std::string& name,
                 const Deadline& deadline) {
  Mesh mesh;
  VertexPool pool(mesh.vertices);
  mesh.faces.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    deadline.check(name);
    std::array<std::uint32_t, 3> face{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Eigen::Vector3f v;
      std::memcpy(v.data(), bytes.data() + kHeader + kFacet * i + 12 * (corner + 1), 12);
      face[corner] = pool.add(v);
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

class AsciiReader {
 public:
  AsciiReader(std::string_view bytes, const std::string& name, const Deadline& deadline)
      : lines_(bytes), name_(name), deadline_(deadline) {}

  Mesh read() {
    expect("solid");
    line_ = {};  // the rest of the line is the name
    for (std::string_view w = word(); !w.empty(); w = word()) {
      if (is(w, "facet")) {
        facet();
      } else if (is(w, "endsolid")) {
        line_ = {};
        open_ = false;
      } else if (is(w, "solid") && !open_) {
        line_ = {};
        open_ = true;
      } else {
        fail(fmt::format("expected 'facet' or 'endsolid', not {}", in_quotes(w)));
      }
    }
    if (open_) fail("the file ends before 'endsolid': it is truncated");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}:{}: {}", name_, lines_.number(), why));
  }

  static bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](unsigned char a, char b) { return std::tolower(a) == b; });
  }

  std::string_view word() {
    for (;;) {
      const std::string_view w = text::next_word(line_);
      if (!w.empty()) return w;
      const auto next = lines_.next();
      if (!next) return {};
      line_ = *next;
    }
  }

  void expect(std::string_view what) {
    const std::string_view w = word();
    if (w.empty()) fail(fmt::format("the file ends where '{}' should be: it is truncated", what));
    if (!is(w, what)) fail(fmt::format("expected '{}', not {}", what, in_quotes(w)));
  }

  float number() {
    const std::string_view w = word();
    float value = 0.0f;
    if (w.empty()) fail("the file ends where a number should be: it is truncated");
    const text::Number result = text::parse_float(w, value);
    if (result == text::Number::kOverflow) fail(fmt::format("{} overflows a float", in_quotes(w)));
    if (result != text::Number::kOk) fail(fmt::format("{} is not a number", in_quotes(w)));
    return value;
  }

  void facet() {
    deadline_.check(name_);
    if (!open_) fail("'facet' outside of a solid");
    expect("normal");
    for (int i = 0; i < 3; ++i) {  // not read as numbers: some writers put "-nan(ind)"
      if (word().empty()) fail("the file ends in a facet normal: it is truncated");
    }
    expect("outer");
    expect("loop");
    std::array<std::uint32_t, 3> face{};
    for (auto& corner : face) {
      expect("vertex");
      Eigen::Vector3f v;
      for (int i = 0; i < 3; ++i) v[i] = number();
      corner = pool_.add(v);
    }
    expect("endloop");
    expect("endfacet");
    mesh_.faces.push_back(face);
  }

  text::Lines lines_;
  const std::string& name_;
  const Deadline& deadline_;
  std::string_view line_;
  bool open_ = true;
  Mesh mesh_;
  VertexPool pool_{mesh_.vertices};
};

/// Whether the first word is "solid" and text follows. The headers of many binary files also begin
/// with that word. But their facet count, and most padding of headers, contains a zero byte.
bool is_text(std::string_view bytes) {
  std::string_view rest = text::without_mark(bytes);
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n\v\f"), rest.size()));
  constexpr std::string_view kSolid = "solid";
  if (rest.size() < kSolid.size()) return false;
  for (std::size_t i = 0; i < kSolid.size(); ++i)
    if (std::tolower(static_cast<unsigned char>(rest[i])) != kSolid[i]) return false;
  return bytes.substr(0, 1024).find('\0') == std::string_view::npos;
}

}  // namespace

Mesh read_stl(std::string_view bytes, const std::string& name, const Deadline& deadline) {
  std::uint64_t expected = 0;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) {
    std::memcpy(&count, bytes.data() + 80, 4);
    expected = kHeader + kFacet * std::uint64_t{count};
    if (bytes.size() == expected) return read_binary(bytes, count, name, deadline);
  }
  text::require_utf8(bytes, name);
  if (is_text(bytes)) return AsciiReader(text::without_mark(bytes), name, deadline).read();
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", name, why));
  };
  if (bytes.size() < kHeader)
    fail(
        fmt::format("{} bytes are too few for a binary STL (84 without facets), and it does not "
                    "begin with 'solid' as ascii STL does",
                    bytes.size()));
  const std::string counted = fmt::format("binary STL of {} facets takes {} bytes, the file has {}",
                                          count, expected, bytes.size());
  if (bytes.size() < expected) fail(counted);
  if (count == 0) fail(counted + ": its writer did not set the count");
  Mesh mesh = read_binary(bytes, count, name, deadline);
  mesh.warnings.push_back(
      fmt::format("{}: byte {}: {} bytes after the last of {} facets are ignored", name, expected,
                  bytes.size() - expected, count));
  return mesh;
}

}  // namespace cde::mesh_readers
