// SPDX-License-Identifier: Apache-2.0
#include "io/array_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "cde/fp/fp_format.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "io/zip_entry.hpp"

namespace cde::io {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
T as(std::uint64_t word) {
  T value;
  std::memcpy(&value, &word, sizeof value);
  return value;
}

/// The number at `at`. It is exact, except for whole numbers of more than 53 bits, which clear
/// `fits`.
double load(const char* at, NumberType type, bool& fits) {
  std::uint64_t word = 0;
  auto* const bytes = reinterpret_cast<char*>(&word);
  if (type.big_endian)
    std::reverse_copy(at, at + type.bytes, bytes);
  else
    std::memcpy(bytes, at, type.bytes);
  if (type.kind == 'f')
    return type.bytes == 4   ? static_cast<double>(as<float>(word))
           : type.bytes == 8 ? as<double>(word)
                             : FpFormat{5, 10}.decode(word);
  const unsigned unused = 64 - 8 * type.bytes;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 53;
  if (type.kind == 'u') {
    fits = fits && word <= kMost;
    return static_cast<double>(word);
  }
  const std::int64_t value = static_cast<std::int64_t>(word << unused) >> unused;
  fits = fits && value <= static_cast<std::int64_t>(kMost) &&
         value >= -static_cast<std::int64_t>(kMost);
  return static_cast<double>(value);
}

}  // namespace

bool is_array(std::string_view bytes) {
  // An archive without files begins with its end record.
  return bytes.starts_with(kArrayMark.front()) || bytes.starts_with(kZipMark) ||
         bytes.starts_with("PK\x05\x06");
}

ArrayTable::ArrayTable(std::string bytes, std::string name, const text::TableForm& form)
    : bytes_(std::move(bytes)), name_(std::move(name)), form_(form) {
  if (bytes_.starts_with("PK")) bytes_ = only_array(bytes_, name_, form.arrays);
  const ArrayHeader header = read_array_header(bytes_, name_, form.arrays);
  data_ = header.data;
  has_.assign(form.names.size(), false);
  shape_ = header.shape;
  header.structured ? take_fields(header) : take_axis(header);
  rows_ = 1;
  for (const std::uint64_t axis : shape_) rows_ *= axis;
}

void ArrayTable::fail(const std::string& why) const {
  throw Error(ErrorCode::kFile, fmt::format("{}: {}; {}", name_, why, form_.arrays));
}

void ArrayTable::take_column(std::size_t name, const NumberType& type, std::uint64_t offset) {
  if (has_[name]) fail(fmt::format("its fields have {} twice", form_.names[name]));
  has_[name] = true;
  columns_.push_back({name, type, offset});
}

void ArrayTable::take_axis(const ArrayHeader& header) {
  const std::uint64_t columns = shape_.empty() ? 0 : shape_.back();
  if (std::find(form_.widths.begin(), form_.widths.end(), columns) == form_.widths.end())
    fail("its shape is " + shape_text(shape_));
  shape_.pop_back();
  const NumberType type = header.fields.front().type;
  // A table with fewer columns has the required names first, then optional ones.
  std::vector<std::size_t> names;
  std::size_t left_out = form_.names.size() - columns;
  for (std::size_t name = form_.names.size(); name-- > 0;)
    if (form_.optional[name] && left_out != 0)
      --left_out;
    else
      names.insert(names.begin(), name);
  const std::uint64_t leading = columns == 0 ? 0 : header.elements / columns;
  for (std::size_t i = 0; i < columns; ++i)
    take_column(names[i], type, i * type.bytes * (header.fortran_order ? leading : 1));
  take_strides(type.bytes * (header.fortran_order ? 1 : columns), header.fortran_order);
}

void ArrayTable::take_fields(const ArrayHeader& header) {
  for (const ArrayField& field : header.fields) {
    const auto group = std::find_if(form_.groups.begin(), form_.groups.end(), [&](const auto& g) {
      return g.name == field.name && g.count == field.count;
    });
    const auto name = std::find(form_.names.begin(), form_.names.end(), field.name);
    if (group != form_.groups.end())
      for (std::size_t i = 0; i < group->count; ++i)
        take_column(group->first + i, field.type, field.offset + i * field.type.bytes);
    else if (name != form_.names.end() && field.count == 1)
      take_column(static_cast<std::size_t>(name - form_.names.begin()), field.type, field.offset);
    else
      fail(fmt::format("its field {} of {} number{} is not expected", in_quotes(field.name),
                       field.count, field.count == 1 ? "" : "s"));
  }
  for (std::size_t name = 0; name < has_.size(); ++name)
    if (!has_[name] && !form_.optional[name])
      fail(fmt::format("its fields lack {}", form_.names[name]));
  take_strides(header.element_bytes, header.fortran_order);
}

void ArrayTable::take_strides(std::uint64_t stride, bool fortran_order) {
  strides_.assign(shape_.size(), 0);
  for (std::size_t k = 0; k < shape_.size(); ++k) {
    const std::size_t axis = fortran_order ? k : shape_.size() - 1 - k;
    strides_[axis] = stride;
    stride *= shape_[axis];
  }
}

std::uint64_t ArrayTable::offset_of(std::uint64_t row) const {
  std::uint64_t offset = data_;
  for (std::size_t axis = shape_.size(); axis-- > 0;) {
    offset += (axis == 0 ? row : row % shape_[axis]) * strides_[axis];
    row /= shape_[axis];
  }
  return offset;
}

void ArrayTable::read(std::uint64_t row, std::span<double> values) const {
  const char* const at = bytes_.data() + offset_of(row);
  for (const Column& column : columns_) {
    bool fits = true;
    values[column.name] = load(at + column.offset, column.type, fits);
    if (!fits)
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{}: {} {}: {} is a whole number of more than 53 bits", name_,
                              form_.row, row, form_.names[column.name]));
  }
}

}  // namespace cde::io
