// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdarg>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "gtkwave/fstapi.h"

namespace cde::wave {

/// The reader of Verilator's runtime met something that it cannot go on with.
struct ReaderFailed : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "the reader of waves failed"; }
};

/// A part of a file as the reader sees it: bytes of an open file, or, where `text` is not empty,
/// these.
struct FstPart {
  int descriptor = -1;
  std::uint64_t offset = 0, size = 0;
  std::string text = {};
};
/// Opens the reader on parts that follow each other. The file must stay open as long. Null if the
/// reader refuses it.
[[nodiscard]] void* open_fst_reader(std::vector<FstPart> parts);

}  // namespace cde::wave
