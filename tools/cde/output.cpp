#include "output.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "cde/error.hpp"

namespace cde::cli {
namespace {

/// Names that a signal removes. Slots are taken and given back by one thread, and read by the
/// handler.
std::array<std::atomic<const char*>, 8> unfinished{};

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

extern "C" void remove_unfinished(int signal) {
  for (const auto& name : unfinished) {
    if (const char* path = name.load()) ::unlink(path);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// A signal that was ignored when the program started (nohup, a shell's `&`) stays ignored.
void handle(int signal, void (*handler)(int)) {
  if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

void install_removal() {
  static const bool installed = [] {
    for (const int signal : kSignals) handle(signal, remove_unfinished);
    return true;
  }();
  (void)installed;
}

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int signal) {
  noted = signal;
  for (const int other : kSignals) handle(other, remove_unfinished);
}

void remember(const char* path) {
  install_removal();
  for (auto& slot : unfinished) {
    const char* none = nullptr;
    if (slot.compare_exchange_strong(none, path)) return;
  }
}

/// Keeps the signals waiting while it lives.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t set;
    ::sigemptyset(&set);
    for (const int signal : kSignals) ::sigaddset(&set, signal);
    ::pthread_sigmask(SIG_BLOCK, &set, &before_);
  }
  ~SignalsWait() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;

 private:
  sigset_t before_{};
};

void forget(const char* path) {
  for (auto& slot : unfinished) {
    const char* expected = path;
    if (slot.compare_exchange_strong(expected, nullptr)) return;
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  if (path == "-") {
    file_ = stdout;
    return;
  }
  temporary_ = path.string() + ".XXXXXX";
  int fd = -1;
  {
    // A signal between the two would find a file that nobody removes.
    const SignalsWait wait;
    fd = ::mkstemp(temporary_.data());
    if (fd >= 0) remember(temporary_.c_str());
  }
  if (fd < 0) {
    temporary_.clear();
    fail("create");
  }
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(fd, 0666 & ~mask);
  file_ = ::fdopen(fd, "w");
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget(temporary_.c_str());
}

void OutputFile::fail(const char* doing) const {
  throw Error(ErrorCode::kFile,
              fmt::format("{}: cannot {}: {}", path_.string(), doing, std::strerror(errno)));
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("write");
}

void OutputFile::commit() {
  if (std::fflush(file_) != 0) fail("write");
  if (file_ == stdout) return;
  if (std::filesystem::is_directory(path_)) errno = EISDIR, fail("write");
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("write");
  std::fclose(file_);
  file_ = nullptr;
  forget(temporary_.c_str());
  temporary_.clear();
}

Interrupts::Interrupts() {
  install_removal();
  for (const int signal : kSignals) handle(signal, note);
}

Interrupts::~Interrupts() {
  for (const int signal : kSignals) handle(signal, remove_unfinished);
}

int Interrupts::signal() {
  return noted;
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), shown_(!quiet && ::isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::operator()(double share) {
  const auto now = Clock::now();
  if (!shown_ || now - start_ < std::chrono::seconds(1)) return;
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = share > 0.001 ? elapsed * (1 - share) / share : 0;
  fmt::print(stderr, "\r\033[K{} {:3.0f} %, {:.0f} s, about {:.0f} s left", what_, 100 * share,
             elapsed, left);
  std::fflush(stderr);
}

std::string shell_word(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::strchr("_-./:,+=@%", c) != nullptr;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace cde::cli
