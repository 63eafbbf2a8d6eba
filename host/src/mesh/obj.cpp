// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "mesh/readers.hpp"
#include "support/text.hpp"

// Reads Wavefront OBJ: v, f, l and p statements. Normals, texture coordinates, materials, groups
// and smoothing do not change the surface and are skipped. Free-form surfaces (curv, surf) are an
// error: skipping them would lose geometry silently.
namespace cde::mesh_readers {
namespace {

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name, std::vector<std::string>& libraries,
            const Deadline& deadline)
      : lines_(text::without_mark(bytes)),
        name_(name),
        libraries_(libraries),
        deadline_(deadline) {}

  Mesh read() {
    while (auto line = lines_.next()) {
      std::string_view rest = join_continued(*line);
      const std::string_view keyword = text::next_word(rest);
      if (keyword == "v") {
        vertex(rest);
      } else if (keyword == "f" || keyword == "fo") {
        face(rest);
      } else if (keyword == "l" || keyword == "p") {
        ++mesh_.dropped;
      } else if (keyword == "o" || keyword == "g") {
        part(rest);
      } else if (keyword == "mtllib") {
        library(rest);
      } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
        fail(fmt::format("free-form geometry ('{}') is not supported", keyword));
      } else if (!keyword.empty() && keyword.front() != '#' && !is_ignored(keyword)) {
        fail(fmt::format("unknown statement {}", in_quotes(keyword)));
      }
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}:{}: {}", name_, lines_.number(), why));
  }

  static bool is_ignored(std::string_view keyword) {
    constexpr std::string_view kIgnored[] = {
        "vn",    "vt",       "vp",       "s",    "mg",         "usemtl",    "usemap", "maplib",
        "bevel", "c_interp", "d_interp", "lod",  "shadow_obj", "trace_obj", "cstype", "deg",
        "bmat",  "step",     "parm",     "trim", "hole",       "scrv",      "sp",     "end",
        "con",   "ctech",    "stech",    "call", "csh"};
    for (const auto word : kIgnored) {
      if (word == keyword) return true;
    }
    return false;
  }

  /// A backslash at the end of a line joins it with the next.
  std::string_view join_continued(std::string_view line) {
    if (line.empty() || line.back() != '\\') return line;
    joined_.clear();
    while (!line.empty() && line.back() == '\\') {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      line = lines_.next().value_or("");
    }
    joined_.append(line);
    return joined_;
  }

  /// The faces that follow belong to this object or group. An object without faces is no part.
  void part(std::string_view rest) {
    const std::size_t faces = mesh_.faces.size();
    if (!mesh_.parts.empty() && mesh_.parts.back().first_face == faces) mesh_.parts.pop_back();
    mesh_.parts.push_back({std::string(text::trim(rest)), static_cast<std::uint32_t>(faces)});
  }

  /// The text holds several names or one name with blanks. NamedFiles finds out which.
  void library(std::string_view rest) {
    const std::string_view whole = text::trim(rest);
    libraries_.emplace_back(whole);
    for (auto word = text::next_word(rest); !word.empty(); word = text::next_word(rest))
      if (word != whole) libraries_.emplace_back(word);
  }

  void vertex(std::string_view rest) {
    Eigen::Vector3f v;
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = text::next_word(rest);
      if (word.empty()) fail("a vertex needs three coordinates");
      const text::Number result = text::parse_float(word, v[i]);
      if (result == text::Number::kOverflow)
        fail(fmt::format("{} overflows a float", in_quotes(word)));
      if (result != text::Number::kOk) fail(fmt::format("{} is not a number", in_quotes(word)));
    }
    mesh_.vertices.push_back(v);  // a weight or a colour may follow
  }

  void face(std::string_view rest) {
    corners_.clear();
    for (std::string_view word = text::next_word(rest); !word.empty();
         word = text::next_word(rest)) {
      if (word.front() == '#') break;
      corners_.push_back(corner(word.substr(0, word.find('/'))));
    }
    if (corners_.empty()) fail("a face needs corners");
    if (const std::string why = append_polygon(mesh_, corners_, deadline_); !why.empty()) fail(why);
  }

  /// Corners count from 1; negative numbers count backwards from the last vertex so far.
  std::uint32_t corner(std::string_view word) const {
    std::int64_t number = 0;
    if (!text::parse_int(word, number))
      fail(fmt::format("{} is not a vertex number", in_quotes(word)));
    const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
    const std::int64_t from_zero = number > 0                       ? number - 1
                                   : number < 0 && number >= -count ? count + number
                                                                    : -1;
    if (from_zero < 0 || from_zero >= count) {
      fail(fmt::format("vertex number {} is out of range: {} vertices so far", number, count));
    }
    return static_cast<std::uint32_t>(from_zero);
  }

  text::Lines lines_;
  const std::string& name_;
  std::vector<std::string>& libraries_;
  const Deadline& deadline_;
  std::string joined_;
  std::vector<std::uint32_t> corners_;
  Mesh mesh_;
};

}  // namespace

Mesh read_obj(std::string_view bytes, const std::string& name, std::vector<std::string>& libraries,
              const Deadline& deadline) {
  text::require_utf8(bytes, name);
  return ObjReader(bytes, name, libraries, deadline).read();
}

}  // namespace cde::mesh_readers
