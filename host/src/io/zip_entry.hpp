// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde::io {

/// What a ZIP archive begins with, and no text of numbers does.
inline constexpr std::string_view kZipMark("PK\x03\x04", 4);

/// The file NAME.npy of a ZIP archive that has no other one (.npz), stored or deflated. `name` is
/// the archive's for messages, `expected` what would be read. Error kFile for anything else.
[[nodiscard]] std::string only_array(std::string_view archive, const std::string& name,
                                     const std::string& expected);

}  // namespace cde::io
