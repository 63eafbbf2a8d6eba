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

/// The input of `cde query`: stdin or a file, text or an array.
namespace cde::cli {

class QueryInput {
 public:
  /// `file` is a name, or "-" for stdin. Error kFile if it cannot be opened.
  explicit QueryInput(const std::string& file);
  QueryInput(const QueryInput&) = delete;
  QueryInput& operator=(const QueryInput&) = delete;
  ~QueryInput();

  /// Whether reading would wait for whoever writes.
  [[nodiscard]] bool waits() const { return LineInput::waits(descriptor_); }
  /// The array if the input is one; waits for the first bytes.
  [[nodiscard]] std::optional<PairArray> array(PairName named, const WordText& text);
  /// LineInput::next without a byte order mark.
  template <class Line>
  bool next(Line line) {
    return lines_.next([&](std::uint64_t number, std::string_view text) {
      line(number, number == 1 ? OperandText::first_line(text, name_) : text);
    });
  }
  /// How much of a file has been read, from 0 to 1; nothing for other inputs.
  [[nodiscard]] std::optional<double> share() const;

 private:
  std::string name_;
  int descriptor_;
  double size_ = 0;
  LineInput lines_;
};

/// The input in pieces of so many pairs or lines, however it comes, each a text for answers_to().
class QueryChunks {
 public:
  /// The options must outlive it. The input is opened when the first piece is asked for.
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
  std::uint64_t pairs_ = 0;  ///< so far
  std::deque<std::string> ready_;
  std::string chunk_;
  std::uint64_t lines_ = 0;
};

/// The pairs of a piece through a pipe.
[[nodiscard]] QueryAnswers answers_to(QueryPipe& pipe, const std::string& chunk);

}  // namespace cde::cli
