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

/// Whether these bytes are a NumPy array (.npy) or an archive of arrays (.npz).
[[nodiscard]] bool is_array(std::string_view bytes);

/// A table of numbers from a NumPy array. The array's last axis holds the columns, or its elements
/// are structures whose fields are columns or groups of columns. Rows are numbered in C order,
/// whatever the memory order.
class ArrayTable {
 public:
  /// `bytes` is a whole .npy or .npz file, and `name` is the file's name for messages. Error kFile
  /// if the form does not describe the array. The form must outlive the table.
  ArrayTable(std::string bytes, std::string name, const text::TableForm& form);

  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  /// Axes before the columns.
  [[nodiscard]] const std::vector<std::uint64_t>& shape() const { return shape_; }
  /// Whether the table has the form's column of this number.
  [[nodiscard]] bool has(std::size_t column) const { return has_[column]; }
  /// Number of columns.
  [[nodiscard]] std::size_t columns() const { return columns_.size(); }
  /// Writes the table's columns to their places among the form's names. Values are exact. Error
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
