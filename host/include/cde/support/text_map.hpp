// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>

/// @file
/// Tables by texts that come from files, perhaps of strangers.
namespace cde {

/// A hash with a random key per process, so that no file can make many texts collide.
struct TextHash {
  using is_transparent = void;
  [[nodiscard]] std::size_t operator()(std::string_view text) const noexcept;
};

template <typename Value>
using TextMap = std::unordered_map<std::string, Value, TextHash, std::equal_to<>>;
/// The keys must outlive the table.
template <typename Value>
using TextViewMap = std::unordered_map<std::string_view, Value, TextHash>;

}  // namespace cde
