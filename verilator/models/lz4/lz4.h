// SPDX-License-Identifier: Apache-2.0
// The two functions of LZ4 that Verilator's FST library needs, so that waves need no package. They
// write the LZ4 block format.
#pragma once
#include <cstdint>
#include <cstring>
#include <vector>

namespace lz4 {

/// Writes a length beyond what fits in a token.
inline char* put_length(char* to, int length) {
  for (; length >= 255; length -= 255) *to++ = static_cast<char>(255);
  *to++ = static_cast<char>(length);
  return to;
}

/// Writes `literals` bytes from `from`, then a copy of `match` bytes (0: none) from `offset`
/// before.
inline char* put_sequence(char* to, const char* from, int literals, int match, int offset) {
  char* const token = to++;
  const int copied = match == 0 ? 0 : match - 4;
  *token = static_cast<char>((literals < 15 ? literals : 15) << 4 | (copied < 15 ? copied : 15));
  if (literals >= 15) to = put_length(to, literals - 15);
  std::memcpy(to, from, static_cast<std::size_t>(literals));
  to += literals;
  if (match == 0) return to;
  *to++ = static_cast<char>(offset & 255);
  *to++ = static_cast<char>(offset >> 8);
  return copied >= 15 ? put_length(to, copied - 15) : to;
}

inline std::uint32_t word_at(const char* p) {
  std::uint32_t word;
  std::memcpy(&word, p, sizeof word);
  return word;
}

}  // namespace lz4

/// Most bytes that LZ4_compress_default writes for `size` bytes.
inline int LZ4_compressBound(int size) {
  return size + size / 255 + 16;
}

/// Packs all of `size` bytes and returns their packed number. `to` has LZ4_compressBound(size)
/// bytes.
inline int LZ4_compress_default(const char* from, char* to, int size, int /*most*/) {
  constexpr int kHashBits = 14, kFarthest = 65535;
  constexpr int kLastLiterals = 5, kLastMatch = 12;        // of the format: distances from the end
  std::vector<int> last(std::size_t{1} << kHashBits, -1);  // by hash: where such a word began
  char* const begin = to;
  int written = 0, at = 0;
  while (at <= size - kLastMatch) {
    const std::uint32_t word = lz4::word_at(from + at);
    int& slot = last[word * 2654435761u >> (32 - kHashBits)];
    const int before = slot;
    slot = at;
    if (before < 0 || at - before > kFarthest || lz4::word_at(from + before) != word) {
      ++at;
      continue;
    }
    int match = 4;
    while (at + match < size - kLastLiterals && from[before + match] == from[at + match]) ++match;
    to = lz4::put_sequence(to, from + written, at - written, match, at - before);
    at += match;
    written = at;
  }
  to = lz4::put_sequence(to, from + written, size - written, 0, 0);
  return static_cast<int>(to - begin);
}
