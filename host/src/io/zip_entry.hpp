// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde::io {

/// The first bytes of a ZIP archive. No text of numbers begins with them.
inline constexpr std::string_view kZipMark("PK\x03\x04", 4);

/// The only file NAME.npy of a ZIP archive (.npz), stored or deflated. `name` is the archive's name
/// and `expected` the accepted content, both for messages. Error kFile for any other archive.
[[nodiscard]] std::string only_array(std::string_view archive, const std::string& name,
                                     const std::string& expected);

}  // namespace cde::io
