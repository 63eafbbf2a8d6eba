// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "cde/wave/fst_api.hpp"
#include "cde/wave/wave_source.hpp"
#include "wave/fst_source.hpp"
#include "wave/vcd_source.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {
namespace {

/// An unsupported format: its first bytes or file suffix, and the converter to VCD or FST.
struct OtherFormat {
  std::string_view magic, suffix, name, converter;
};
constexpr std::array<OtherFormat, 9> kOthers = {{
    {"GHDLwave", ".ghw", "GHW of GHDL",
     "let GHDL write `--fst=FILE` or `--vcd=FILE`; `ghwdump -s FILE` prints it"},
    {"FSDB", ".fsdb", "FSDB of Verdi", "`fsdb2vcd FILE -o OTHER.vcd` makes a VCD file of it"},
    {"\x13\x80", ".lxt2", "LXT2 of GTKWave", "`lxt2vcd FILE -o OTHER.vcd` makes a VCD file of it"},
    {{"\x01\x38", 2},
     ".lxt",
     "LXT of GTKWave",
     "`lxt2vcd FILE -o OTHER.vcd` makes a VCD file of it"},
    {"VZT", ".vzt", "VZT of GTKWave", "`vzt2vcd FILE -o OTHER.vcd` makes a VCD file of it"},
    {"", ".wlf", "WLF of ModelSim and Questa",
     "`wlf2vcd FILE -o OTHER.vcd` makes a VCD file of it"},
    {"", ".vpd", "VPD of VCS", "`vpd2vcd FILE OTHER.vcd` makes a VCD file of it"},
    {"", ".wdb", "WDB of Vivado", "let it write VCD: `open_vcd`, `log_vcd`"},
    {"", ".shm", "SHM of Xcelium",
     "`simvisdbutil FILE -vcd -output OTHER.vcd` makes a VCD file of it"},
}};

std::string lower_suffix(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  for (char& c : suffix) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return suffix;
}

/// Whether the file may be VCD: blanks, perhaps a byte order mark, and a word with $.
bool begins_as_vcd(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  const std::size_t at = head.find_first_not_of(" \t\r\n\f\v");
  return at != std::string_view::npos && head[at] == '$';
}

}  // namespace

std::unique_ptr<WaveSource> open_source(const std::filesystem::path& path) {
  WaveBytes file(path);
  const std::string suffix = lower_suffix(path);
  if (file.size() == 0)
    file.fail(suffix == ".fst"
                  ? "is empty: the simulation still runs, or was killed before its writer had a "
                    "block full. `flush()` of VerilatedFstC, or $dumpflush, ends a block"
                  : "is empty; it must be an FST or VCD file");
  std::string head(4096, '\0');
  head.resize(file.read(0, head.data(), head.size()));
  const int first = static_cast<unsigned char>(head[0]);
  if (first == FST_BL_HDR || first == FST_BL_ZWRAPPER)
    return std::make_unique<FstSource>(std::move(file), path);
  for (const OtherFormat& other : kOthers)
    if ((!other.magic.empty() && head.starts_with(other.magic)) ||
        (suffix == other.suffix && !begins_as_vcd(head)))
      file.fail(fmt::format("is {}, which cde cannot read; {}", other.name, other.converter));
  if (head.starts_with("\x1f\x8b"))
    file.fail("is packed by gzip; `gzip -dc FILE | cde wave COMMAND -` reads it");
  if (begins_as_vcd(head)) return std::make_unique<VcdSource>(std::move(file));
  file.fail(
      "is neither an FST file, which begins with its header, nor a VCD file, which begins with $");
}

}  // namespace cde::wave
