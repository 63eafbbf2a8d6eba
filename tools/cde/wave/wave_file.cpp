// SPDX-License-Identifier: Apache-2.0
// The reader is the one that belongs to the writer in Verilator's runtime, and is read as it is.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#define FST_CONFIG_INCLUDE "fst_config.h"
// clang-format off
// NOLINTBEGIN(bugprone-suspicious-include)
#include "gtkwave/fastlz.c"
#include "gtkwave/fstapi.c"
#include "gtkwave/lz4.c"
// NOLINTEND(bugprone-suspicious-include)
// clang-format on
#pragma GCC diagnostic pop

#include "wave/wave_file.hpp"

#include <memory>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::wave {
namespace {

using Reader = std::unique_ptr<void, decltype(&fstReaderClose)>;

Reader open(const std::filesystem::path& file) {
  Reader reader(fstReaderOpen(file.c_str()), fstReaderClose);
  if (!reader)
    throw Error(ErrorCode::kFile,
                printable_name(file.string()) + ": cannot be read as waves (FST)");
  return reader;
}

}  // namespace

std::map<std::string, unsigned> signals(const std::filesystem::path& file) {
  const Reader reader = open(file);
  std::map<std::string, unsigned> found;
  while (const fstHier* const h = fstReaderIterateHier(reader.get())) {
    if (h->htyp == FST_HT_SCOPE) fstReaderPushScope(reader.get(), h->u.scope.name, nullptr);
    if (h->htyp == FST_HT_UPSCOPE) fstReaderPopScope(reader.get());
    if (h->htyp != FST_HT_VAR) continue;
    const std::string name = h->u.var.name;
    found[std::string(fstReaderGetCurrentFlatScope(reader.get())) + "." +
          name.substr(0, name.find(' '))] = h->u.var.handle;
  }
  return found;
}

std::map<std::uint64_t, std::string> changes(const std::filesystem::path& file, unsigned handle) {
  const Reader reader = open(file);
  fstReaderSetFacProcessMask(reader.get(), handle);
  std::map<std::uint64_t, std::string> values;
  fstReaderIterBlocks(
      reader.get(),
      [](void* to, std::uint64_t time, fstHandle, const unsigned char* value) {
        (*static_cast<std::map<std::uint64_t, std::string>*>(to))[time] =
            reinterpret_cast<const char*>(value);
      },
      &values, nullptr);
  return values;
}

std::set<std::string> values(const std::filesystem::path& file, unsigned handle) {
  std::set<std::string> values;
  for (const auto& [time, value] : changes(file, handle)) values.insert(value);
  return values;
}

}  // namespace cde::wave
