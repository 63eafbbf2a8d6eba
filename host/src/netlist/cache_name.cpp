// SPDX-License-Identifier: Apache-2.0
#include "cde/netlist/cache_name.hpp"

#include <fstream>
#include <iterator>

#include "cde/model/cache_entry.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"

namespace cde::netlist {

std::optional<std::string> cache_name(const std::string& kind,
                                      const std::vector<std::string>& parameters,
                                      std::string_view suffix) {
  try {
    const ModelFile rtl = model_file(kind, parameters);
    std::ifstream program("/proc/self/exe", std::ios::binary);
    const std::string code(std::istreambuf_iterator<char>(program), {});
    if (code.empty()) return std::nullopt;
    return cache_key({rtl.path.stem().string(), code}).append(suffix);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace cde::netlist
