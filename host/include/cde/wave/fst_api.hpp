// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdarg>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "gtkwave/fstapi.h"

namespace cde::wave {

/// The reader of Verilator's runtime failed and cannot continue.
struct ReaderFailed : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "the reader of waves failed"; }
};

/// A part of a file as the reader sees it: bytes of an open file, or `text` if it is not empty.
struct FstPart {
  int descriptor = -1;
  std::uint64_t offset = 0, size = 0;
  std::string text = {};
};
/// Opens the reader on consecutive parts. The file must stay open while it is used. Null if the
/// reader refuses it.
[[nodiscard]] void* open_fst_reader(std::vector<FstPart> parts);

}  // namespace cde::wave
