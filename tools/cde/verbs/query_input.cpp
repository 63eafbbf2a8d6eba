// SPDX-License-Identifier: Apache-2.0
#include "verbs/query_input.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include "cde/support/message.hpp"

namespace cde::cli {
namespace {

constexpr std::uint64_t kChunkLines = 65536;
// The first character of a piece's text: whether it holds text or pairs of an array.
constexpr char kText = 't', kArray = 'a';

int opened(const std::string& file) {
  if (file == "-") return STDIN_FILENO;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    const bool words = errno == ENOENT && file.find(' ') != std::string::npos;
    throw Error(
        ErrorCode::kFile,
        fmt::format("{}: cannot be opened: {}{}", printable_name(file), std::strerror(errno),
                    words ? "; expected a file, or the words of pairs on stdin" : ""));
  }
  return descriptor;
}

std::string name_of(const std::string& file) {
  return file == "-" ? "stdin" : printable_name(file);
}

}  // namespace

QueryInput::QueryInput(const std::string& file)
    : name_(name_of(file)), descriptor_(opened(file)), lines_(descriptor_, name_) {
  struct stat info {};
  if (::fstat(descriptor_, &info) == 0 && S_ISREG(info.st_mode))
    size_ = static_cast<double>(info.st_size);
}

QueryInput::~QueryInput() {
  if (descriptor_ != STDIN_FILENO) ::close(descriptor_);
}

std::optional<PairArray> QueryInput::array(PairName named, const WordText& text) {
  if (!PairArray::is_array(lines_.peek(4))) return std::nullopt;
  return PairArray(lines_.rest(), name_, named, text);
}

std::optional<double> QueryInput::share() const {
  if (size_ <= 0) return std::nullopt;
  return std::min(1.0, static_cast<double>(lines_.bytes()) / size_);
}

QueryChunks::QueryChunks(const QueryOptions& options, const PairConfig& config)
    : o_(options),
      named_{config.pair, options.exchanged},
      text_(config.format),
      header_reader_(named_, text_) {}

std::optional<std::string> QueryChunks::next() {
  if (!input_) {
    input_.emplace(o_.file);
    array_ = input_->array(named_, text_);
  }
  if (array_) return next_of_array();
  while (ready_.empty() && more_)
    more_ =
        input_->next([this](std::uint64_t number, std::string_view line) { take(number, line); });
  if (ready_.empty() && lines_ > 0) close();
  if (ready_.empty()) return std::nullopt;
  std::string chunk = std::move(ready_.front());
  ready_.pop_front();
  return chunk;
}

std::optional<std::string> QueryChunks::next_of_array() {
  if (pairs_ == array_->size()) return std::nullopt;
  begin(pairs_, kArray);
  for (; pairs_ < array_->size() && lines_ < kChunkLines; ++lines_)
    chunk_.append(array_->line(pairs_++)).push_back('\n');
  lines_ = 0;
  return std::move(chunk_);
}

void QueryChunks::begin(std::uint64_t number, char kind) {
  chunk_ = fmt::format("{} {} {}\n{}\n", kind, number, pairs_, header_);
}

void QueryChunks::take(std::uint64_t number, std::string_view line) {
  // Every piece begins with the header. In the first piece it keeps its line number.
  if (!begun_ && header_reader_.take_header(line, place_of(o_, false, number))) {
    header_ = line;
    line = {};
    if (lines_ > 0) {  // blank lines and comments before the header
      chunk_.clear();
      lines_ = 0;
    }
  }
  const bool pair = OperandText::has_pair(line);
  begun_ = begun_ || pair;
  if (lines_ == 0) begin(number, kText);
  chunk_.append(line).push_back('\n');
  if (pair) ++pairs_;
  if (++lines_ == kChunkLines) close();
}

void QueryChunks::close() {
  ready_.push_back(std::move(chunk_));
  chunk_.clear();
  lines_ = 0;
}

QueryAnswers answers_to(QueryPipe& pipe, const std::string& chunk) {
  const std::size_t head = chunk.find('\n') + 1, header = chunk.find('\n', head);
  std::size_t after_number = 0;
  std::uint64_t number = std::stoull(chunk.substr(2), &after_number);
  const std::uint64_t pairs = std::stoull(chunk.substr(2 + after_number));
  pipe.begin(std::string_view(chunk).substr(head, header - head), pairs, chunk.front() == kArray);
  for (std::size_t at = header + 1, end = 0; (end = chunk.find('\n', at)) != std::string::npos;
       at = end + 1)
    (void)pipe.read(number++, std::string_view(chunk).substr(at, end - at));
  return pipe.answer();
}

}  // namespace cde::cli
