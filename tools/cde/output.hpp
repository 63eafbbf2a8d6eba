#pragma once
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

/// Files that appear whole or not at all, and progress on a terminal.
namespace cde::cli {

/// A file written beside its name and renamed by commit(). Left uncommitted, or on SIGINT, SIGTERM
/// and SIGHUP, nothing of it remains. "-" is stdout.
class OutputFile {
 public:
  /// Error kFile if the file cannot be made.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  void commit();  ///< error kFile if anything could not be written

  /// The name that it has until commit(), for writers that open files themselves.
  [[nodiscard]] const std::string& temporary() const { return temporary_; }

 private:
  [[noreturn]] void fail(const char* doing) const;
  std::filesystem::path path_;
  std::string temporary_;
  std::FILE* file_ = nullptr;
};

/// While it lives, the first SIGINT, SIGTERM or SIGHUP is only noted, so that what is done can be
/// written; a second one ends the process as without it. One at a time.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  /// The signal that came, or 0; stays after the object's end.
  [[nodiscard]] static int signal();
};

/// One line on stderr that is rewritten in place, from the first second on; nothing unless stderr
/// is a terminal.
class Progress {
 public:
  explicit Progress(std::string what, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void operator()(double share);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// A word as a shell reads it back.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace cde::cli
