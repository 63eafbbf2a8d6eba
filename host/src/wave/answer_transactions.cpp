// SPDX-License-Identifier: Apache-2.0
// Decodes the engine's answers: rows of pair tests, and records.
#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "cde/wave/engine_decoder.hpp"

namespace cde::wave {
namespace {

/// Decodes tests. Rows leave a pair's pipe in the order in which they enter it.
class TestDecoder : public EngineDecoder {
 public:
  TestDecoder(const SignalPlace& place, Take take)
      : EngineDecoder(place, std::move(take)),
        retire_(wire("control.retire_i")),
        flush_(wire("control.flush_o")),
        issue_(wire("control.issue_o.valid")),
        stall_(wire("control.stall_o")),
        index_(wire("engine.index_i")),
        row_(array("control.issue_o.row[#]")),
        row_out_(array("engine.row_out[#]")),
        index_out_(array("engine.index[#]")) {
    const std::string lanes = "engine.group[#].lanes.port[#].results.";
    ports_.resize(std::min(row_.size(), row_out_.size()));
    for (const auto& [name, lane] : {std::pair{"f[#]", &Port::f},
                                     {"update.mask[#]", &Port::mask},
                                     {"update.better[#]", &Port::better}}) {
      const auto& pattern =
          *std::find(place.of->arrays.begin(), place.of->arrays.end(), lanes + name);
      const std::vector<const Wire*> wires = array(pattern);
      const auto& elements = place.arrays.at(pattern);
      for (std::size_t i = 0; i < wires.size(); ++i)
        if (elements[i].indices[1] < ports_.size())
          (ports_[elements[i].indices[1]].*lane).push_back(wires[i]);
    }
  }

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    std::optional<std::uint64_t> first;
    for (const Port& p : ports_)
      if (!p.issued.empty())
        first = std::min(first.value_or(UINT64_MAX), p.issued.front().open.t.begin);
    return first;
  }
  void finish(std::uint64_t time) override {
    for (Port& p : ports_) {
      for (Issued& i : p.issued) leave_open(i.open, time);
      p.issued.clear();
    }
  }

 protected:
  void at_edge(unsigned) override {
    (void)count_pass();
    for (unsigned k = 0; k < ports_.size(); ++k)
      if (retire_.bit(k)) answer(k);
    if (stall_.on()) ++stalls_;
    for (unsigned k = 0; k < ports_.size(); ++k)
      if (issue_.bit(k)) issue(k);
  }

 private:
  struct Issued {
    Open open;
    std::uint64_t row = 0, index = 0;
  };
  struct Port {
    std::vector<const Wire*> f, mask, better;  ///< one per lane
    std::deque<Issued> issued;
  };

  /// Numbers of primaries; the first 16 as text.
  struct List {
    std::uint64_t count = 0;
    std::string text;
    void add(std::uint64_t primary) {
      ++count;
      if (count <= 16) text += fmt::format("{}{}", count == 1 ? "" : " ", primary);
      if (count == 17) text += " ...";
    }
  };

  void issue(unsigned k) {
    Issued& i = ports_[k].issued.emplace_back();
    i.open = begin();
    i.row = row_[k]->number().value_or(0);
    i.index = index_.number().value_or(0);
    i.open.t.stalls = stalls_;
    i.open.t.label = fmt::format("row {} and secondary {}", i.row, i.index);
    stalls_ = 0;
    field(i.open.t, "pass", pass());
    field(i.open.t, "port", k);
    field(i.open.t, "row", i.row);
    field(i.open.t, "index", i.index);
  }
  void answer(unsigned k) {
    Port& p = ports_[k];
    // A row issued before the file begins is not the oldest known row.
    if (p.issued.empty() || p.issued.front().row != row_out_[k]->number() ||
        p.issued.front().index != index_out_[k]->number())
      return;
    Issued i = std::move(p.issued.front());
    p.issued.pop_front();
    Transaction& t = i.open.t;
    std::uint64_t tests = 0;
    List hit, kept;
    for (std::size_t l = 0; l < p.f.size(); ++l) {
      const bool on = l < p.mask.size() && p.mask[l]->on();
      const std::uint64_t primary = i.row * p.f.size() + l;
      tests += on ? 1 : 0;
      if (l < p.better.size() && p.better[l]->on()) kept.add(primary);
      if (on && p.f[l]->on()) hit.add(primary);
    }
    const std::uint64_t hits = hit.count;
    const std::string& who = hit.text;
    field(t, "tests", tests);
    field(t, "hits", hits);
    field(t, "kept", kept.count);
    if (hits != 0) field(t, "hit_primaries", who);
    if (kept.count != 0) field(t, "kept_primaries", kept.text);
    t.label += fmt::format(": {} of {} hit{}{}", hits, tests, hits == 0 ? "" : ", primaries ", who);
    end(i.open, flush_.on() ? "dropped" : hits != 0 ? "hit" : "miss");
  }

  const Wire &retire_, &flush_, &issue_, &stall_, &index_;
  std::vector<const Wire*> row_, row_out_, index_out_;
  std::vector<Port> ports_;
  std::uint64_t stalls_ = 0;
};

class RecordDecoder : public EngineDecoder {
 public:
  RecordDecoder(const SignalPlace& place, Take take)
      : EngineDecoder(place, std::move(take)),
        record_valid_(wire("records.record_valid")),
        sram_ready_(wire("records.sram_ready")),
        write_(wire("records.write_o")),
        exp_(wire("registers.caps.exp")),
        man_(wire("registers.caps.man")),
        record_(array("records.record_o[#]")) {}

  [[nodiscard]] std::optional<std::uint64_t> oldest() const override {
    if (written_) return written_->t.begin;
    if (offered_) return offered_->t.begin;
    return std::nullopt;
  }
  void finish(std::uint64_t time) override {
    for (auto* open : {&written_, &offered_})
      if (*open) leave_open(**open, time);
  }

 protected:
  void at_edge(unsigned) override {
    (void)count_pass();
    if (write_.on()) {
      if (!written_) written_ = begin("a record");  // offered before the file begins
      tell(*written_);
    }
    written_.reset();
    if (!record_valid_.on()) {
      offered_.reset();  // an abort drops waiting records
      return;
    }
    if (!offered_) {
      offered_ = begin("a record");
      stalls_ = 0;
    }
    if (!sram_ready_.on()) {
      ++stalls_;
      return;
    }
    written_ = std::move(offered_);
    written_->t.stalls = stalls_;
    offered_.reset();
  }

 private:
  void tell(Open& open) {
    Transaction& t = open.t;
    if (record_.size() != 7) return;
    const std::uint64_t flags = record_[3]->number().value_or(0);
    const auto index = record_[4]->number();
    const auto format = format_of(exp_, man_);
    const std::string none = "none";
    const std::string primary = record_[6]->decimal();
    const std::string found =
        index && (*index & 0xffffffff) == 0xffffffff ? none : record_[4]->decimal();
    const std::string distance =
        format ? number_text(record_[5]->bits, *format) : record_[5]->hexadecimal();
    field(t, "pass", pass());
    field(t, "primary", primary);
    field(t, "index", found);
    field(t, "F", flags & 1);
    field(t, "T", distance);
    if (format) field(t, "CP", numbers({record_[0], record_[1], record_[2]}, *format));
    const bool bad = (flags & 2) != 0, normal = (flags & 4) != 0;
    field(t, "normal", normal ? 1 : 0);
    t.label = fmt::format("{} primary {}, secondary {}, T {}", normal ? "normal of" : "record of",
                          primary, found, distance);
    end(open, bad ? "bad" : (flags & 1) != 0 ? "hit" : "miss");
  }

  const Wire &record_valid_, &sram_ready_, &write_, &exp_, &man_;
  std::vector<const Wire*> record_;
  std::optional<Open> offered_, written_;
  std::uint64_t stalls_ = 0;
};

}  // namespace

std::unique_ptr<Decoder> answer_decoder(const SignalPlace& place, Decoder::Take take) {
  if (place.of->kind == "test") return std::make_unique<TestDecoder>(place, std::move(take));
  if (place.of->kind == "record") return std::make_unique<RecordDecoder>(place, std::move(take));
  return nullptr;
}

}  // namespace cde::wave
