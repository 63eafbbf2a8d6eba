// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// The word, quoted so that a POSIX shell reads it back unchanged.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace cde
