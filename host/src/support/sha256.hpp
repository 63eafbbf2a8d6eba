// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace cde {

/// SHA-256 (FIPS 180-4) of bytes, as 64 hexadecimal digits. Private to the library.
[[nodiscard]] std::string sha256(std::string_view bytes);

/// SHA-256 of a file; nothing if it cannot be read.
[[nodiscard]] std::optional<std::string> sha256_of_file(const std::filesystem::path& file);

}  // namespace cde
