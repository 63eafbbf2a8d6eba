// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"

/// Output of the command: results on stdout, messages on stderr. Only these functions write there,
/// except OutputFile to stdout.
namespace cde::cli {

/// Opens each of the descriptors 0, 1 and 2 that is closed, so that no file gets its number.
/// Reading and writing still fail, and messages are lost. From now on a closed pipe on stdout is
/// noticed at the next write.
void prepare_streams();

/// Returns the result of `work`, or the exit status of the exception that it throws, after
/// `complain` has printed its message. Returns 2 if stdout could not be written completely. If
/// stdout is a closed pipe, the process ends quietly as by SIGPIPE.
[[nodiscard]] int exit_status_of(const std::function<int()>& work,
                                 const std::function<void(const std::string&)>& complain);

/// Prints text on stdout, made printable. StdoutError if it cannot be written.
void print(std::string_view text);

/// Prints JSON and a line end on stdout.
void print_json(const nlohmann::ordered_json& json, int indent = 2);

/// A message on stderr.
using cde::log;
template <class First, class... Args>
void log(fmt::format_string<First, Args...> format, First&& first, Args&&... args) {
  cde::log(fmt::format(format, std::forward<First>(first), std::forward<Args>(args)...));
}
/// Prints warnings on stderr, one per line.
void warn(const std::vector<std::string>& warnings);
template <class First, class... Args>
void print(fmt::format_string<First, Args...> format, First&& first, Args&&... args) {
  print(fmt::format(format, std::forward<First>(first), std::forward<Args>(args)...));
}

/// Figures as text. They are results and go to stdout, unless --json uses it.
class Figures {
 public:
  static void beside_json() { on_stdout_ = false; }
  static void print(std::string_view text) {
    if (on_stdout_)
      cli::print(text);
    else
      log(text);
  }

 private:
  static inline bool on_stdout_ = true;
};
template <class... Args>
void print_figure(fmt::format_string<Args...> format, Args&&... args) {
  Figures::print(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace cde::cli
