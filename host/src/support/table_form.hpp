// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace cde::text {

/// The columns that a table of numbers may have, as a text or an array. Private to the library.
struct TableForm {
  /// Adjacent columns that an array may hold as one field.
  struct Group {
    std::string name;
    std::size_t first = 0, count = 0;
  };
  std::string row = {};                 ///< the name of a row: "ray"
  std::vector<std::string> names = {};  ///< in the order of a table without a header
  std::vector<bool> optional = {};      ///< columns that a table may omit
  std::vector<std::size_t> widths =
      {};  ///< numbers of columns that an array without names may have
  std::vector<Group> groups = {};
  std::string expected = {};  ///< "expected ox, oy, ...": the names that a header may have
  std::string arrays = {};    ///< "rays are ...": the arrays that are accepted
  bool bars = false;          ///< whether a | may separate two fields
};

}  // namespace cde::text
