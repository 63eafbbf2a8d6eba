// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/handshakes.hpp"
#include "cde/support/text_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "cde/wave/value.hpp"

namespace cde::wave {
namespace {

/// A signal name in parts, without direction and polarity.
struct Name {
  std::vector<std::string> tokens;
  char direction = ' ';  ///< i, o or none
  bool low = false;
};

struct Family {
  std::string_view protocol, valid, ready;
};
constexpr std::array<Family, 4> kFamilies = {{{"valid/ready", "valid", "ready"},
                                              {"valid/ready", "vld", "rdy"},
                                              {"req/ack", "req", "ack"},
                                              {"req/ack", "request", "acknowledge"}}};

std::string lower(std::string_view text) {
  std::string all(text);
  for (char& c : all)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return all;
}

Name parts(const Signal& s, std::string_view own) {
  Name n;
  const std::string text = lower(own);
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t stop = std::min(text.find('_', at), text.size());
    if (stop > at) n.tokens.push_back(text.substr(at, stop - at));
    at = stop + 1;
  }
  // The suffixes _i, _o, _n, and the combined _ni, _no.
  const auto drop = [&](std::string_view end) {
    if (n.tokens.size() < 2 || n.tokens.back() != end) return false;
    n.tokens.pop_back();
    return true;
  };
  if (drop("ni")) {
    n.low = true;
    n.direction = 'i';
  } else if (drop("no")) {
    n.low = true;
    n.direction = 'o';
  } else {
    if (drop("i"))
      n.direction = 'i';
    else if (drop("o"))
      n.direction = 'o';
    n.low = drop("n");
  }
  if (n.tokens.size() > 1 && n.direction == ' ' && (n.tokens[0] == "i" || n.tokens[0] == "o")) {
    n.direction = n.tokens[0][0];
    n.tokens.erase(n.tokens.begin());
  }
  const std::string_view port = s.direction;
  if (n.direction == ' ') n.direction = port == "input" ? 'i' : port == "output" ? 'o' : ' ';
  return n;
}

std::string joined(const std::vector<std::string>& tokens, std::size_t from, std::size_t to) {
  return fmt::format("{}", fmt::join(tokens.begin() + static_cast<std::ptrdiff_t>(from),
                                     tokens.begin() + static_cast<std::ptrdiff_t>(to), "_"));
}

/// The rest of a name around a word: "bus" and "" for bus_valid, and "" and "" with "t" for tvalid,
/// as AXI puts letters before it. Nothing if the name does not contain the word.
struct WordPlace {
  std::string prefix, key;
};
std::optional<WordPlace> place(const Name& n, std::string_view word) {
  for (std::size_t i = 0; i < n.tokens.size(); ++i) {
    const std::string& t = n.tokens[i];
    if (!t.ends_with(word) || t.size() - word.size() > 2) continue;
    const std::string prefix = joined(n.tokens, 0, i);
    return WordPlace{prefix, fmt::format("{}|{}|{}", prefix, t.substr(0, t.size() - word.size()),
                                         joined(n.tokens, i + 1, n.tokens.size()))};
  }
  return std::nullopt;
}

struct Candidate {
  const Signal* signal;
  std::string own;
  Name name;
  std::string prefix;
  bool used = false;
  [[nodiscard]] HandshakeWire wire() const { return {signal->handle, own, name.low}; }
};

/// How well two directions match: the two wires of a handshake run in opposite directions.
int fit(char valid, char ready) {
  if (valid != ' ' && ready != ' ') return valid != ready ? 3 : 0;
  return valid == ready ? 2 : 1;
}

class Finder {
 public:
  Finder(Trace& trace, const std::string& clock) {
    for (const Signal& s : trace.signals()) {
      const std::size_t dot = s.name.rfind('.');
      const std::string scope = dot == std::string::npos ? "" : s.name.substr(0, dot);
      const auto [at, fresh] = number_.try_emplace(scope, scopes_.size());
      if (fresh) scopes_.push_back({scope, {}});
      scopes_[at->second].second.push_back(&s);
      const std::string own = lower(s.name.substr(dot == std::string::npos ? 0 : dot + 1));
      if (s.width == 1 && (own.find("clk") != own.npos || own.find("clock") != own.npos))
        cycles_[scope].try_emplace(own, &s);
    }
    Times times(trace, clock);
    default_clock_ = clock.empty() ? times.clock_if_any() : &times.clock();
    forced_ = !clock.empty();
  }

  Flows find() {
    for (const auto& [scope, signals] : scopes_) search(scope, signals);
    close();
    std::erase_if(flows_.pipes, [&](const PipeValid& p) { return paired_.contains(p.handle); });
    return std::move(flows_);
  }

 private:
  struct Matched {
    const Family* family;
    const Candidate *valid, *ready;
  };
  using Group = std::map<std::string, std::vector<Candidate>>;

  void search(const std::string& scope, const std::vector<const Signal*>& signals) {
    inputs_.clear();
    matched_.clear();
    outputs_.clear();
    std::array<std::pair<Group, Group>, kFamilies.size()> found;
    std::map<std::string, std::array<std::optional<Candidate>, 3>> pci;
    std::vector<std::pair<const Signal*, std::string>> valids;
    for (const Signal* s : signals) {
      if (s->real || s->text || s->width == 0) continue;
      const std::string own = s->name.substr(scope.empty() ? 0 : scope.size() + 1);
      const Name name = parts(*s, own);
      if (place(name, "valid") || place(name, "vld"))
        valids.emplace_back(s, place(name, "valid") ? place(name, "valid")->prefix : "");
      if (s->width != 1) continue;
      for (std::size_t f = 0; f < kFamilies.size(); ++f) {
        const auto valid = place(name, kFamilies[f].valid), ready = place(name, kFamilies[f].ready);
        if (valid) found[f].first[valid->key].push_back({s, own, name, valid->prefix});
        if (ready) found[f].second[ready->key].push_back({s, own, name, ready->prefix});
      }
      note_pci(pci, {s, own, name, {}});
    }
    for (std::size_t f = 0; f < kFamilies.size(); ++f)
      for (auto& [key, all] : found[f].first)
        if (const auto ready = found[f].second.find(key); ready != found[f].second.end())
          match(kFamilies[f], all, ready->second);
    // In the order of the file, which is the signals' order in memory.
    std::sort(matched_.begin(), matched_.end(),
              [](const Matched& a, const Matched& b) { return a.valid->signal < b.valid->signal; });
    for (const Matched& m : matched_) add(scope, *m.family, *m.valid, *m.ready);
    for (auto& [key, three] : pci)
      if (three[0] && three[1] && three[2] && (three[0]->name.low || !is_low(pci, three)))
        add_pci(scope, three);
    for (const std::size_t a : inputs_)
      for (const std::size_t b : outputs_)
        if (a != b) next_.emplace(a, b);
    for (const auto& [s, prefix] : valids) add_pipe(scope, *s, prefix);
  }

  static void note_pci(std::map<std::string, std::array<std::optional<Candidate>, 3>>& pci,
                       Candidate c) {
    constexpr std::array<std::string_view, 3> kWords = {"frame", "irdy", "trdy"};
    for (std::size_t w = 0; w < kWords.size(); ++w) {
      const auto& tokens = c.name.tokens;
      const auto at = std::find(tokens.begin(), tokens.end(), kWords[w]);
      // A card's output is not yet on the bus, and neither is an enable.
      if (at == tokens.end() || c.name.direction == 'o' || tokens.back() == "oe") continue;
      const auto i = static_cast<std::size_t>(at - tokens.begin());
      c.prefix = joined(tokens, 0, i);
      const std::string key =
          fmt::format("{}|{}|{}|{}", c.prefix, joined(tokens, i + 1, tokens.size()), c.name.low,
                      c.name.direction);
      if (auto& slot = pci[key][w]; !slot) slot = std::move(c);
      return;
    }
  }

  /// Whether the active-low bus wires exist beside these signals. Then these are signals inside a
  /// card, perhaps only its own part of the bus.
  static bool is_low(const std::map<std::string, std::array<std::optional<Candidate>, 3>>& pci,
                     const std::array<std::optional<Candidate>, 3>& three) {
    return std::any_of(pci.begin(), pci.end(), [&](const auto& other) {
      const auto& o = other.second;
      return o[0] && o[1] && o[2] && o[0]->name.low && o[0]->prefix == three[0]->prefix;
    });
  }

  void match(const Family& family, std::vector<Candidate>& valids,
             std::vector<Candidate>& readies) {
    // Best matches first, so that valid_i does not take the ready of valid_o.
    for (int wanted = 3; wanted >= 0; --wanted)
      for (Candidate& v : valids)
        for (Candidate& r : readies)
          if (!v.used && !r.used && fit(v.name.direction, r.name.direction) == wanted) {
            v.used = r.used = true;
            matched_.push_back({&family, &v, &r});
          }
  }

  void add(const std::string& scope, const Family& family, const Candidate& v, const Candidate& r) {
    const auto [at, fresh] =
        known_.try_emplace({v.signal->handle, r.signal->handle, 0}, flows_.handshakes.size());
    const std::size_t index = at->second;
    if (fresh) {
      Handshake h;
      h.name = fmt::format("{}/{}", v.signal->name, r.own);
      h.protocol = family.protocol;
      h.valid = v.wire();
      h.ready = r.wire();
      if (!set_clock(h, scope, v.prefix)) {
        known_.erase(at);
        return;
      }
      flows_.handshakes.push_back(std::move(h));
    }
    paired_.insert(v.signal->handle);
    if (v.name.direction == 'i') inputs_.insert(index);
    if (v.name.direction == 'o') outputs_.insert(index);
  }

  void add_pci(const std::string& scope, const std::array<std::optional<Candidate>, 3>& three) {
    Handshake h;
    h.name = fmt::format("{}/{}/{}", three[0]->signal->name, three[1]->own, three[2]->own);
    h.protocol = "pci";
    h.frame = three[0]->wire();
    h.valid = three[1]->wire();
    h.ready = three[2]->wire();
    if (known_.contains({h.valid.handle, h.ready.handle, h.frame.handle})) return;
    if (!set_clock(h, scope, three[0]->prefix.empty() ? "pci" : three[0]->prefix)) return;
    known_.emplace(std::array{h.valid.handle, h.ready.handle, h.frame.handle},
                   flows_.handshakes.size());
    flows_.handshakes.push_back(std::move(h));
  }

  void add_pipe(const std::string& scope, const Signal& s, const std::string& prefix) {
    if (!pipes_.insert(s.handle).second) return;
    PipeValid p;
    p.name = s.name;
    p.handle = s.handle;
    if (set_clock(p, scope, prefix)) flows_.pipes.push_back(std::move(p));
  }

  template <class Flow>
  bool set_clock(Flow& flow, const std::string& scope, const std::string& prefix) {
    const Signal* const s = forced_ ? default_clock_ : clock_of(scope, prefix);
    if (s == nullptr) return false;
    flow.clock = s->handle;
    flow.clock_name = s->name;
    return true;
  }

  const Signal* clock_of(const std::string& scope, const std::string& prefix) {
    constexpr std::array<std::string_view, 5> kNames = {"clk_i", "clk", "clock", "aclk", "i_clk"};
    std::vector<std::string> wanted;
    if (!prefix.empty())
      for (const char* form : {"{}_clk", "{}_clk_i", "clk_{}", "clk_{}_i", "{}_aclk"})
        wanted.push_back(fmt::format(fmt::runtime(form), prefix));
    wanted.insert(wanted.end(), kNames.begin(), kNames.end());
    for (std::string around = scope;;) {
      if (const auto at = cycles_.find(around); at != cycles_.end())
        for (const std::string& name : wanted)
          if (const auto found = at->second.find(name); found != at->second.end())
            return found->second;
      if (around.empty()) return default_clock_;
      const std::size_t dot = around.rfind('.');
      around.resize(dot == std::string::npos ? 0 : dot);
    }
  }

  /// Computes which handshakes follow which, across any number of modules.
  void close() {
    const std::size_t count = flows_.handshakes.size();
    std::vector<std::vector<std::size_t>> next(count);
    for (const auto& [a, b] : next_) next[a].push_back(b);
    for (std::size_t a = 0; a < count; ++a) {
      auto& reached = flows_.handshakes[a].leads_to;
      reached.assign(count, false);
      std::vector<std::size_t> open = next[a];
      while (!open.empty()) {
        const std::size_t b = open.back();
        open.pop_back();
        if (reached[b]) continue;
        reached[b] = true;
        open.insert(open.end(), next[b].begin(), next[b].end());
      }
    }
  }

  std::vector<std::pair<std::string, std::vector<const Signal*>>> scopes_;
  TextMap<std::size_t> number_;
  TextMap<std::map<std::string, const Signal*>> cycles_;  ///< by scope
  std::map<std::array<std::uint32_t, 3>, std::size_t> known_;
  std::set<std::uint32_t> paired_, pipes_;
  std::vector<Matched> matched_;
  std::set<std::size_t> inputs_, outputs_;  ///< of the searched scope
  std::set<std::pair<std::size_t, std::size_t>> next_;
  const Signal* default_clock_ = nullptr;
  bool forced_ = false;
  Flows flows_;
};

}  // namespace

Flows find_flows(Trace& trace, const std::string& clock) {
  return Finder(trace, clock).find();
}

}  // namespace cde::wave
