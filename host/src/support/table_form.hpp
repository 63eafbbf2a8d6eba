// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace cde::text {

/// The columns that a table of numbers may have, whether it is a text or an array. Private to the
/// library.
struct TableForm {
  /// Columns that stand side by side and that an array may hold as one field.
  struct Group {
    std::string name;
    std::size_t first = 0, count = 0;
  };
  std::string row = {};                 ///< what a row is: "ray"
  std::vector<std::string> names = {};  ///< in the order of a table without a header
  std::vector<bool> optional = {};      ///< columns that a table may leave out
  std::vector<std::size_t> widths =
      {};  ///< numbers of columns that an array without names may have
  std::vector<Group> groups = {};
  std::string expected = {};  ///< "expected ox, oy, ...": which names a header may have
  std::string arrays = {};    ///< "rays are ...": what an array may be
  bool bars = false;          ///< a | may stand between two fields
};

}  // namespace cde::text
