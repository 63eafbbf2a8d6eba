// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/inside.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/query/record.hpp"
#include "cde/support/output_file.hpp"

namespace cde {

/// Columns of a record that the card does not write; the host computes them, in binary64, from the
/// record, its ray and its triangle.
enum class RecordField {
  kU,       ///< barycentric weight of the triangle's second corner at CP
  kV,       ///< and of its third
  kNormal,  ///< geometric normal, unit, by the right-hand rule over the corners
  kSide,    ///< 1: the ray meets the side that the normal points from, -1 the other, 0 no hit
  kNode,    ///< object, group or node of the mesh file that the triangle came from
  kInside,  ///< whether the ray starts inside the mesh, which must be closed (Inside); of a scene
            ///< whether the primary's middle is inside a secondary object (SceneInside)
};
/// "u", "v", "normal", "side", "node", "inside".
[[nodiscard]] std::vector<std::string> field_names();

/// The format of a file of records, and its columns.
struct RecordFormat {
  enum class Kind {
    kCsv,
    kNpy,        ///< a structured array
    kJsonLines,  ///< an object per line
    kWords,      ///< the card's words (docs/scenes.md)
  };
  Kind kind = Kind::kCsv;
  bool frame = false;      ///< the first column is the frame
  bool scene = false;      ///< primaries, which may be bad, instead of rays
  bool normals = false;    ///< Record::n
  bool bits = false;       ///< of CSV: T and CP in hex as well
  bool only_hits = false;  ///< other records are left out
  std::vector<RecordField> fields = {};
  /// Axes of an array of records, whose product is their number; else it has one.
  std::optional<std::vector<std::uint64_t>> shape = {};

  /// That of a cast by the suffix of its path: .csv (or "-"), .npy or .jsonl. Error kUsage for
  /// another suffix, for bits without CSV, for an unknown field, and for fields without a path.
  static RecordFormat of_cast(const std::string& path, bool bits,
                              const std::vector<std::string>& fields);
};

/// Records as the bytes of a file.
class RecordText {
 public:
  /// Fields are computed from mesh and rays, which must outlive it. Error kBadInput of a mesh that
  /// is not closed if `inside` is one of them.
  explicit RecordText(RecordFormat format, const Mesh* mesh = nullptr, RayView rays = {});
  /// Whether a primary is inside, in a frame.
  using IsInside = std::function<bool(std::uint32_t frame, std::uint32_t primary)>;
  /// Of a scene, whose only field can be `inside`.
  RecordText(RecordFormat format, IsInside is_inside);
  /// The header. `count`: of the records, which .npy alone needs. If the count may grow, the
  /// header has as many bytes for every count.
  [[nodiscard]] std::string head(std::uint64_t count = 0, bool may_grow = false) const;
  void append(std::span<const Record> records, std::string& to, std::uint32_t frame = 0) const;
  /// Bytes of a record in an array.
  [[nodiscard]] std::size_t record_bytes() const;
  [[nodiscard]] const RecordFormat& format() const { return format_; }

 private:
  template <class Cells>
  void row(const Record& record, std::uint32_t frame, const Cells& cells) const;
  template <class Cells>
  void fields(const Record& record, std::uint32_t frame, const Cells& cells) const;

  RecordFormat format_;
  const Mesh* mesh_;
  RayView rays_;
  [[nodiscard]] bool has(RecordField field) const;

  std::size_t node_bytes_ = 1;  ///< of the longest name of a node
  IsInside is_inside_;
};

/// Records as a file, written as they come. An array whose count is not known gets its header last:
/// in a regular file it has room for one, for others the data wait in memory.
class RecordFile {
 public:
  /// `count`: of the records, if it is known before they come.
  RecordFile(const std::string& path, RecordText text, std::optional<std::uint64_t> count = {})
      : text_(std::move(text)), count_(count), file_(path) {}
  void add(std::span<const Record> records, std::uint32_t frame = 0);
  /// Adds records that RecordText::append has made text of.
  void add_text(std::string_view text);
  void commit();  ///< error kFile if anything could not be written

 private:
  [[nodiscard]] bool is_array() const { return text_.format().kind == RecordFormat::Kind::kNpy; }
  void head();

  RecordText text_;
  std::optional<std::uint64_t> count_;
  bool has_head_ = false;
  std::uint64_t written_ = 0;  ///< bytes behind the header
  OutputFile file_;
  std::string bytes_, waiting_;
};

}  // namespace cde
