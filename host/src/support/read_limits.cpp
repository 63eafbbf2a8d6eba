// SPDX-License-Identifier: Apache-2.0
#include "cde/support/read_limits.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/sanitizer.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

std::optional<std::uint32_t> number(const char* name, std::uint32_t most) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  if (text == nullptr || *text == '\0') return std::nullopt;
  std::uint32_t value = 0;
  if (!text::parse_int(text, value) || value == 0 || value > most)
    throw Error(ErrorCode::kUsage, fmt::format("{} is {}; it must be a whole number from 1 to {}",
                                               name, in_quotes(text), most));
  return value;
}

/// A pipe can have any size, so its limits are large.
std::uint64_t size_of(const std::filesystem::path& file) {
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 50;
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(file, none);
  return none ? kLarge : std::min<std::uint64_t>(size, kLarge);
}

}  // namespace

ReadLimits ReadLimits::from_environment() {
  ReadLimits limits;
  if (const auto seconds = number("CDE_READ_SECONDS", 86'400))
    limits.time = std::chrono::seconds(*seconds);
  if (const auto megabytes = number("CDE_READ_MEMORY", 1u << 24))
    limits.memory = std::uint64_t{*megabytes} << 20;
  return limits;
}

std::uint64_t ReadLimits::memory_for(const std::filesystem::path& file) {
  constexpr std::uint64_t kLeast = std::uint64_t{2} << 30, kPerByte = 64;
  return from_environment().memory.value_or(kLeast + kPerByte * size_of(file));
}

std::chrono::seconds ReadLimits::time_for(const std::filesystem::path& file) {
  return time_for(size_of(file));
}

std::chrono::seconds ReadLimits::time_for(std::uint64_t bytes) {
  constexpr std::uint64_t kLeast = 30, kPerMegabyte = 10;
  return from_environment().time.value_or(
      std::chrono::seconds(kLeast + kPerMegabyte * (bytes >> 20)));
}

std::uint64_t data_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages[6] = {};  // size, resident, shared, text, 0, data
  for (std::uint64_t& count : pages) file >> count;
  return pages[5] * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

MemoryLimit::MemoryLimit(std::uint64_t bytes) {
  ::getrlimit(RLIMIT_DATA, &before_);
  if (kSanitizer) return;
  const rlimit limit{std::min<rlim_t>(data_bytes() + bytes, before_.rlim_cur), before_.rlim_max};
  ::setrlimit(RLIMIT_DATA, &limit);
}

MemoryLimit::~MemoryLimit() {
  ::setrlimit(RLIMIT_DATA, &before_);
}

void fail_large(const std::filesystem::path& file, std::uint64_t memory) {
  throw Error(ErrorCode::kFile,
              fmt::format("{}: takes more than {} MB to read; the file is probably damaged "
                          "(CDE_READ_MEMORY sets another limit)",
                          printable_name(file.string()), memory >> 20));
}

void fail_slow(const std::filesystem::path& file, std::chrono::seconds time) {
  throw Error(ErrorCode::kFile,
              fmt::format("{}: not read within {} s; the file is probably damaged "
                          "(CDE_READ_SECONDS sets another limit)",
                          printable_name(file.string()), time.count()));
}

}  // namespace cde
