// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <set>
#include <span>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "mesh/readers.hpp"
#include "support/text.hpp"

// Reads PLY 1.0: ascii, and binary of either byte order. Elements other than vertex, face and
// tristrips are skipped, and so are properties other than x, y, z and vertex_indices. Every count
// of the header is checked against the file size before memory is taken.
namespace cde::mesh_readers {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

constexpr std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool parse_type(std::string_view word, Type& type) {
  constexpr std::pair<std::string_view, Type> kNames[] = {
      {"char", Type::kInt8},      {"int8", Type::kInt8},       {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},    {"short", Type::kInt16},     {"int16", Type::kInt16},
      {"ushort", Type::kUint16},  {"uint16", Type::kUint16},   {"int", Type::kInt32},
      {"int32", Type::kInt32},    {"uint", Type::kUint32},     {"uint32", Type::kUint32},
      {"float", Type::kFloat32},  {"float32", Type::kFloat32}, {"double", Type::kFloat64},
      {"float64", Type::kFloat64}};
  for (const auto& [name, value] : kNames) {
    if (name == word) {
      type = value;
      return true;
    }
  }
  return false;
}

constexpr bool is_float(Type type) {
  return type == Type::kFloat32 || type == Type::kFloat64;
}

/// What the reader does with a property.
enum class Role { kSkip, kX, kY, kZ, kCorners };

struct Property {
  Type type = Type::kInt8;
  bool is_list = false;
  Type count_type = Type::kUint8;
  Role role = Role::kSkip;
};

/// Faces that stand before the vertices. They take about as much memory as in the file.
struct WaitingFaces {
  struct Face {
    std::uint64_t row;
    std::size_t end;  ///< of its corners
  };
  std::vector<Face> faces;
  std::vector<std::uint32_t> corners;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  [[nodiscard]] bool has_corners() const { return name == "face" || name == "tristrips"; }
  /// Bytes of a binary row whose lists are all empty.
  [[nodiscard]] std::size_t smallest_binary_row() const {
    std::size_t bytes = 0;
    for (const auto& p : properties) bytes += size_of(p.is_list ? p.count_type : p.type);
    return bytes;
  }
  /// Whether all used properties precede the skipped ones.
  [[nodiscard]] bool wanted_come_first() const {
    return std::is_partitioned(properties.begin(), properties.end(),
                               [](const Property& p) { return p.role != Role::kSkip; });
  }
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name, const Deadline& deadline)
      : bytes_(text::without_mark(bytes)),
        file_bytes_(bytes.size()),
        lines_(bytes_),
        name_(name),
        deadline_(deadline) {}

  Mesh read() {
    header();
    body_ = ascii_ ? lines_.rest() : binary_body();
    for (const auto& element : elements_)
      if (element.count > 0) read_element(element);
    std::size_t begin = 0;
    for (const auto& [row, end] : waiting_.faces) {
      polygon(row, std::span(waiting_.corners).subspan(begin, end - begin));
      begin = end;
    }
    if (body_.find_first_not_of(ascii_ ? " \t\r\n" : "") != std::string_view::npos)
      warn(fmt::format("{} bytes after the last row are ignored", body_.size()));
    return std::move(mesh_);
  }

 private:
  /// The place in the file. Bytes count from its front, including a byte order mark.
  [[nodiscard]] std::string here() const {
    if (body_.data() == nullptr || ascii_) return fmt::format("{}:{}", name_, lines_.number());
    return fmt::format("{}: byte {}", name_, file_bytes_ - body_.size());
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", here(), why));
  }
  void warn(const std::string& what) {
    mesh_.warnings.push_back(fmt::format("{}: {}", here(), what));
  }

  /// If the header's lines end in CR alone, a following LF is the first byte of the body.
  [[nodiscard]] std::string_view binary_body() const {
    const std::string_view rest = lines_.rest();
    const std::size_t end = bytes_.find_first_of("\r\n");
    const bool cr_alone = !bytes_.substr(end).starts_with("\r\n") && bytes_[end] == '\r';
    const std::size_t at = bytes_.size() - rest.size();
    return bytes_.substr(cr_alone && bytes_[at - 1] == '\n' ? at - 1 : at);
  }

  void header() {
    if (text::trim(lines_.next().value_or("")) != "ply")
      fail("a PLY file begins with the line 'ply'");
    bool has_format = false;
    for (;;) {
      deadline_.check(name_);
      auto line = lines_.next();
      if (!line) fail("the header has no 'end_header'");
      const std::string_view keyword = text::next_word(*line);
      if (keyword == "end_header") break;
      if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
      if (keyword == "format") {
        format(*line);
        has_format = true;
      } else if (keyword == "element") {
        element(*line);
      } else if (keyword == "property") {
        property(*line);
      } else {
        fail(fmt::format("unknown header statement {}", in_quotes(keyword)));
      }
    }
    if (!has_format) fail("the header has no 'format'");
    for (const auto& e : elements_) {
      if (e.properties.empty() && e.count > 0)
        fail(fmt::format("element {} has no properties", in_quotes(e.name)));
      if (e.count == 0) continue;
      if (e.name == "vertex") require(e, {Role::kX, Role::kY, Role::kZ}, "x, y and z");
      if (e.has_corners()) require(e, {Role::kCorners}, "a list vertex_indices");
    }
  }

  void format(std::string_view rest) {
    const std::string_view word = text::next_word(rest);
    ascii_ = word == "ascii";
    if (word == "binary_little_endian") {
      swap_ = std::endian::native != std::endian::little;
    } else if (word == "binary_big_endian") {
      swap_ = std::endian::native != std::endian::big;
    } else if (!ascii_) {
      fail(fmt::format("unknown format {}", in_quotes(word)));
    }
  }

  void element(std::string_view rest) {
    Element e;
    e.name = text::next_word(rest);
    const std::string_view count = text::next_word(rest);
    if (!text::parse_int(count, e.count)) fail(fmt::format("{} is not a count", in_quotes(count)));
    if (!names_.insert(e.name).second)
      fail(fmt::format("element {} appears twice", in_quotes(e.name)));
    if (e.name == "vertex") {
      if (e.count > 0xffffffffu) fail(fmt::format("{} vertices exceed the 32-bit limit", e.count));
      vertex_count_ = e.count;
    }
    elements_.push_back(std::move(e));
  }

  void property(std::string_view rest) {
    if (elements_.empty()) fail("a property precedes the first element");
    Element& e = elements_.back();
    Property p;
    std::string_view word = text::next_word(rest);
    if (word == "list") {
      p.is_list = true;
      word = text::next_word(rest);
      if (!parse_type(word, p.count_type) || is_float(p.count_type)) {
        fail(fmt::format("{} is not a type to count with", in_quotes(word)));
      }
      word = text::next_word(rest);
    }
    if (!parse_type(word, p.type)) fail(fmt::format("{} is not a type", in_quotes(word)));
    word = text::next_word(rest);
    if (e.name == "vertex" && !p.is_list) {
      p.role = word == "x"   ? Role::kX
               : word == "y" ? Role::kY
               : word == "z" ? Role::kZ
                             : Role::kSkip;
    } else if (e.has_corners() && p.is_list && !is_float(p.type) &&
               (word == "vertex_indices" || word == "vertex_index")) {
      p.role = Role::kCorners;
    }
    e.properties.push_back(p);
  }

  void require(const Element& e, std::initializer_list<Role> roles, const char* what) const {
    for (const Role role : roles) {
      int found = 0;
      for (const auto& p : e.properties) found += p.role == role ? 1 : 0;
      if (found != 1) fail(fmt::format("element {} needs {}, once each", e.name, what));
    }
  }

  void read_element(const Element& e) {
    // An ascii row takes at least two characters per property, except for the last row of the file.
    const std::size_t smallest = ascii_ ? 2 * e.properties.size() : e.smallest_binary_row();
    if (e.count > (body_.size() + 1) / smallest) {
      fail(fmt::format(
          "{} {} rows are announced, but only {} bytes follow: truncated, or the count is wrong",
          e.count, e.name, body_.size()));
    }
    if (e.name == "vertex") mesh_.vertices.reserve(e.count);
    if (e.name == "face") mesh_.faces.reserve(e.count);
    too_long_ = 0;
    for (row_ = 0; row_ < e.count; ++row_) read_row(e);
    if (too_long_ > 0)
      mesh_.warnings.push_back(fmt::format(
          "{}:{}: {} row {} has more values than the header announces{}; they are ignored", name_,
          first_too_long_.line, e.name, first_too_long_.row,
          too_long_ == 1   ? ""
          : too_long_ == 2 ? ", as has 1 other"
                           : fmt::format(", as have {} others", too_long_ - 1)));
  }

  void read_row(const Element& e) {
    if (ascii_) next_ascii_row(e);
    Eigen::Vector3f vertex;
    for (const auto& p : e.properties) {
      const std::int64_t count = p.is_list ? integer(e, p.count_type) : 1;
      if (count < 0) fail(fmt::format("{} row {}: a list of {} entries", e.name, row_, count));
      if (p.role == Role::kCorners) {
        corners(e, p, count);
      } else if (p.role == Role::kSkip) {
        skip(e, p, static_cast<std::uint64_t>(count));
      } else {
        vertex[static_cast<int>(p.role) - static_cast<int>(Role::kX)] = real(e, p.type);
      }
    }
    if (ascii_ && !text::trim(line_).empty()) {
      if (!e.wanted_come_first()) fail(fmt::format("{} row {} has too many values", e.name, row_));
      if (too_long_++ == 0) first_too_long_ = {lines_.number(), row_};
    }
    if (e.name == "vertex") mesh_.vertices.push_back(vertex);
  }

  void corners(const Element& e, const Property& p, std::int64_t count) {
    const bool strip = e.name == "tristrips";
    corners_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t corner = integer(e, p.type);
      if (strip && corner == -1) {
        append_strip();
        corners_.clear();
        continue;
      }
      if (corner < 0 || static_cast<std::uint64_t>(corner) >= vertex_count_) {
        fail(fmt::format("face {}: vertex number {} is out of range: {} vertices", row_, corner,
                         vertex_count_));
      }
      corners_.push_back(static_cast<std::uint32_t>(corner));
    }
    if (strip)
      append_strip();
    else if (mesh_.vertices.size() == vertex_count_ || corners_.size() < 3)
      polygon(row_, corners_);
    else {
      waiting_.corners.insert(waiting_.corners.end(), corners_.begin(), corners_.end());
      waiting_.faces.push_back({row_, waiting_.corners.size()});
    }
  }

  void polygon(std::uint64_t row, std::span<const std::uint32_t> c) {
    if (const std::string why = append_polygon(mesh_, c, deadline_); !why.empty())
      fail(fmt::format("face {}: {}", row, why));
  }

  /// Each corner from the third on makes a triangle with the two before it; every second triangle
  /// is turned round. A repeated corner, which joins strips, makes none.
  void append_strip() {
    const std::vector<std::uint32_t>& c = corners_;
    for (std::size_t i = 2; i < c.size(); ++i) {
      const std::size_t odd = i % 2;
      const std::uint32_t a = c[i - 2 + odd], b = c[i - 1 - odd];
      if (a != b && b != c[i] && a != c[i]) mesh_.faces.push_back({a, b, c[i]});
    }
  }

  // --- one value, ascii or binary

  void next_ascii_row(const Element& e) {
    text::Lines& lines = lines_;
    do {
      const auto line = lines.next();
      if (!line)
        fail(fmt::format("the file ends at {} row {} of {}: it is truncated", e.name, row_,
                         e.count));
      line_ = *line;
    } while (text::trim(line_).empty());
    body_ = lines.rest();
  }

  std::string_view ascii_word(const Element& e) {
    const std::string_view word = text::next_word(line_);
    if (word.empty()) fail(fmt::format("{} row {} has too few values", e.name, row_));
    return word;
  }

  template <typename T>
  T binary(const Element& e) {
    if (body_.size() < sizeof(T))
      fail(fmt::format("the file ends in {} row {} of {}: it is truncated", e.name, row_, e.count));
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), body_.data(), sizeof(T));
    body_.remove_prefix(sizeof(T));
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  std::int64_t integer(const Element& e, Type type) {
    if (ascii_) {
      std::int64_t value = 0;
      const std::string_view word = ascii_word(e);
      if (!text::parse_int(word, value)) fail(fmt::format("{} is not an integer", in_quotes(word)));
      return value;
    }
    switch (type) {
      case Type::kInt8:
        return binary<std::int8_t>(e);
      case Type::kUint8:
        return binary<std::uint8_t>(e);
      case Type::kInt16:
        return binary<std::int16_t>(e);
      case Type::kUint16:
        return binary<std::uint16_t>(e);
      case Type::kInt32:
        return binary<std::int32_t>(e);
      case Type::kUint32:
        return binary<std::uint32_t>(e);
      case Type::kFloat32:
      case Type::kFloat64:
        break;
    }
    fail("an integer was expected");
  }

  float real(const Element& e, Type type) {
    if (ascii_) {
      float value = 0.0f;
      const std::string_view word = ascii_word(e);
      const text::Number result = text::parse_float(word, value);
      if (result == text::Number::kOverflow)
        fail(fmt::format("{} overflows a float", in_quotes(word)));
      if (result != text::Number::kOk) fail(fmt::format("{} is not a number", in_quotes(word)));
      return value;
    }
    if (type == Type::kFloat32) return binary<float>(e);
    if (type == Type::kFloat64) return static_cast<float>(binary<double>(e));
    return static_cast<float>(integer(e, type));
  }

  void skip(const Element& e, const Property& p, std::uint64_t count) {
    if (ascii_) {
      for (std::uint64_t i = 0; i < count; ++i) (void)ascii_word(e);
      return;
    }
    if (count > body_.size() / size_of(p.type)) {
      fail(fmt::format("the file ends in {} row {} of {}: it is truncated", e.name, row_, e.count));
    }
    body_.remove_prefix(count * size_of(p.type));
  }

  std::string_view bytes_;
  std::size_t file_bytes_;
  text::Lines lines_;
  const std::string& name_;
  const Deadline& deadline_;
  bool ascii_ = false;
  bool swap_ = false;
  std::vector<Element> elements_;
  std::set<std::string> names_;  // of elements
  std::uint64_t vertex_count_ = 0;
  std::uint64_t row_ = 0;
  std::string_view body_;  // the unread part behind the header
  std::string_view line_;  // the unread part of an ascii row
  std::vector<std::uint32_t> corners_;
  WaitingFaces waiting_;
  std::uint64_t too_long_ = 0;  // rows of the element with too many values
  struct {
    std::size_t line;
    std::uint64_t row;
  } first_too_long_ = {};
  Mesh mesh_;
};

}  // namespace

Mesh read_ply(std::string_view bytes, const std::string& name, const Deadline& deadline) {
  text::require_utf8(bytes, name);
  return PlyReader(bytes, name, deadline).read();
}

}  // namespace cde::mesh_readers
