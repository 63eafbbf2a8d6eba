// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "cde/io/pair_array.hpp"
#include "options/line_input.hpp"
#include "verbs/query_pipe.hpp"

/// The input of `cde query`: stdin or a file, with text or an array.
namespace cde::cli {

class QueryInput {
 public:
  /// `file` is a name, or "-" for stdin. Error kFile if it cannot be opened.
  explicit QueryInput(const std::string& file);
  QueryInput(const QueryInput&) = delete;
  QueryInput& operator=(const QueryInput&) = delete;
  ~QueryInput();

  /// Whether a read would wait for the writer.
  [[nodiscard]] bool waits() const { return LineInput::waits(descriptor_); }
  /// The array, if the input is one. Waits for the first bytes.
  [[nodiscard]] std::optional<PairArray> array(PairName named, const WordText& text);
  /// LineInput::next without a byte order mark.
  template <class Line>
  bool next(Line line) {
    return lines_.next([&](std::uint64_t number, std::string_view text) {
      line(number, number == 1 ? OperandText::first_line(text, name_) : text);
    });
  }
  /// The share of a file that has been read, from 0 to 1; nothing for other inputs.
  [[nodiscard]] std::optional<double> share() const;

 private:
  std::string name_;
  int descriptor_;
  double size_ = 0;
  LineInput lines_;
};

/// The input in pieces with a fixed number of pairs or lines. Each piece is a text for
/// answers_to().
class QueryChunks {
 public:
  /// The options must outlive the object. The input is opened at the first piece.
  QueryChunks(const QueryOptions& options, const PairConfig& config);
  std::optional<std::string> next();

 private:
  void take(std::uint64_t number, std::string_view line);
  [[nodiscard]] std::optional<std::string> next_of_array();
  void begin(std::uint64_t number, char kind);
  void close();

  const QueryOptions& o_;
  PairName named_;
  WordText text_;
  std::optional<QueryInput> input_;
  std::optional<PairArray> array_;
  OperandText header_reader_;
  std::string header_;
  bool begun_ = false, more_ = true;
  std::uint64_t pairs_ = 0;  ///< read so far
  std::deque<std::string> ready_;
  std::string chunk_;
  std::uint64_t lines_ = 0;
};

/// The answers of a pipe to the pairs of a piece.
[[nodiscard]] QueryAnswers answers_to(QueryPipe& pipe, const std::string& chunk);

}  // namespace cde::cli
