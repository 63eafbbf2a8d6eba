// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/wave_file.hpp"

#include <array>

#include "cde/wave/trace.hpp"

namespace cde::wave {

std::map<std::string, unsigned> signals(const std::filesystem::path& file) {
  Trace trace(file);
  std::map<std::string, unsigned> found;
  for (const Signal& s : trace.signals()) found[s.name] = s.handle;
  return found;
}

std::map<std::uint64_t, std::string> changes(const std::filesystem::path& file, unsigned handle) {
  Trace trace(file);
  std::map<std::uint64_t, std::string> values;
  trace.stream(std::array{handle}, trace.start(), trace.end(),
               [&](std::uint64_t time, std::uint32_t, std::string_view value) {
                 values[time] = value;
                 return true;
               });
  return values;
}

std::set<std::string> values(const std::filesystem::path& file, unsigned handle) {
  std::set<std::string> values;
  for (const auto& [time, value] : changes(file, handle)) values.insert(value);
  return values;
}

}  // namespace cde::wave
