// SPDX-License-Identifier: Apache-2.0
#include "cde/io/pair_array.hpp"

#include <fmt/format.h>

#include <limits>

#include "geometry/operand_table.hpp"
#include "io/array_table.hpp"

namespace cde {

struct PairArray::Table {
  Table(std::string bytes, const std::string& name, PairName pair, const WordText& words)
      : named(pair),
        text(words),
        form(operand_table(pair)),
        array(std::move(bytes), name, form),
        numbers(form.names.size()),
        found(form.names.size()) {
    for (const std::string& column : form.names)
      none.push_back(column.ends_with(".tmax") ? std::numeric_limits<double>::infinity() : 0);
  }

  PairName named;
  WordText text;
  text::TableForm form;
  io::ArrayTable array;
  std::vector<double> none;  ///< default numbers of a pair
  std::vector<double> numbers;
  std::vector<std::uint64_t> found;
};

PairArray::PairArray(std::string bytes, const std::string& name, PairName named,
                     const WordText& text)
    : table_(std::make_unique<Table>(std::move(bytes), name, named, text)) {}
PairArray::PairArray(PairArray&&) noexcept = default;
PairArray& PairArray::operator=(PairArray&&) noexcept = default;
PairArray::~PairArray() = default;

bool PairArray::is_array(std::string_view bytes) {
  return io::is_array(bytes);
}

std::uint64_t PairArray::size() const {
  return table_->array.rows();
}

OperandLine PairArray::read(std::uint64_t pair, const std::string& where,
                            std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                            std::string& why) {
  Table& t = *table_;
  t.numbers = t.none;
  t.array.read(pair, t.numbers);
  for (std::size_t i = 0; i < t.numbers.size(); ++i) {
    std::string problem;
    const auto word = t.text.word_of(t.numbers[i], problem);
    if (!word) {
      why = fmt::format("{}, {}: {}", where, t.form.names[i], problem);
      return OperandLine::kMalformed;
    }
    t.found[i] = *word;
  }
  append_operands(t.named, t.found, a, b);
  return OperandLine::kPair;
}

std::string PairArray::line(std::uint64_t pair) {
  Table& t = *table_;
  t.numbers = t.none;
  t.array.read(pair, t.numbers);
  return fmt::format("{:a}", fmt::join(t.numbers, ","));
}

}  // namespace cde
