// SPDX-License-Identifier: Apache-2.0
#include "cde/jobs/journal.hpp"
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <system_error>

#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "support/output_target.hpp"

namespace cde {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "cde.journal.3";
constexpr std::uint64_t kMostOfAnything = std::uint64_t{1} << 40;  ///< largest number in a journal
constexpr std::size_t kLongestLine = 1 << 20;  ///< bytes of JSON; mostly the words of the command

/// Bytes from a place of a file on: fewer at the end of the file, nothing if it cannot be read.
std::optional<std::string> bytes_at(int file, std::uint64_t at, std::size_t count) {
  std::string bytes(count, '\0');
  std::size_t got = 0;
  while (got < count) {
    const ssize_t n = ::pread(file, bytes.data() + got, count - got, static_cast<off_t>(at + got));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return std::nullopt;
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

/// The end of the first line, behind the fields that it covers.
std::string end_of_first(std::string_view fields) {
  return fmt::format(",\"fingerprint\":\"{}\"}}", fingerprint(fields));
}

/// The fingerprint of a chunk: its run, its number, its input and its bytes.
std::string print_of(std::string_view run, ChunkNumber number, std::string_view input,
                     std::string_view bytes) {
  return fingerprint(
      fmt::format("{} {} {} {} {}", run, number.part, number.chunk, input, fingerprint(bytes)));
}

}  // namespace

std::string fingerprint(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

Journal::Journal(std::string what, std::string path, Use use, const Json& run, const Json& beside)
    : what_(std::move(what)), path_(std::move(path)) {
  open(use);
  try {
    const std::uint64_t whole = scan();
    if (use == Use::kRead) {
      warn_dropped(whole, "is ignored");
      return;
    }
    if (whole != 0) check_run(run);
    warn_dropped(whole, "is computed again");
    if (whole != bytes_ && ::ftruncate(file_, static_cast<off_t>(whole)) != 0) fail("cannot write");
    bytes_ = whole;
    if (whole != 0) return;
    run_ = Json{{"schema", kSchema}};
    run_.update(run);
    run_.update(beside);
    std::string fields = json_text(run_, -1);
    fields.pop_back();  // the brace
    run_print_ = fingerprint(fields);
    append(fields + end_of_first(fields) + "\n");
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() {
  ::close(file_);
}

void Journal::open(Use use) {
  // Without O_NONBLOCK, opening a FIFO would wait for a writer.
  if (use == Use::kRead) {
    file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file_ < 0) fail("cannot open");
  } else {
    try {
      // Users who could open the file could hold its lock.
      file_ = open_output(follow_output(path_), O_RDWR | O_CREAT | O_NONBLOCK, 0600).release();
    } catch (const Error& e) {
      throw Error(e.code(), fmt::format("{}: {}", what_, e.what()));
    }
  }
  struct stat status {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(file_);
    throw Error(ErrorCode::kFile,
                fmt::format("{}: {} is not a regular file", what_, printable_name(path_)));
  }
  check_owner(status, use);
  bytes_ = static_cast<std::uint64_t>(status.st_size);
  if (use == Use::kRead || ::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(file_);
  throw Error(ErrorCode::kUsage,
              fmt::format("{}: another process works on {}", what_, printable_name(path_)));
}

/// A journal's command is run, and it names files that are written. Its results are not checked
/// again. So the owner must be trusted.
void Journal::check_owner(const struct stat& status, Use use) {
  const bool ours = status.st_uid == ::geteuid() || status.st_uid == 0;
  if (ours && (status.st_mode & S_IWOTH) == 0) return;
  ::close(file_);
  throw Error(
      ErrorCode::kFile,
      fmt::format(
          "{}: {} is refused, because its {}: {}", what_, printable_name(path_),
          use == Use::kRead ? "command would be run" : "results would not be checked again",
          ours ? "all users can write it (chmod o-w)"
               : fmt::format("it belongs to user {}; make a copy of your own", status.st_uid)));
}

void Journal::fail(const char* doing) const {
  throw Error(ErrorCode::kFile, fmt::format("{}: {}: {}: {}", what_, printable_name(path_), doing,
                                            std::generic_category().message(errno)));
}

void Journal::damaged(std::uint64_t at, std::string_view why) const {
  throw Error(ErrorCode::kFile,
              fmt::format("{}: {}, byte {}: {}", what_, printable_name(path_), at, why));
}

/// A truncated last entry looks like one with a byte count that is too large, so say what happens.
void Journal::warn_dropped(std::uint64_t whole, const char* result) const {
  if (whole == bytes_) return;
  log(
      fmt::format("cde: warning: journal {}: the last entry, from byte {} on, is unfinished ({} "
                  "bytes) and {}\n",
                  printable_name(path_), whole, bytes_ - whole, result));
}

/// A line without its line end; nothing if the file ends within the line.
std::optional<std::string> Journal::line_at(std::uint64_t at) const {
  std::string line;
  while (line.size() < kLongestLine) {
    const auto more = bytes_at(file_, at + line.size(), 4096);
    if (!more) fail("cannot read");
    if (more->empty()) return std::nullopt;
    const std::size_t end = more->find('\n');
    line.append(*more, 0, end);
    if (end != std::string::npos) return line;
  }
  damaged(at, "not a journal of a run");
}

/// Reads the whole entries and returns the number of bytes that they take.
std::uint64_t Journal::scan() {
  std::uint64_t at = 0;
  while (at < bytes_) {
    const auto line = line_at(at);
    if (!line) {
      // The first line may be cut off.
      const std::string begin = "{\"schema\":\"cde.journal.";
      if (at == 0 &&
          !begin.starts_with(*bytes_at(file_, 0, std::min<std::uint64_t>(begin.size(), bytes_))))
        damaged(0, "not a journal of a run");
      return at;
    }
    const Json entry = parse_json(*line);
    if (!entry.is_object())
      damaged(at, at == 0 ? "not a journal of a run" : "not a chunk of a journal");
    std::uint64_t next = at + line->size() + 1;
    try {
      if (at == 0) {
        read_first(*line, entry);
      } else if (!scan_entry(entry, at, next)) {
        return at;
      }
    } catch (const Json::exception&) {
      damaged(at, "not a chunk of a journal");
    }
    at = next;
  }
  return at;
}

/// Reads the line that identifies the run.
void Journal::read_first(const std::string& line, const Json& entry) {
  const Json schema = entry.value("schema", Json());
  const bool other = schema.is_string() &&
                     schema.get_ref<const std::string&>().starts_with("cde.journal.") &&
                     schema != kSchema;
  if (other)
    throw Error(ErrorCode::kFile,
                fmt::format("{}: {} is a journal of another version of cde, {}; this version reads "
                            "{}; remove the file and run its command again",
                            what_, printable_name(path_), json_text(schema, -1), kSchema));
  if (schema != kSchema) damaged(0, "not a journal of this version");
  const std::size_t size = end_of_first({}).size();
  const std::string_view fields = std::string_view(line).substr(0, line.size() - size);
  if (line.size() < size || !line.ends_with(end_of_first(fields)))
    damaged(0, "the line is damaged: its fingerprint is another");
  run_print_ = fingerprint(fields);
  run_ = entry;
  run_.erase("fingerprint");
}

/// The place after this byte where an entry's line begins.
std::optional<std::uint64_t> Journal::entry_within(std::uint64_t from) const {
  constexpr std::string_view kBegin = "\n{\"part\":";
  constexpr std::uint64_t kWindow = 16 << 20;  // bytes searched at a time
  for (; from < bytes_; from += kWindow) {
    const auto rest = bytes_at(file_, from, std::min(bytes_ - from, kWindow + kLongestLine));
    if (!rest) fail("cannot read");
    for (std::size_t at = rest->find(kBegin); at < kWindow; at = rest->find(kBegin, at + 1)) {
      const std::size_t end = rest->find('\n', at + 1);
      if (end == std::string::npos) continue;
      const Json entry = parse_json(rest->substr(at + 1, end - at - 1));
      if (entry.is_object() && (entry.contains("chunk") || entry.contains("chunks")))
        return from + at + 1;
    }
  }
  return std::nullopt;
}

/// Sets `next` to the byte behind the entry. False if the file ends within the entry.
bool Journal::scan_entry(const Json& entry, std::uint64_t at, std::uint64_t& next) {
  const auto count = [&](const char* key, std::uint64_t limit = kMostOfAnything) {
    const Json& number = entry.at(key);
    if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= limit)
      damaged(at, "not a chunk of a journal");
    return number.get<std::uint64_t>();
  };
  const auto part = static_cast<unsigned>(count("part", std::uint64_t{1} << 32));
  const auto check_number = [&](std::uint64_t chunk) {
    const auto end = end_of(part);
    if (end && chunk >= end->chunks)
      damaged(at,
              fmt::format("the journal has a chunk {}, but its part {} has {} chunks, from 0 on",
                          chunk, part, end->chunks));
  };
  if (entry.contains("chunks")) {
    ends_[part] = {count("chunks"), entry.at("inputs").get<std::string>()};
    if (const auto last = last_chunk(part)) check_number(*last);
    return true;
  }
  const ChunkPlace place{.at = next,
                         .bytes = count("bytes"),
                         .fingerprint = entry.at("fingerprint").get<std::string>(),
                         .input = entry.at("input").get<std::string>()};
  if (place.bytes >= bytes_ || next + place.bytes + 1 > bytes_) {
    // Only the last entry may be unfinished. If another entry begins within it, its byte count is
    // wrong.
    if (const auto another = entry_within(next))
      damaged(at, fmt::format("the chunk claims {} bytes, but another entry begins at byte {}",
                              place.bytes, *another));
    return false;
  }
  next += place.bytes;
  if (*bytes_at(file_, next, 1) != "\n") damaged(at, "the chunk has another length than it claims");
  ++next;
  const std::uint64_t chunk = count("chunk");
  check_number(chunk);
  if (!chunks_.emplace(ChunkNumber{part, chunk}, place).second)
    damaged(at, "the chunk appears twice");
  return true;
}

void Journal::check_run(const Json& run) const {
  for (const auto& [key, value] : run.items()) {
    const Json there = run_.contains(key) ? run_.at(key) : Json();
    if (there == value) continue;
    throw Error(
        ErrorCode::kUsage,
        fmt::format("{}: {} belongs to a run with {} {}; this run has {}", what_,
                    printable_name(path_), key, json_text(there, -1), json_text(value, -1)));
  }
}

std::string Journal::read(ChunkNumber number, const Check& check) const {
  const ChunkPlace& place = chunks_.at(number);
  const auto bytes = bytes_at(file_, place.at, place.bytes);
  if (!bytes) fail("cannot read");
  if (print_of(run_print_, number, place.input, *bytes) != place.fingerprint)
    damaged(place.at,
            "the chunk is damaged, or belongs to another run; remove the file and run its command "
            "again");
  const auto refuse = [&](const char* why) {
    damaged(place.at, fmt::format("the chunk is no result of this run: {}", why));
  };
  try {
    if (check) check(*bytes);
  } catch (const Error& e) {
    refuse(e.what());
  } catch (const Json::exception& e) {
    refuse(e.what());
  }
  return *bytes;
}

void Journal::check_input(ChunkNumber number, const std::string& input) const {
  if (chunks_.at(number).input == input) return;
  throw Error(ErrorCode::kUsage,
              fmt::format("{}: {} belongs to a run with another input: its chunk {} differs", what_,
                          printable_name(path_), number.chunk));
}

bool Journal::lost() {
  warn_if_lost();
  return lost_;
}

void Journal::append(std::string_view bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n =
        ::pwrite(file_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(bytes_ + at));
    if (n < 0 && errno != EINTR) {
      const int why = errno;
      (void)!::ftruncate(file_, static_cast<off_t>(bytes_));
      errno = why;
      fail("cannot write");
    }
    if (n > 0) at += static_cast<std::size_t>(n);
  }
  bytes_ += bytes.size();
  warn_if_lost();
}

/// Warns once if the path no longer leads to the file. Its entries are lost when it is closed.
void Journal::warn_if_lost() {
  struct stat ours {
  }, named{};
  if (lost_ || (::fstat(file_, &ours) == 0 && ::stat(path_.c_str(), &named) == 0 &&
                ours.st_dev == named.st_dev && ours.st_ino == named.st_ino))
    return;
  lost_ = true;
  log(
      fmt::format("cde: warning: journal {}: the file was removed or replaced in the meantime; "
                  "this run cannot be resumed\n",
                  printable_name(path_)));
}

void Journal::add(ChunkNumber number, const std::string& input, std::string_view bytes) {
  ChunkPlace place{.at = 0,
                   .bytes = bytes.size(),
                   .fingerprint = print_of(run_print_, number, input, bytes),
                   .input = input};
  std::string text = json_text(Json{{"part", number.part},
                                    {"chunk", number.chunk},
                                    {"bytes", place.bytes},
                                    {"fingerprint", place.fingerprint},
                                    {"input", place.input}},
                               -1) +
                     "\n";
  place.at = bytes_ + text.size();
  text.append(bytes).append("\n");
  append(text);
  chunks_.emplace(number, std::move(place));
}

void Journal::end_part(unsigned part, const PartEnd& end) {
  if (const auto known = end_of(part)) {
    if (*known == end) return;
    throw Error(
        ErrorCode::kUsage,
        fmt::format("{}: {} belongs to a run with another input: it has {} chunks, this run {}{}",
                    what_, printable_name(path_), known->chunks, end.chunks,
                    known->chunks == end.chunks ? ", and they differ" : ""));
  }
  if (const auto last = last_chunk(part); last && *last >= end.chunks)
    throw Error(ErrorCode::kUsage,
                fmt::format("{}: {} belongs to a run with another input: it has a chunk {}, this "
                            "run has {} chunks, from 0 on",
                            what_, printable_name(path_), *last, end.chunks));
  append(json_text(Json{{"part", part}, {"chunks", end.chunks}, {"inputs", end.inputs}}, -1) +
         "\n");
  ends_.emplace(part, end);
}

/// The largest number of a stored chunk of the part.
std::optional<std::uint64_t> Journal::last_chunk(unsigned part) const {
  const auto behind = chunks_.upper_bound(ChunkNumber{part, kMostOfAnything});
  if (behind == chunks_.begin()) return std::nullopt;
  const ChunkNumber& last = std::prev(behind)->first;
  return last.part == part ? std::optional(last.chunk) : std::nullopt;
}

std::optional<Journal::PartEnd> Journal::end_of(unsigned part) const {
  const auto at = ends_.find(part);
  return at == ends_.end() ? std::nullopt : std::optional(at->second);
}

}  // namespace cde
