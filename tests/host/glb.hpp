// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

/// Bytes of binary glTF files.
namespace cde::testing {

inline std::string word(std::uint32_t value) {
  return {reinterpret_cast<const char*>(&value), 4};
}
inline std::string half(std::uint16_t value) {
  return {reinterpret_cast<const char*>(&value), 2};
}

inline std::string chunks_of_glb(const std::string& json, const std::string& data) {
  const auto size = [](const std::string& of) { return static_cast<std::uint32_t>(of.size()); };
  return "glTF" + word(2) + word(28 + size(json) + size(data)) + word(size(json)) + "JSON" + json +
         word(size(data)) + std::string("BIN\0", 4) + data;
}

}  // namespace cde::testing
