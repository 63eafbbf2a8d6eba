// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/resource.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <new>
#include <optional>
#include <string>

namespace cde {

/// Limits for reading files of strangers, from $CDE_READ_SECONDS and $CDE_READ_MEMORY (MB). A limit
/// that is not set follows the file's size.
struct ReadLimits {
  std::optional<std::chrono::seconds> time;
  std::optional<std::uint64_t> memory;  ///< bytes

  /// Error kUsage, naming the variable, if its value is not an integer above 0.
  [[nodiscard]] static ReadLimits from_environment();
  /// Bytes for a file: $CDE_READ_MEMORY, or 2 GB plus 64 times its size.
  [[nodiscard]] static std::uint64_t memory_for(const std::filesystem::path& file);
  /// Time for a file: $CDE_READ_SECONDS, or 30 s plus 10 s per MB.
  [[nodiscard]] static std::chrono::seconds time_for(const std::filesystem::path& file);
  [[nodiscard]] static std::chrono::seconds time_for(std::uint64_t bytes);
};

/// Bytes of data that this process holds. A child starts with as many.
[[nodiscard]] std::uint64_t data_bytes();

/// While an object lives, this process can take only `bytes` more memory. Allocations beyond throw
/// std::bad_alloc. Children inherit the limit. It is not set under a sanitizer.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_{};
};

/// Error kFile: a file takes more memory than its limit.
[[noreturn]] void fail_large(const std::filesystem::path& file, std::uint64_t memory);
/// Error kFile: a file takes more time than its limit.
[[noreturn]] void fail_slow(const std::filesystem::path& file, std::chrono::seconds time);

/// Runs `read` within the memory for a file. Error kFile if it needs more.
template <typename Read>
auto within_memory_for(const std::filesystem::path& file, Read read) {
  const std::uint64_t most = ReadLimits::memory_for(file);
  const MemoryLimit limit(most);
  try {
    return read();
  } catch (const std::bad_alloc&) {
    fail_large(file, most);
  }
}

}  // namespace cde
