// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/scene/scene.hpp"
#include "cde/support/error.hpp"

// Only toml_reader.cpp includes toml++, which is slow to compile.
namespace toml {
inline namespace v3 {
class node;
class table;
struct source_position;
}  // namespace v3
}  // namespace toml

/// Reads a TOML document key by key. Keys that no getter asked for are errors. Private to the
/// library.
namespace cde::toml_reader {

/// " (did you mean 'x'?)" with the nearest candidate by edit distance, or "; it is now 'x'" for a
/// former name. Empty if none is near.
[[nodiscard]] std::string suggestion(std::string_view word,
                                     const std::vector<std::string>& candidates);

/// The allowed range of a number.
struct Limits {
  double min = -static_cast<double>(std::numeric_limits<float>::max());
  double max = static_cast<double>(std::numeric_limits<float>::max());
  bool above = false;     ///< min itself is not allowed
  bool infinite = false;  ///< infinities are allowed
};
inline constexpr Limits kPositive{.min = 0, .above = true};
inline constexpr Limits kNotNegative{.min = 0};

class Table;
using Tables = std::vector<Table>;

/// One table of the document. Getters take a key, and their errors name file, line, column and
/// path. finish() fails for the first key that no getter asked for.
class Table {
 public:
  /// `where` describes the table in messages ("object 'ball'").
  Table(const std::string& file, const toml::table& table, std::string where)
      : file_(&file), table_(&table), where_(std::move(where)) {}

  [[nodiscard]] bool has(const char* key) const;

  // A key with a fallback may be missing; a key without one must exist.
  [[nodiscard]] std::string text(const char* key, std::optional<std::string> fallback = {});
  [[nodiscard]] bool flag(const char* key, bool fallback);
  [[nodiscard]] double number(const char* key, std::optional<double> fallback = {},
                              const Limits& limits = {});
  template <class Int>
  [[nodiscard]] Int integer(const char* key, std::optional<Int> fallback, std::int64_t min,
                            std::int64_t max) {
    const std::optional<std::int64_t> value = whole(key, fallback.has_value(), min, max);
    return value ? static_cast<Int>(*value) : *fallback;
  }
  [[nodiscard]] Eigen::Vector3d vector(const char* key,
                                       std::optional<Eigen::Vector3d> fallback = {});
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count);
  /// At least one vector.
  [[nodiscard]] std::vector<Eigen::Vector3d> vectors(const char* key);
  /// One text or an array of at least one text.
  [[nodiscard]] std::vector<std::string> texts(const char* key);
  /// Numbers, and ranges such as "3..7", ascending with gaps between; empty without the key.
  [[nodiscard]] std::vector<Range> number_ranges(const char* key, std::int64_t max);
  /// The position of the word in the list of allowed words.
  [[nodiscard]] std::size_t choice(const char* key, const std::vector<std::string>& words,
                                   std::optional<std::size_t> fallback = {});
  [[nodiscard]] std::optional<Table> table(const char* key);
  /// One table or an array of at least one; empty without the key.
  [[nodiscard]] Tables tables(const char* key);

  /// Exactly one of these keys must exist: returns its name.
  [[nodiscard]] std::string one_of(const std::vector<std::string>& keys);

  void finish() const;

  [[noreturn]] void fail(ErrorCode code, const char* key, const std::string& why) const;
  [[noreturn]] void fail(const char* key, const std::string& why) const {
    fail(ErrorCode::kBadInput, key, why);
  }
  [[noreturn]] void fail(const std::string& why) const { fail(ErrorCode::kBadInput, "", why); }
  /// The same table with another name in messages.
  [[nodiscard]] Table named(std::string where) const {
    Table t = *this;
    t.where_ = std::move(where);
    return t;
  }
  [[nodiscard]] std::string place() const;  ///< "file:line:column"
  /// Keys for the suggestion in the message about an unknown key.
  void also_known(const std::vector<std::string>& keys);

 private:
  const toml::node* find(const char* key, bool optional);
  [[nodiscard]] double number_of(const char* key, const toml::node& node,
                                 const Limits& limits) const;
  [[nodiscard]] Eigen::Vector3d vector_of(const char* key, const toml::node& node) const;
  [[nodiscard]] std::optional<std::int64_t> whole(const char* key, bool optional, std::int64_t min,
                                                  std::int64_t max);
  [[nodiscard]] std::string path(const char* key) const;
  [[noreturn]] void fail_at(ErrorCode code, const toml::source_position& at, const char* key,
                            const std::string& why) const;
  [[noreturn]] void wrong_type(const char* key, const toml::node& node, const char* wanted) const;

  const std::string* file_;
  const toml::table* table_;
  std::string where_;
  std::vector<std::string> known_;
};

/// Error kFile with the place if the text is not TOML.
[[nodiscard]] std::shared_ptr<const toml::table> parse(std::string_view text,
                                                       const std::string& file);

}  // namespace cde::toml_reader
