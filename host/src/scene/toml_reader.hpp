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

// toml++ is included by toml_reader.cpp alone: it takes three seconds and 300 MB to compile.
namespace toml {
inline namespace v3 {
class node;
class table;
struct source_position;
}  // namespace v3
}  // namespace toml

/// A TOML document read key by key, where whatever nobody asked for is an error. Private to the
/// library.
namespace cde::toml_reader {

/// " (did you mean 'x'?)" with the candidate nearest to the word by edit distance; empty if none is
/// near.
[[nodiscard]] std::string suggestion(std::string_view word,
                                     const std::vector<std::string>& candidates);

/// Where a number must lie.
struct Limits {
  double min = -static_cast<double>(std::numeric_limits<float>::max());
  double max = static_cast<double>(std::numeric_limits<float>::max());
  bool above = false;     ///< min itself is not allowed
  bool infinite = false;  ///< infinities are
};
inline constexpr Limits kPositive{.min = 0, .above = true};
inline constexpr Limits kNotNegative{.min = 0};

class Table;
using Tables = std::vector<Table>;

/// One table of the document. Getters take a key, and fail with file, line, column and path;
/// finish() fails for the first key that no getter was asked about.
class Table {
 public:
  /// `where` says what the table is ("object 'ball'"), for messages.
  Table(const std::string& file, const toml::table& table, std::string where)
      : file_(&file), table_(&table), where_(std::move(where)) {}

  [[nodiscard]] bool has(const char* key) const;

  // With a fallback a key may be missing, without one it must be there.
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
  /// At least one of them.
  [[nodiscard]] std::vector<Eigen::Vector3d> vectors(const char* key);
  /// One text or an array of them, at least one.
  [[nodiscard]] std::vector<std::string> texts(const char* key);
  /// Numbers, and ranges as "3..7": ascending, with gaps between; empty without the key.
  [[nodiscard]] std::vector<Range> number_ranges(const char* key, std::int64_t max);
  /// Number of the word among those allowed.
  [[nodiscard]] std::size_t choice(const char* key, const std::vector<std::string>& words,
                                   std::optional<std::size_t> fallback = {});
  [[nodiscard]] std::optional<Table> table(const char* key);
  /// One table or an array of them, at least one; none without the key.
  [[nodiscard]] Tables tables(const char* key);

  /// Of several keys exactly one is there: which.
  [[nodiscard]] std::string one_of(const std::vector<std::string>& keys);

  void finish() const;

  [[noreturn]] void fail(ErrorCode code, const char* key, const std::string& why) const;
  [[noreturn]] void fail(const char* key, const std::string& why) const {
    fail(ErrorCode::kBadInput, key, why);
  }
  [[noreturn]] void fail(const std::string& why) const { fail(ErrorCode::kBadInput, "", why); }
  /// The same table under another name in messages.
  [[nodiscard]] Table named(std::string where) const {
    Table t = *this;
    t.where_ = std::move(where);
    return t;
  }
  [[nodiscard]] std::string place() const;  ///< "file:line:column"
  /// A note for the message if a key turns out to be unknown after all.
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

/// Throws kFile with the place if the text is not TOML.
[[nodiscard]] std::shared_ptr<const toml::table> parse(std::string_view text,
                                                       const std::string& file);

}  // namespace cde::toml_reader
