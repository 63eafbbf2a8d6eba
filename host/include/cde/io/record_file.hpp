// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/image/ray_view.hpp"
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
};
/// "u", "v", "normal", "side", "node".
[[nodiscard]] std::vector<std::string> field_names();

/// Records of rays and triangles as a file: .csv (or "-"), .npy (a structured array) or .jsonl (an
/// object a line), by its suffix.
class RecordFile {
 public:
  /// Error kUsage for another suffix, for --bits without CSV, and for an unknown field. Mesh and
  /// rays must outlive it. `count`: of the records, if it is known before they come.
  RecordFile(const std::string& path, bool bits, const std::vector<std::string>& fields,
             const Mesh& mesh, const RayView& rays, std::optional<std::uint64_t> count);

  /// The names alone: what the constructor would complain about, before anything slow.
  static void check(const std::string& path, bool bits, const std::vector<std::string>& fields);

  void add(std::span<const Record> records);
  void commit();  ///< error kFile if anything could not be written

 private:
  enum class Kind { kCsv, kNpy, kJsonLines };
  struct Details {
    double u, v;
    Eigen::Vector3d normal;
    int side;
    std::string_view node;
  };
  static Kind kind_of(const std::string& path);
  static std::vector<RecordField> parse(const std::vector<std::string>& fields);
  [[nodiscard]] Details details(const Record& record) const;
  void head();
  void csv(const Record& record);
  void npy(const Record& record);
  void json_line(const Record& record);
  [[nodiscard]] std::string npy_fields() const;

  Kind kind_;
  bool bits_;
  std::vector<RecordField> fields_;
  const Mesh& mesh_;
  RayView rays_;
  std::optional<std::uint64_t> count_;  ///< of records, in the header of .npy
  bool has_head_ = false;
  std::uint64_t written_ = 0;
  std::size_t node_bytes_ = 1;  ///< of the longest name of a node
  OutputFile file_;
  fmt::memory_buffer text_;
};

}  // namespace cde
