// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "mesh/readers.hpp"
#include "support/text.hpp"

// Reads OFF in text: a header, the numbers of vertices, faces and edges, then a vertex or a face
// per line. Normals, colours and texture coordinates behind a vertex, and colours behind a face,
// are skipped. Comments and empty lines may be anywhere. Some writers leave out the header, or
// write the numbers directly behind it. OFF in binary or with other numbers of dimensions is an
// error.
namespace cde::mesh_readers {
namespace {

class OffReader {
 public:
  OffReader(std::string_view bytes, const std::string& name, const Deadline& deadline)
      : lines_(text::without_mark(bytes)), name_(name), deadline_(deadline) {}

  Mesh read() {
    std::string_view line = header();
    vertices_ = count(line, "vertices");
    faces_ = count(line, "faces");
    // The edges are often 0, or left out.
    if (const std::string_view word = text::next_word(line); !word.empty())
      (void)whole(word, "a number of edges");
    if (const std::string_view word = text::next_word(line); !word.empty())
      fail(fmt::format("{} behind the numbers of vertices, faces and edges", in_quotes(word)));
    for (std::uint64_t i = 0; i < vertices_; ++i) vertex(next("vertices", i, vertices_));
    for (std::uint64_t i = 0; i < faces_; ++i) face(next("faces", i, faces_));
    if (const auto rest = next())
      fail(fmt::format("{} behind the last of {} faces", in_quotes(*rest), faces_));
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}:{}: {}", name_, lines_.number(), why));
  }

  /// The next line with content, without its comment.
  std::optional<std::string_view> next() {
    while (auto line = lines_.next()) {
      if (lines_.number() % 4096 == 0) deadline_.check(name_);
      const std::string_view content = text::trim(line->substr(0, line->find('#')));
      if (!content.empty()) return content;
    }
    return std::nullopt;
  }
  std::string_view next(const char* what, std::uint64_t read, std::uint64_t expected) {
    if (const auto line = next()) return *line;
    fail(fmt::format("the file ends after {} of {} {}", read, expected, what));
  }

  /// The line with the numbers. The header is [ST][C][N]OFF.
  std::string_view header() {
    std::string_view line = next("lines", 0, 1);
    std::string_view rest = line;
    for (const std::string_view prefix : {"ST", "C", "N"})
      if (rest.starts_with(prefix)) rest.remove_prefix(prefix.size());
    if (!rest.starts_with("OFF")) {
      const bool number = line.front() >= '0' && line.front() <= '9';
      if (number && line.find("OFF") == std::string_view::npos) return line;  // without a header
      fail(fmt::format("{} begins the file; expected OFF, with ST, C or N before it",
                       in_quotes(line)));
    }
    rest = text::trim(rest.substr(3));
    if (rest.empty()) return next("numbers", 0, 3);
    if (rest == "BINARY") fail("binary OFF is not read");
    return rest;
  }

  std::uint64_t whole(std::string_view word, const char* what) const {
    std::uint64_t number = 0;
    if (!text::parse_int(word, number)) fail(fmt::format("{} is not {}", in_quotes(word), what));
    return number;
  }

  std::uint64_t count(std::string_view& line, const char* what) const {
    const std::string_view word = text::next_word(line);
    if (word.empty()) fail(fmt::format("no number of {}", what));
    return whole(word, "a number of vertices or faces");
  }

  void vertex(std::string_view line) {
    Eigen::Vector3f v;
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = text::next_word(line);
      if (word.empty()) fail("a vertex needs three coordinates");
      const text::Number result = text::parse_float(word, v[i]);
      if (result == text::Number::kOverflow)
        fail(fmt::format("{} overflows a float", in_quotes(word)));
      if (result != text::Number::kOk) fail(fmt::format("{} is not a number", in_quotes(word)));
    }
    mesh_.vertices.push_back(v);
  }

  void face(std::string_view line) {
    const std::uint64_t corners = whole(text::next_word(line), "a number of corners");
    if (corners == 0) fail("a face needs corners");
    corners_.clear();
    for (std::uint64_t i = 0; i < corners; ++i) {
      const std::string_view word = text::next_word(line);
      if (word.empty()) fail(fmt::format("a face has {} of {} corners", i, corners));
      const std::uint64_t corner = whole(word, "a vertex number");
      if (corner >= vertices_)
        fail(fmt::format("vertex number {} is out of range: there are {} vertices, from 0 on",
                         corner, vertices_));
      corners_.push_back(static_cast<std::uint32_t>(corner));
    }
    if (const std::string why = append_polygon(mesh_, corners_, deadline_); !why.empty()) fail(why);
  }

  text::Lines lines_;
  const std::string& name_;
  const Deadline& deadline_;
  std::uint64_t vertices_ = 0, faces_ = 0;
  std::vector<std::uint32_t> corners_;
  Mesh mesh_;
};

}  // namespace

Mesh read_off(std::string_view bytes, const std::string& name, const Deadline& deadline) {
  text::require_utf8(bytes, name);
  return OffReader(bytes, name, deadline).read();
}

}  // namespace cde::mesh_readers
