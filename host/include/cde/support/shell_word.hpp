// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// The word in the quotes that a POSIX shell needs to read it back.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace cde
