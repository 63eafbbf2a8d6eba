// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace cde::wave {

/// The bytes of a wave file, by descriptor. The file is a regular file, or a nameless temporary one
/// for data from a pipe or a compressed file.
class WaveBytes {
 public:
  /// Reads "-" and pipes to their end first. Error kFile.
  explicit WaveBytes(const std::filesystem::path& file);
  ~WaveBytes();
  WaveBytes(WaveBytes&& other) noexcept;
  WaveBytes& operator=(WaveBytes&& other) noexcept;
  WaveBytes(const WaveBytes&) = delete;
  WaveBytes& operator=(const WaveBytes&) = delete;

  /// Unpacks a gzip stream at `offset`, which announces `size` bytes.
  [[nodiscard]] WaveBytes inflated(std::uint64_t offset, std::uint64_t size) const;

  [[nodiscard]] const std::string& name() const { return name_; }  ///< printable
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Returns the number of bytes read: fewer at the end of the file.
  std::size_t read(std::uint64_t offset, char* to, std::size_t count) const;
  /// Error kFile "NAME: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  WaveBytes() = default;
  void spool(int from);
  void append(const char* bytes, std::size_t count);

  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Bits that all signals of a file may have together, besides those that its size allows. Readers
/// hold values of all signals, each bit in a byte.
constexpr std::uint64_t kBitsOfSmallFiles = std::uint64_t{1} << 24;

/// Text that is not UTF-8 is read as Latin-1.
[[nodiscard]] std::string utf8_text(std::string text);

}  // namespace cde::wave
