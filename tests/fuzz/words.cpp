// SPDX-License-Identifier: Apache-2.0
// libFuzzer on arguments of `cde wave`: expressions, conditions, times, edges, names with a format.
// Each is an Error kUsage or valid, and a valid one is evaluated over the whole sample.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "../wave/sample.hpp"
#include "cde/support/error.hpp"
#include "cde/wave/event.hpp"
#include "cde/wave/expression.hpp"
#include "cde/wave/filter.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cde::wave;

Trace& sample() {
  static Trace trace = [] {
    const fs::path file = fs::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()));
    cde::testing::write_sample(file);
    Trace read(file);
    (void)read.signals();
    return read;
  }();
  return trace;
}

void evaluate(const std::string& text) {
  Trace& trace = sample();
  Expression expression(trace, text, "EXPR");
  std::vector<std::uint32_t> handles;
  for (const View& v : expression.views()) handles.push_back(v.signal.handle);
  std::uint64_t now = trace.start();
  trace.stream(handles, trace.start(), trace.end(),
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) (void)expression.evaluate();
                 now = time;
                 expression.set(handle, value);
                 return true;
               });
  (void)expression.evaluate();
}

void filter(const std::string& text) {
  Times times(sample(), "");
  const Filter condition(text, {}, times);
  Transaction t;
  t.kind = "pci", t.label = "write", t.outcome = "done";
  (void)condition.matches(t);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 300) return 0;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    switch (data[0] % 6) {
      case 0:
      case 1:
        evaluate(text);
        break;
      case 2:
        filter(text);
        break;
      case 3:
        (void)Times(sample(), "").parse(text);
        break;
      case 4:
        (void)Event(sample(), text);
        break;
      default:
        (void)views(sample(), text, {});
    }
  } catch (const cde::Error& e) {
    if (e.code() != cde::ErrorCode::kUsage) std::abort();
  }
  return 0;
}
