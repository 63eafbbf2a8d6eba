// SPDX-License-Identifier: Apache-2.0
// The selection of signals in waves, for both of Verilator's writers of FST files.
#pragma once
#include <fnmatch.h>
#include <string.h>

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// Leaves out unselected signals. A scope is written when a signal in it is. `Library` calls the
/// writer: its types File, Scope, Variable, Table, and the functions enter, leave, name_values and
/// declare. A scope that is `unnamed` has no part in names and is never written.
template <class Library>
class Selection {
 public:
  using File = typename Library::File;
  using Handle = std::uint32_t;

  explicit Selection(const char* patterns = "") {
    std::istringstream lines(patterns);
    for (std::string line; std::getline(lines, line);) {
      std::string pattern;
      for (const char c : line) {
        if (c == '[' || c == '\\')
          pattern += '\\';  // fnmatch treats more characters than * and ? as special
        pattern += c;
      }
      patterns_.push_back({pattern, "*." + pattern});
    }
  }
  void enter(const typename Library::Scope& scope) {
    const bool all = inside();
    path_.push_back({scope, false, false});
    const bool matches = !scope.unnamed && named("");
    path_.back().wanted = matches || all;
  }
  void leave(File file) {
    if (path_.back().written) Library::leave(file);
    path_.pop_back();
  }
  /// The last entered scope; null outside of all.
  [[nodiscard]] const typename Library::Scope* last() const {
    return path_.empty() ? nullptr : &path_.back().scope;
  }
  void name_values(typename Library::Table table) { table_ = table; }
  /// A signal that is left out gets a handle above all others, which the library does not write. An
  /// alias of it may still be selected.
  Handle declare(File file, const typename Library::Variable& variable, const char* name,
                 Handle alias) {
    const typename Library::Table table = std::exchange(table_, 0);
    const std::string stem(name, strcspn(name, " "));
    if (!named(stem) && !inside()) {
      if (alias != 0) return alias;
      aliases_.push_back(0);
      return kLeftOut - static_cast<Handle>(aliases_.size() - 1);
    }
    for (Entered& scope : path_) {
      if (!scope.written && !scope.scope.unnamed) Library::enter(file, scope.scope);
      scope.written = !scope.scope.unnamed;
    }
    if (table != 0) Library::name_values(file, table);
    Handle& same = is_left_out(alias) ? aliases_[kLeftOut - alias] : alias;
    const Handle handle = Library::declare(file, variable, name, same);
    if (same == 0) same = handle;
    return handle;
  }
  /// Whether the signal with this handle was left out.
  [[nodiscard]] static bool is_left_out(Handle handle) { return handle > kLeftOut / 2; }
  /// The handle to write for a signal, once all signals are declared.
  [[nodiscard]] Handle resolved(Handle handle) const {
    if (!is_left_out(handle)) return handle;
    const Handle alias = aliases_[kLeftOut - handle];
    return alias != 0 ? alias : kLeftOut;
  }
  /// The first pattern that matches nothing, or -1.
  [[nodiscard]] int without_effect() const {
    for (std::size_t i = 0; i < patterns_.size(); ++i)
      if (!patterns_[i].used) return static_cast<int>(i);
    return -1;
  }

 private:
  static constexpr Handle kLeftOut = UINT32_MAX;
  struct Pattern {
    std::string whole, inner;
    bool used = false;
  };
  struct Entered {
    typename Library::Scope scope;
    bool wanted, written;
  };
  [[nodiscard]] bool inside() const {
    return patterns_.empty() || (!path_.empty() && path_.back().wanted);
  }
  /// Whether a pattern matches the last entered scope, or a signal in it.
  bool named(const std::string& signal) {
    if (patterns_.empty()) return true;
    std::string name;
    for (const Entered& entered : path_)
      if (!entered.scope.unnamed) name += (name.empty() ? "" : ".") + entered.scope.name;
    if (!signal.empty()) name += (name.empty() ? "" : ".") + signal;
    bool any = false;
    for (Pattern& p : patterns_) {
      if (fnmatch(p.whole.c_str(), name.c_str(), 0) != 0 &&
          fnmatch(p.inner.c_str(), name.c_str(), 0) != 0)
        continue;
      any = p.used = true;
    }
    return any;
  }

  std::vector<Pattern> patterns_;
  std::vector<Entered> path_;
  std::vector<Handle> aliases_;  // for signals left out: a selected alias, or 0
  typename Library::Table table_ = 0;
};
