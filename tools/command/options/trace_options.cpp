// SPDX-License-Identifier: Apache-2.0
#include "options/trace_options.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <charconv>

#include "cde/card/trace_file.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suffix.hpp"
#include "options/values.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

TraceOptions window_of(const std::string& text) {
  TraceOptions window;
  const std::size_t colon = text.find(':');
  const auto number = [&](std::size_t first, std::size_t last, std::uint64_t& to) {
    if (first == last) return true;  // unchanged
    const auto [end, error] = std::from_chars(text.data() + first, text.data() + last, to);
    return error == std::errc() && end == text.data() + last;
  };
  if (colon == std::string::npos || text.size() == 1 || !number(0, colon, window.from) ||
      !number(colon + 1, text.size(), window.to) || window.from > window.to)
    throw Error(ErrorCode::kUsage, fmt::format("{} is no window of cycles; expected FROM:TO, FROM: "
                                               "or :TO with FROM not above TO, e.g. 1000:1200",
                                               in_quotes(text)));
  return window;
}

}  // namespace

void TraceRequest::check() const {
  check_suffix("--trace", file, ".fst");
}

TraceOptions TraceRequest::options() const {
  TraceOptions which = window.empty() ? TraceOptions() : window_of(window);
  which.scopes = scopes;
  return which;
}

void add_trace_options(CLI::App& verb, TraceRequest& request, const std::string& what) {
  CLI::Option* trace = file_value(verb.add_option("--trace", request.file, what), "FILE.fst");
  text_value(verb.add_option("--trace-window", request.window,
                             "Write waves of these cycles only, FROM:TO, counted from where the "
                             "waves would begin without this option"),
             "FROM:TO", [](const std::string& text) { (void)window_of(text); })
      ->needs(trace);
  verb.add_option(
          "--trace-scope", request.scopes,
          "Write waves only of scopes and signals that match a pattern with * and ?; repeatable")
      ->type_name("GLOB")
      ->allow_extra_args(false)
      ->needs(trace);
}

void say_stopped(const std::string& file, std::optional<std::uint64_t> last) {
  log("cde: stopped; {} has the waves{}\n", file == "-" ? "stdout" : printable_name(file),
      last ? fmt::format(" until {} ps", *last) : "");
}

}  // namespace cde::cli
