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

/// Columns that the host computes in binary64 from a record, its ray and its triangle.
enum class RecordField {
  kU,       ///< barycentric weight of the triangle's second corner at CP
  kV,       ///< barycentric weight of its third corner
  kNormal,  ///< geometric unit normal, by the right-hand rule over the corners
  kSide,    ///< 1: the ray hits the side that the normal points from; -1: the other side; 0: no hit
  kNode,    ///< object, group or node of the mesh file to which the triangle belongs
  /// Whether the ray starts inside the mesh, which must be closed (Inside). In a scene, whether the
  /// primary's middle is inside a secondary object (SceneInside).
  kInside,
};
/// "u", "v", "normal", "side", "node", "inside".
[[nodiscard]] std::vector<std::string> field_names();

/// Format and columns of a record file.
struct RecordFormat {
  enum class Kind {
    kCsv,
    kNpy,        ///< a structured array
    kJsonLines,  ///< an object per line
    kWords,      ///< the card's words (docs/reference/scenes.md)
  };
  Kind kind = Kind::kCsv;
  bool frame = false;      ///< the first column is the frame number
  bool scene = false;      ///< primaries, which may be bad, instead of rays
  bool normals = false;    ///< Record::n
  bool bits = false;       ///< CSV only: adds T and CP in hex
  bool only_hits = false;  ///< omits records without a hit
  std::vector<RecordField> fields = {};
  /// Axes of an array of records; their product is the number of records. Without it the array has
  /// one axis.
  std::optional<std::vector<std::uint64_t>> shape = {};

  /// The format of a cast, from the suffix of its path: .csv (or "-"), .npy or .jsonl. Error kUsage
  /// for another suffix, bits without CSV, an unknown field, or fields without a path.
  static RecordFormat of_cast(const std::string& path, bool bits,
                              const std::vector<std::string>& fields);
};

/// Records as the bytes of a file.
class RecordText {
 public:
  /// Fields are computed from mesh and rays, which must outlive this object. Error kBadInput if
  /// `inside` is a field and the mesh is not closed.
  explicit RecordText(RecordFormat format, const Mesh* mesh = nullptr, RayView rays = {});
  /// Whether a primary is inside, in a frame.
  using IsInside = std::function<bool(std::uint32_t frame, std::uint32_t primary)>;
  /// For a scene, whose only field can be `inside`.
  RecordText(RecordFormat format, IsInside is_inside);
  /// The header. `count` is the number of records; only .npy needs it. With `may_grow` the header
  /// has the same size for every count.
  [[nodiscard]] std::string head(std::uint64_t count = 0, bool may_grow = false) const;
  void append(std::span<const Record> records, std::string& to, std::uint32_t frame = 0) const;
  /// Bytes per record of an array.
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

  std::size_t node_bytes_ = 1;  ///< length of the longest node name
  IsInside is_inside_;
};

/// A record file, written as records arrive. If the count of an array is unknown, its header is
/// written last. A regular file reserves space for it; otherwise the data wait in memory.
class RecordFile {
 public:
  /// `count`: the number of records, if known in advance.
  RecordFile(const std::string& path, RecordText text, std::optional<std::uint64_t> count = {})
      : text_(std::move(text)), count_(count), file_(path) {}
  void add(std::span<const Record> records, std::uint32_t frame = 0);
  /// Adds records that RecordText::append has formatted.
  void add_text(std::string_view text);
  void commit();  ///< error kFile if anything could not be written

 private:
  [[nodiscard]] bool is_array() const { return text_.format().kind == RecordFormat::Kind::kNpy; }
  void head();

  RecordText text_;
  std::optional<std::uint64_t> count_;
  bool has_head_ = false;
  std::uint64_t written_ = 0;  ///< bytes after the header
  OutputFile file_;
  std::string bytes_, waiting_;
};

}  // namespace cde
