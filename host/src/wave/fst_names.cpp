// SPDX-License-Identifier: Apache-2.0
#include "wave/fst_names.hpp"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

struct NamesEnd {};  ///< the last entry is truncated

/// Reads the consecutive entries of the names.
class NameBytes {
 public:
  explicit NameBytes(std::string_view text) : text_(text) {}
  [[nodiscard]] bool more() const { return at_ < text_.size(); }
  [[nodiscard]] std::size_t at() const { return at_; }
  int byte() {
    if (!more()) throw NamesEnd();
    return static_cast<unsigned char>(text_[at_++]);
  }
  std::string_view name() {
    const std::size_t end = text_.find('\0', at_);
    if (end == std::string_view::npos) throw NamesEnd();
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end + 1;
    return found;
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto b = static_cast<std::uint64_t>(byte());
      value |= (b & 0x7f) << shift;
      if ((b & 0x80) == 0) return value;
    }
    throw NamesEnd();
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

bool is_real(int type) {
  return type == FST_VT_VCD_REAL || type == FST_VT_VCD_REAL_PARAMETER ||
         type == FST_VT_VCD_REALTIME || type == FST_VT_SV_SHORTREAL;
}

/// One variable as written in the file.
struct RawVariable {
  int type = 0, direction = 0;
  std::string_view name;
  std::uint64_t length = 0, alias = 0;
};

RawVariable raw_variable(NameBytes& in, int type) {
  RawVariable v;
  v.type = type;
  v.direction = in.byte();
  v.name = in.name();
  v.length = in.number();
  v.alias = in.number();
  return v;
}

/// Bits of a value. A port's length counts a state and two strengths per bit, and two blanks.
std::uint32_t width_of(const RawVariable& v) {
  if (is_real(v.type)) return 64;
  if (v.type == FST_VT_GEN_STRING) return 0;
  if (v.type == FST_VT_VCD_PORT && v.length >= 5 && (v.length - 2) % 3 == 0)
    return static_cast<std::uint32_t>((v.length - 2) / 3);
  return static_cast<std::uint32_t>(v.length);
}

}  // namespace

void FstNames::read(std::string_view text, const SourceVisit& visit) const {
  NameBytes in(text);
  std::uint32_t handles = 0;
  std::size_t begin = 0, open = 0;
  const auto fail = [&](const std::string& what) {
    file.fail(fmt::format("is corrupt: byte {} of {} {}", begin, from, what));
  };
  try {
    while (in.more()) {
      begin = in.at();
      const int tag = in.byte();
      if (tag == FST_ST_VCD_SCOPE) {
        ScopeName s;
        s.type = in.byte();
        s.name = utf8_text(std::string(in.name()));
        s.component = utf8_text(std::string(in.name()));
        ++open;
        if (visit.open) visit.open(std::move(s));
      } else if (tag == FST_ST_VCD_UPSCOPE) {
        if (open-- == 0) fail("ends a scope that did not begin");
        if (visit.close) visit.close();
      } else if (tag == FST_ST_GEN_ATTRBEGIN) {
        Attribute a;
        a.type = in.byte();
        a.subtype = in.byte();
        const std::string_view name = in.name();
        a.argument = in.number();
        // The number of a source file's name is not text.
        const bool number = a.subtype == FST_MT_SOURCESTEM || a.subtype == FST_MT_SOURCEISTEM;
        a.name = number ? std::string(name) : utf8_text(std::string(name));
        if (visit.attribute) visit.attribute(std::move(a));
      } else if (tag == FST_ST_GEN_ATTREND) {
        continue;
      } else if (tag <= FST_VT_MAX) {
        const RawVariable v = raw_variable(in, tag);
        const std::uint64_t handle = v.alias != 0 ? v.alias : handles + std::uint64_t{1};
        if (handle > most || v.length > UINT32_MAX || v.direction > FST_VD_MAX)
          fail(fmt::format("has an impossible signal: handle {} of {}, {} bits, direction {}",
                           handle, most, v.length, v.direction));
        if (v.alias == 0) ++handles;
        if (visit.variable)
          visit.variable({tag, v.direction, utf8_text(std::string(v.name)), width_of(v),
                          static_cast<std::uint32_t>(handle)});
      } else {
        fail(fmt::format("is {}, which does not begin a name", tag));
      }
    }
  } catch (const NamesEnd&) {
    if (!cut) fail("begins a name that is cut off");
  }
}

FstWidths FstNames::widths(std::string_view text) const {
  FstWidths all;
  NameBytes in(text);
  try {
    while (in.more()) {
      const int tag = in.byte();
      if (tag == FST_ST_VCD_SCOPE) {
        (void)in.byte();
        (void)in.name();
        (void)in.name();
      } else if (tag == FST_ST_GEN_ATTRBEGIN) {
        (void)in.byte();
        (void)in.byte();
        (void)in.name();
        (void)in.number();
      } else if (tag <= FST_VT_MAX) {
        const RawVariable v = raw_variable(in, tag);
        if (v.alias != 0) continue;
        all.real.push_back(is_real(tag));
        all.bytes.push_back(is_real(tag) ? 8
                            : tag == FST_VT_GEN_STRING || v.length > UINT32_MAX
                                ? 0
                                : static_cast<std::uint32_t>(v.length));
      } else if (tag != FST_ST_VCD_UPSCOPE && tag != FST_ST_GEN_ATTREND) {
        break;
      }
    }
  } catch (const NamesEnd&) {
    // read() reports the error
  }
  return all;
}

}  // namespace cde::wave
