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

/// What the command prints: results on stdout, messages on stderr. Nothing else writes to either,
/// but OutputFile to stdout.
namespace cde::cli {

/// A descriptor among 0, 1 and 2 that is closed is taken, so that no file gets its number: reading
/// and writing fail as before, messages are lost. A reader of stdout that has gone is noticed when
/// something is written.
void prepare_streams();

/// What `work` returns, or the exit status of what it throws, of which `complain` tells; 2 if not
/// all of stdout could be written. Ends as by SIGPIPE, in silence, if the reader of stdout has
/// gone.
[[nodiscard]] int exit_status_of(const std::function<int()>& work,
                                 const std::function<void(const std::string&)>& complain);

/// Text on stdout, made printable. StdoutError if it cannot be written.
void put(std::string_view text);

/// JSON on stdout, with the end of the line.
void put_json(const nlohmann::ordered_json& json, int indent = 2);

/// A message on stderr.
using cde::say;
template <class First, class... Args>
void say(fmt::format_string<First, Args...> format, First&& first, Args&&... args) {
  cde::say(fmt::format(format, std::forward<First>(first), std::forward<Args>(args)...));
}
/// Warnings on stderr, a line each.
void warn(const std::vector<std::string>& warnings);
template <class First, class... Args>
void put(fmt::format_string<First, Args...> format, First&& first, Args&&... args) {
  put(fmt::format(format, std::forward<First>(first), std::forward<Args>(args)...));
}

/// Figures for people: results, and so on stdout, unless --json has that.
class Figures {
 public:
  static void beside_json() { on_stdout_ = false; }
  static void show(std::string_view text) {
    if (on_stdout_)
      put(text);
    else
      say(text);
  }

 private:
  static inline bool on_stdout_ = true;
};
template <class... Args>
void show(fmt::format_string<Args...> format, Args&&... args) {
  Figures::show(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace cde::cli
