// SPDX-License-Identifier: Apache-2.0
#include "wave/fst_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"
#include "wave/fst_names.hpp"
#include "wave/port_states.hpp"

namespace cde::wave {
namespace {

/// Bytes of names in a file beside the waves, and 64 more for each byte of waves.
constexpr std::uint64_t kMostNamesBeside = std::uint64_t{256} << 20;

void put_word(std::string& header, std::size_t at, std::uint64_t word) {
  for (unsigned i = 0; i < 8; ++i) header[at + i] = static_cast<char>(word >> (8 * (7 - i)));
}

/// A text of the header, up to its first NUL.
std::string header_text(const std::string& header, std::size_t at, std::size_t length) {
  std::string text = header.substr(at, length);
  text.resize(std::min(text.find('\0'), text.size()));
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return utf8_text(std::move(text));
}

/// Whether a value has an X or Z. It has no branches, because it runs for every change.
bool has_upper(std::string_view value) {
  unsigned any = 0;
  for (const char c : value)
    any |= static_cast<unsigned>(c == 'X') | static_cast<unsigned>(c == 'Z');
  return any != 0;
}

struct FstStop {};  ///< thrown to stop Verilator's reader

/// Receives changes from Verilator's reader.
struct FstReceiver {
  const WaveSource::Change& visit;
  const FstWidths& widths;
  const std::vector<std::uint32_t>& port;
  std::vector<bool>& frame;
  FstEventDumps* dumps;  ///< null while they are not known
  std::string own;

  void bits(std::uint64_t time, std::uint32_t handle, const char* value) {
    const std::size_t i = handle - 1;
    if (frame[i]) {  // the initial value of an event does not trigger it
      frame[i] = false;
      return;
    }
    if (dumps != nullptr && dumps->skips(time, handle)) return;
    if (widths.real[i]) {
      double number = 0;
      std::memcpy(&number, value, sizeof number);
      own = fmt::format("{}", number);
      if (!visit(time, handle, own)) throw FstStop();
      return;
    }
    std::string_view now(value, widths.bytes[i]);
    if (port[i] != 0) {
      port_bits(now, port[i], own);
      now = own;
    } else if (has_upper(now)) {
      own = now;
      for (char& c : own)
        if (c == 'X' || c == 'Z') c = static_cast<char>(c - 'X' + 'x');
      now = own;
    }
    if (!visit(time, handle, now)) throw FstStop();
  }
};

void take_bits(void* to, std::uint64_t time, fstHandle handle, const unsigned char* value) {
  static_cast<FstReceiver*>(to)->bits(time, handle, reinterpret_cast<const char*>(value));
}
void take_text(void* to, std::uint64_t time, fstHandle handle, const unsigned char* value,
               std::uint32_t length) {
  if (!static_cast<FstReceiver*>(to)->visit(time, handle,
                                            {reinterpret_cast<const char*>(value), length}))
    throw FstStop();
}

}  // namespace

FstSource::FstSource(WaveBytes file, const std::filesystem::path& path)
    : file_(std::move(file)), reader_(nullptr, fstReaderClose) {
  const std::uint64_t size = file_.size();
  unpack();
  blocks_ = find_fst_blocks(file_);
  if (blocks_.changes().empty())
    file_.fail(blocks_.closed
                   ? "is cut off or corrupt: it has no changes"
                   : "has no changes, or was not closed by its writer: the simulation still runs, "
                     "or was killed, and no block of changes is whole. Writers keep changes in "
                     "memory until a block is full; `flush()` of VerilatedFstC, or $dumpflush, "
                     "ends a block");
  find_names(path);
  check_blocks();
  blocks_.structure.bytes = size;
  note_facts();
  open_reader();
}

void FstSource::corrupt() const {
  file_.fail("is corrupt: Verilator's FST reader cannot read it");
}

/// Unpacks a file that is compressed with gzip as a whole, as GHDL and NVC write it.
void FstSource::unpack() {
  std::string head(17, '\0');
  head.resize(file_.read(0, head.data(), head.size()));
  if (head.empty() || static_cast<unsigned char>(head[0]) != FST_BL_ZWRAPPER) return;
  if (head.size() < 17) file_.fail("is cut off: its header has no end");
  const auto word = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 8; ++i)
      value = value << 8 | static_cast<unsigned char>(head[at + i]);
    return value;
  };
  const std::uint64_t length = word(1), size = word(9);
  if (length == 0)
    file_.fail(
        "was not closed by its writer: it is compressed with gzip, and the gzip stream has no end");
  if (length < 16 || length > file_.size() - 1)
    file_.fail(fmt::format("is cut off or corrupt: it has {} bytes and announces {}", file_.size(),
                           length));
  // zlib expands at most 1032 times.
  if (size > 1100 * length) file_.fail("is corrupt: it announces more bytes than it can hold");
  file_ = file_.inflated(17, size);
  packed_ = true;
}

void FstSource::find_names(const std::filesystem::path& path) {
  const FstBlock* const own = blocks_.find(FST_BL_HIER, FST_BL_HIER_LZ4, FST_BL_HIER_LZ4DUO);
  if (blocks_.closed) {
    if (own == nullptr) file_.fail("is cut off or corrupt: it has no names");
    widths_ = read_fst_widths(file_, blocks_);
    return;
  }
  if (own == nullptr) {
    const std::filesystem::path beside = path.string() + ".hier";
    std::error_code none;
    if (path == "-" || !std::filesystem::exists(beside, none)) {
      const std::size_t count = blocks_.changes().size();
      const std::string name = path == "-" ? "FILE.hier" : printable_name(beside.string());
      file_.fail(fmt::format(
          "was not closed by its writer: the simulation still runs, or was killed. {} of changes "
          "can be read, but the names of the signals are missing. {}Let the same model trace a few "
          "cycles into another FST, close that, and copy it to {}",
          count == 1 ? "One block" : fmt::format("{} blocks", count),
          blocks_.headless
              ? "Verilator since 5.050 writes names only when it closes the file. "
              : fmt::format("Most writers keep them in {} until the end. Without that file: ",
                            name),
          name));
    }
    names_beside(beside);
  } else {
    names_ = read_fst_names(file_, *own);
    names_file_ = "its names";
  }
  widths_ = FstNames{file_, names_file_, UINT32_MAX, true}.widths(names_);
  if (widths_.bytes.empty())
    file_.fail(fmt::format("was not closed, and {} has no signals", names_file_));
}

/// Reads the names that GTKWave's writer keeps while it writes, or the names of a closed FST of the
/// same model.
void FstSource::names_beside(const std::filesystem::path& beside) {
  const WaveBytes names(beside);
  names_file_ = printable_name(beside.string());
  if (has_fst_header(names)) {
    const FstBlocks other = find_fst_blocks(names);
    const FstBlock* const own = other.find(FST_BL_HIER, FST_BL_HIER_LZ4, FST_BL_HIER_LZ4DUO);
    if (!other.closed || own == nullptr) names.fail("was not closed, and has no names either");
    names_ = read_fst_names(names, *own);
    if (blocks_.headless) blocks_.header = other.header;
    for (const std::size_t word : {9u, 17u}) put_word(blocks_.header, word, 0);
    return;
  }
  const std::uint64_t most = kMostNamesBeside + 64 * file_.size();
  if (names.size() > most)
    names.fail(fmt::format("has {} bytes; at most {} may be names of a wave file of {} bytes",
                           names.size(), most, file_.size()));
  names_.resize(names.size());
  names_.resize(names.read(0, names_.data(), names_.size()));
}

void FstSource::check_blocks() {
  try {
    check_fst_blocks(file_, blocks_, widths_.bytes);
  } catch (const Error& e) {
    if (names_.empty() || blocks_.find(FST_BL_HIER, FST_BL_HIER_LZ4, FST_BL_HIER_LZ4DUO) != nullptr)
      throw;
    throw Error(ErrorCode::kFile, fmt::format("{}; {} must have the names of the same model and "
                                              "trace options",
                                              e.what(), names_file_));
  }
}

void FstSource::note_facts() {
  const std::string& h = blocks_.header;
  const bool has_scale = blocks_.word(1) != 0;
  facts_.format = packed_ ? "FST, packed in gzip" : "FST";
  facts_.scale = static_cast<signed char>(h[73]);
  facts_.writer = header_text(h, 74, 128);
  facts_.date = header_text(h, 202, 119);
  facts_.time_zero = static_cast<std::int64_t>(blocks_.word(322));
  facts_.handles = static_cast<std::uint32_t>(widths_.bytes.size());
  facts_.structure = blocks_.structure;
  facts_.blackouts = blocks_.blackouts;
  facts_.start = blocks_.word(9);
  facts_.end = blocks_.word(17);
  const auto& sections = facts_.structure.sections;
  if (!blocks_.closed) {
    facts_.start = sections.front().begin;
    facts_.end = sections.front().end;
    for (const Section& s : sections) facts_.end = std::max(facts_.end, s.end);
    facts_.ending = fmt::format(
        "not closed by its writer; {} complete blocks of changes are read, and later changes are "
        "not in the file{}{}",
        sections.size(), names_file_.empty() ? "" : ", names are of " + names_file_,
        has_scale ? "" : "; its header was not written, so the unit of time is not known");
  }
}

void FstSource::open_reader() {
  std::string header = blocks_.header;
  const std::uint64_t handles = widths_.bytes.size();
  if (blocks_.word(1) == 0) {
    put_word(header, 1, kFstHeaderBytes - 1);
    std::memcpy(header.data() + 25, &kFstByteOrder, sizeof kFstByteOrder);
  }
  // The reader takes a file from 0 to 0 for one that was not closed.
  put_word(header, 9, facts_.start);
  put_word(header, 17, std::max<std::uint64_t>(facts_.end, 1));
  put_word(header, 49, std::max(blocks_.word(49), handles));
  put_word(header, 57, handles);
  put_word(header, 65, facts_.structure.sections.size());
  std::vector<FstPart> parts;
  parts.push_back({-1, 0, 0, header});
  const std::uint64_t rest = blocks_.whole - kFstHeaderBytes;
  parts.push_back({file_.descriptor(), kFstHeaderBytes, rest, {}});
  if (blocks_.find(FST_BL_GEOM) == nullptr) parts.push_back({-1, 0, 0, fst_widths_block(widths_)});
  if (blocks_.find(FST_BL_HIER, FST_BL_HIER_LZ4, FST_BL_HIER_LZ4DUO) == nullptr) {
    // The reader refuses a file without names, although it is not asked for names.
    std::string none(1, static_cast<char>(FST_BL_HIER));
    none.resize(17, '\0');
    none[8] = 16;
    parts.push_back({-1, 0, 0, none});
  }
  try {
    reader_.reset(open_fst_reader(std::move(parts)));
  } catch (const ReaderFailed&) {
    corrupt();
  }
  if (!reader_) corrupt();
  fstReaderIterBlocksSetNativeDoublesOnCallback(reader_.get(), 1);
}

void FstSource::names(const SourceVisit& visit) {
  const FstNames all{file_, names_file_.empty() ? "its names" : names_file_, facts_.handles,
                     !blocks_.closed};
  SourceVisit mine = visit;
  port_.assign(widths_.bytes.size(), 0);
  event_.assign(widths_.bytes.size(), false);
  mine.variable = [&](VariableName&& v) {
    const std::size_t i = v.handle - 1;
    if (v.type == FST_VT_VCD_PORT && widths_.bytes[i] == 3 * std::uint64_t{v.width} + 2)
      port_[i] = v.width;
    if (v.type == FST_VT_VCD_EVENT) event_[i] = true;
    if (visit.variable) visit.variable(std::move(v));
  };
  if (!names_file_.empty()) return all.read(names_, mine);
  all.read(read_fst_names(file_, *blocks_.find(FST_BL_HIER, FST_BL_HIER_LZ4, FST_BL_HIER_LZ4DUO)),
           mine);
}

bool FstSource::has_event(std::span<const std::uint32_t> handles) const {
  return std::any_of(handles.begin(), handles.end(),
                     [&](std::uint32_t h) { return event_[h - 1]; });
}

/// The reader reports initial values for the first block that it does not skip. It leaves them out
/// for the first block of the file if that block starts at its first time.
void FstSource::find_frame(std::uint64_t from, std::span<const std::uint32_t> handles) {
  frame_.assign(widths_.bytes.size(), false);
  const auto& sections = facts_.structure.sections;
  const auto read = std::find_if(sections.begin(), sections.end(),
                                 [&](const Section& s) { return s.end >= from; });
  if (read == sections.end()) return;
  if (!has_event(handles)) return;
  bool told = read != sections.begin();
  if (!told) told = first_fst_time(file_, blocks_.changes().front()) != read->begin;
  for (const std::uint32_t h : handles)
    frame_[h - 1] = told && event_[h - 1] && widths_.bytes[h - 1] != 0;
}

/// Finds the instants at which the writer dumped all values: the first time and each $dumpon, if
/// every event has a mark there. These marks trigger nothing. `cde wave export` and Verilator mark
/// triggered events alone.
void FstSource::find_event_dumps() {
  FstEventDumps dumps(event_);
  std::vector<std::uint32_t> events;
  for (std::uint32_t h = 1; h <= event_.size(); ++h)
    if (event_[h - 1]) events.push_back(h);
  std::vector<std::uint64_t> candidates{facts_.start};
  for (const Blackout& off : facts_.blackouts) candidates.push_back(off.to);
  const std::string& writer = facts_.writer;
  if (writer.starts_with("cde ") || writer.starts_with("Generated by Verilated"))
    candidates.clear();
  for (const std::uint64_t time : candidates) {
    std::vector<bool> marked(event_.size(), false);
    read_changes(events, time, time, [&](std::uint64_t t, std::uint32_t h, auto value) {
      if (t == time && value != "0") marked[h - 1] = true;
      return true;
    });
    if (marked == event_) dumps.add(time);
  }
  event_dumps_ = std::move(dumps);
}

void FstSource::changes(std::span<const std::uint32_t> handles, std::uint64_t from,
                        std::uint64_t to, const Change& visit) {
  if (port_.empty()) names({});
  if (!event_dumps_ && has_event(handles)) find_event_dumps();
  read_changes(handles, from, to, visit);
}

void FstSource::read_changes(std::span<const std::uint32_t> handles, std::uint64_t from,
                             std::uint64_t to, const Change& visit) {
  fstReaderClrFacProcessMaskAll(reader_.get());
  for (const std::uint32_t handle : handles) fstReaderSetFacProcessMask(reader_.get(), handle);
  // The reader starts with the values at the begin of the first block that it does not skip. If
  // `from` lies between two blocks, the block before `from` has these values.
  std::uint64_t first = from;
  for (const Section& s : facts_.structure.sections)
    if (s.begin <= from) first = std::min(from, s.end);
  fstReaderSetLimitTimeRange(reader_.get(), first, to);
  find_frame(first, handles);
  if (event_dumps_) event_dumps_->restart();
  FstReceiver receiver{visit, widths_, port_, frame_, event_dumps_ ? &*event_dumps_ : nullptr, {}};
  try {
    fstReaderIterBlocks2(reader_.get(), take_bits, take_text, &receiver, nullptr);
  } catch (const FstStop&) {
    // the visitor has enough
  } catch (const ReaderFailed&) {
    corrupt();
  }
}

}  // namespace cde::wave
