// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/array_header.hpp"
#include "support/table_form.hpp"

namespace cde::io {

/// Whether a file of these bytes is a NumPy array or an archive of them (.npy, .npz).
[[nodiscard]] bool is_array(std::string_view bytes);

/// A table of numbers from a NumPy array. Its last axis has the columns, or its elements are
/// structures whose fields are columns or groups of them. Rows are numbered in C order whatever the
/// order in memory.
class ArrayTable {
 public:
  /// `bytes` are all of a file .npy or .npz, `name` is the file's for messages. Error kFile for an
  /// array that the form does not describe. The form must outlive it.
  ArrayTable(std::string bytes, std::string name, const text::TableForm& form);

  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  /// Axes ahead of the columns.
  [[nodiscard]] const std::vector<std::uint64_t>& shape() const { return shape_; }
  /// Whether there is a column of this number in the form's names.
  [[nodiscard]] bool has(std::size_t column) const { return has_[column]; }
  /// Number of columns.
  [[nodiscard]] std::size_t columns() const { return columns_.size(); }
  /// Writes the columns that there are into their places among the form's names. Exact; error
  /// kBadInput for a whole number of more than 53 bits.
  void read(std::uint64_t row, std::span<double> values) const;

 private:
  struct Column {
    std::size_t name;
    NumberType type;
    std::uint64_t offset;
  };
  [[noreturn]] void fail(const std::string& why) const;
  void take_axis(const ArrayHeader& header);
  void take_fields(const ArrayHeader& header);
  void take_column(std::size_t name, const NumberType& type, std::uint64_t offset);
  void take_strides(std::uint64_t stride, bool fortran_order);
  [[nodiscard]] std::uint64_t offset_of(std::uint64_t row) const;

  std::string bytes_, name_;
  const text::TableForm& form_;
  std::uint64_t data_ = 0, rows_ = 0;
  std::vector<std::uint64_t> shape_, strides_;
  std::vector<Column> columns_;
  std::vector<bool> has_;
};

}  // namespace cde::io
