// SPDX-License-Identifier: Apache-2.0
// cde explain --from-record: compares the update engine's decisions about a record of a scene with
// brute force in the reference. Then explains the first pair that differs, or else the winner, in
// its pipe.
#include "explain_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "cde/card/json_keys.hpp"
#include "cde/contract/records.hpp"
#include "cde/explain/bundle.hpp"
#include "cde/explain/explain_text.hpp"
#include "cde/explain/explanation.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "output/output.hpp"
#include "output/plan_output.hpp"
#include "output/streams.hpp"
#include "record_story.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;
using Side = StoryPair::Side;

std::string decimal(const RecordStory& s, float x) {
  fmt::memory_buffer b;
  WordText(s.board.format).append_decimal(b, FloatWords(s.board.format).encode(x));
  return fmt::to_string(b);
}
std::string number(const RecordStory& s, float x) {
  return WordText(s.board.format).decimal_and_bits(FloatWords(s.board.format).encode(x));
}

/// Explains why the card kept a candidate or not, from the candidates that it kept before.
class Reasons {
 public:
  explicit Reasons(const RecordStory& s) : s_(s) {}

  /// The reason for the next candidate.
  std::string next(const StoryPair& p) {
    if (p.pass != pass_) kept_ = nullptr;
    pass_ = p.pass;
    const Side& c = *p.card;
    bool wanted = true;
    std::string why = against(p, wanted);
    if (c.kept != wanted) why = fmt::format("though {}", why);
    if (kept_ != nullptr && bits(p.held) != bits(kept_->card->t))
      why += fmt::format(", and the T buffer has {}, not the {} of {}", number(s_, p.held),
                         decimal(s_, kept_->card->t), kept_->secondary);
    if (c.kept) kept_ = &p;
    return fmt::format("{}, {}", c.kept ? "kept" : "not kept", why);
  }

 private:
  std::string against(const StoryPair& p, bool& wanted) const {
    if (kept_ == nullptr) return "the first";
    const std::uint32_t other = kept_->secondary;
    const float t = p.card->t, held = kept_->card->t;
    const Mode mode = s_.asked().mode;
    if (mode == Mode::kAny) {
      wanted = false;
      return fmt::format("{} came before", other);
    }
    if (t == held) {
      wanted = p.secondary < other;
      return fmt::format("tie with {}: lower index {}", other, wanted ? "is kept" : "stays");
    }
    wanted = (t < held) == (mode == Mode::kNearest);
    return fmt::format("{} {} {} of secondary {}", decimal(s_, t), t < held ? "<" : ">",
                       decimal(s_, held), other);
  }

  const RecordStory& s_;
  std::uint64_t pass_ = 0;
  const StoryPair* kept_ = nullptr;  ///< best candidate of the pass so far
};

/// A candidate of the card, the reason why it was kept or not, and the difference from the
/// reference.
struct Line {
  const StoryPair* pair;
  std::string reason, otherwise;
};

std::string otherwise(const RecordStory& s, const StoryPair& p) {
  if (s.same(p)) return "";
  if (!p.reference) return "this pair does not count";
  const Side &c = *p.card, &r = *p.reference;
  if (!r.candidate) return r.bad ? "bad input" : "no candidate, F 0";
  if (!c.candidate) return fmt::format("a candidate: F {}, T {}", r.f ? 1 : 0, number(s, r.t));
  if (c.f != r.f || bits(c.t) != bits(r.t))
    return fmt::format("F {}, T {}", r.f ? 1 : 0, number(s, r.t));
  return r.kept ? "kept" : "not kept";
}

std::vector<Line> lines_of(const RecordStory& s) {
  Reasons reasons(s);
  std::vector<Line> lines;
  for (const StoryPair& p : s.arrived) {
    const bool lost = p.reference && p.reference->candidate && !s.same(p);
    if (!p.card->candidate && !lost) continue;
    std::string reason;
    if (s.of_pairs())
      reason = "";
    else if (p.card->candidate)
      reason = reasons.next(p);
    else
      reason = p.card->bad ? "no candidate: bad input" : "no candidate: F 0";
    lines.push_back({&p, std::move(reason), otherwise(s, p)});
  }
  return lines;
}

/// Candidates of the reference that the card's list lacks, and candidates that only the card has.
struct Balance {
  std::vector<std::uint32_t> lacks, too_many;
};
Balance balance_of(const RecordStory& s) {
  Balance b;
  for (const StoryPair& p : s.arrived) {
    const bool wanted = p.reference && p.reference->candidate;
    if (wanted && !p.card->candidate) b.lacks.push_back(p.secondary);
    if (!wanted && p.card->candidate) b.too_many.push_back(p.secondary);
  }
  for (const StoryPair& p : s.missing) b.lacks.push_back(p.secondary);
  return b;
}

class Text {
 public:
  Text(const RecordStory& s, unsigned most) : s_(s), most_(most) {}

  std::string text() {
    const std::uint32_t place = s_.primary % card::kMostPrimaries;
    put("{}, frame {}, query '{}', primary {} (row {}, lane {}): {}, mode {}\n", s_.scene.file,
        s_.frame, s_.asked().name, s_.primary, place / s_.board.lanes, place % s_.board.lanes,
        name(s_.asked().pair), name_of(s_.asked().mode));
    if (s_.first_frame != s_.frame)
      put("No record differs if only frame {} is simulated, so frames {} to {} were simulated "
          "before "
          "it.\n",
          s_.frame, s_.first_frame, s_.frame - 1);
    if (s_.brute_force_instead)
      put("In the run, primaries traverse a BVH. Here the packet is tested by brute force, with "
          "the same records. If they differ only in the run, the traversal is wrong; cde run "
          "--trace writes waves of it.\n");
    put("\n");
    records("card", s_.card);
    records("reference", s_.reference);
    put("The card's record{}.\n",
        s_.same()       ? s_.of_pairs() ? "s are the reference's" : " is the reference's"
        : s_.of_pairs() ? "s are not the reference's"
                        : " is not the reference's");
    list();
    brute_force();
    return std::move(all_);
  }

 private:
  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(all_), format, std::forward<Args>(args)...);
  }

  void records(const char* side, const std::vector<Record>& all) {
    if (s_.of_pairs() && all.size() != 1)
      return put("{:<9}  {}\n", side, counted(all.size(), "record"));
    if (all.empty()) return put("{:<9}  no record\n", side);
    const Record& r = all[0];
    if (r.bad) return put("{:<9}  bad input\n", side);
    const auto vector = [this](const Eigen::Vector3f& v) {
      return fmt::format("{},{},{}", decimal(s_, v.x()), decimal(s_, v.y()), decimal(s_, v.z()));
    };
    put("{:<9}  F {}, T {}, CP {}{}, {}\n", side, r.f ? 1 : 0, number(s_, r.t), vector(r.cp),
        s_.asked().normals ? fmt::format(", n {}", vector(r.n)) : "",
        r.index == ~0u ? "no secondary" : fmt::format("secondary {}", r.index));
  }

  void heading(std::size_t count) {
    const auto candidates = [this](std::size_t n) {
      return fmt::format("{} of {} {}", n, counted(s_.arrived.size(), "pair"),
                         n == 1 ? "is a candidate" : "are candidates");
    };
    if (s_.of_pairs()) {
      put("\nIn mode {} every {} has a record. There is no winner, and the update engine is not "
          "used.\n",
          name_of(s_.asked().mode), s_.asked().mode == Mode::kAll ? "pair" : "hit");
      if (s_.arrived.empty()) return;
      put("The card's records of the primary, in order of arrival:\n");
      return;
    }
    const bool is_signed = is_solid(s_.asked().pair) && s_.asked().mode != Mode::kAny;
    if (s_.chosen_by_host)
      put("\nSome pairs of an object with itself do not count, so the host chooses among the "
          "records of several passes. Passes with a record per pair are not listed.\n");
    put("\nOn the card {}{}{}\n", candidates(count), is_signed ? "; T is the signed distance" : "",
        count == 0 ? "." : ", in order of arrival at the update engine:");
  }

  void list() {
    const std::vector<Line> lines = lines_of(s_);
    heading(static_cast<std::size_t>(std::count_if(
        lines.begin(), lines.end(), [](const Line& l) { return l.pair->card->candidate; })));
    if (lines.empty()) return;
    if (!s_.of_pairs() && s_.passes > 1) put("{:>4}  ", "pass");
    if (!s_.of_pairs()) put("{:>7}  ", "cycle");
    put("{:>9}  F  T\n", "secondary");
    std::size_t shown = 0, left_out = 0;
    for (const Line& l : lines) {
      if (most_ != 0 && shown >= most_ && l.otherwise.empty()) {
        ++left_out;
        continue;
      }
      ++shown;
      line(l);
    }
    if (left_out != 0) put("         {} more (--max)\n", left_out);
  }
  void line(const Line& l) {
    const StoryPair& p = *l.pair;
    if (!s_.of_pairs() && s_.passes > 1) put("{:>4}  ", p.pass);
    if (!s_.of_pairs()) put("{:>7}  ", p.cycle);
    const std::string secondary = p.secondary == ~0u ? "none" : fmt::to_string(p.secondary);
    if (l.reason.empty())
      put("{:>9}  {}  {}\n", secondary, p.card->f ? 1 : 0, number(s_, p.card->t));
    else
      put("{:>9}  {}  {:<24}  {}\n", secondary, p.card->f ? 1 : 0, number(s_, p.card->t), l.reason);
    if (!l.otherwise.empty()) put("    -->  the reference: {}\n", l.otherwise);
  }

  void side_wins(const char* side, const std::vector<Record>& all) {
    if (all.empty() || all[0].index == ~0u)
      put("{:<9}  no secondary wins\n", side);
    else
      put("{:<9}  secondary {} wins, T {}\n", side, all[0].index, number(s_, all[0].t));
  }

  void brute_force() {
    put("\n");
    if (!s_.of_pairs()) {
      side_wins("card", s_.card);
      side_wins("reference", s_.reference);
    }
    const bool one = s_.candidates == 1;
    put("Brute force in the reference: {} of {} {}.", s_.candidates,
        counted(s_.pairs_in_reference, "pair"),
        s_.of_pairs() ? one ? "has a record" : "have a record"
        : one         ? "is a candidate"
                      : "are candidates");
    const Balance b = balance_of(s_);
    const auto numbers = [this](const std::vector<std::uint32_t>& list) {
      std::string text;
      const std::size_t most = most_ == 0 ? list.size() : std::min<std::size_t>(most_, list.size());
      for (std::size_t i = 0; i < most; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", list[i]);
      if (most < list.size()) text += fmt::format(" and {} more (--max)", list.size() - most);
      return text;
    };
    if (!b.lacks.empty()) put(" The card's list lacks {}.", numbers(b.lacks));
    if (!b.too_many.empty()) put(" It has extra candidates: {}.", numbers(b.too_many));
    put("\n");
    if (!s_.missing.empty())
      put("Not tested on the card: {}.\n", [&] {
        std::vector<std::uint32_t> list;
        for (const StoryPair& p : s_.missing) list.push_back(p.secondary);
        return numbers(list);
      }());
  }

  const RecordStory& s_;
  unsigned most_;
  std::string all_;
};

/// The explained pair.
struct ExplainedPair {
  std::uint32_t secondary;
  PairWords words;
  std::string options;
  explain::Explanation explanation;
};

std::optional<ExplainedPair> explained_pair(const RecordStory& s) {
  const auto secondary = s.telling();
  if (!secondary) return std::nullopt;
  const PassPipe pipe = pipe_of(s.asked(), s.board);
  PairWords words =
      pair_words(s.board.format, s.words, numbers_of(s.secondaries, *secondary), s.asked().swap);
  const PairOptions options = options_of(pipe);
  auto explanation = explain::explain(pipe.config, words.a, words.b, iterations_of(options));
  return ExplainedPair{*secondary, std::move(words), words_of(options, pipe.config, false),
                       std::move(explanation)};
}

Json side_json(const std::optional<Side>& side) {
  if (!side) return nullptr;
  return {{"F", side->f},
          {"T", fmt::format("{:a}", side->t)},
          {"is_candidate", side->candidate},
          {"stored", side->kept}};
}

Json json_of(const RecordStory& s, const RecordRequest& r, const std::optional<ExplainedPair>& t) {
  Json j = {{"schema", "cde.explain.record.1"}};
  j.update(program_json());
  j.update({{"scene", s.scene.file},
            {"frame", s.frame},
            {"query", s.asked().name},
            {"primary_number", s.primary},
            {"lane", s.primary % card::kMostPrimaries % s.board.lanes},
            {"row", s.primary % card::kMostPrimaries / s.board.lanes},
            {"pair", name(s.asked().pair)},
            {"mode", name_of(s.asked().mode)},
            {"parameters", s.board.parameters()},
            {"first_frame", s.first_frame},
            {"same", s.same()},
            {"chosen_by_host", s.chosen_by_host},
            {"brute_force_instead", s.brute_force_instead},
            {"card_records_of_it", Json::array()},
            {"reference_records_of_it", Json::array()},
            {"pairs_tested", s.arrived.size()},
            {"pairs_in_reference", s.pairs_in_reference},
            {"candidates", Json::array()}});
  for (const Record& record : s.card) j["card_records_of_it"].push_back(record_json(record));
  for (const Record& record : s.reference)
    j["reference_records_of_it"].push_back(record_json(record));
  std::uint64_t more = 0;
  for (const Line& l : lines_of(s)) {
    if (r.most != 0 && j["candidates"].size() >= r.most && l.otherwise.empty()) {
      ++more;
      continue;
    }
    const StoryPair& p = *l.pair;
    j["candidates"].push_back(
        {{"index", p.secondary == ~0u ? Json() : Json(p.secondary)},
         {"pass", s.of_pairs() ? Json() : Json(p.pass)},
         {"pass_cycle", s.of_pairs() ? Json() : Json(p.cycle)},
         {"card_side", side_json(p.card)},
         {"reference_side", side_json(p.reference)},
         {"reason", l.reason.empty() ? Json() : Json(l.reason)},
         {"reference_otherwise", l.otherwise.empty() ? Json() : Json(l.otherwise)}});
  }
  const Balance b = balance_of(s);
  j.update({{"more", more},
            {"reference_candidates", s.candidates},
            {"lacking", b.lacks},
            {"too_many", b.too_many}});
  j["explained"] = nullptr;
  if (t)
    j["explained"] = {
        {"index", t->secondary},
        {"explain_command", fmt::format("cde explain {} '{}'", t->options, t->words.text())},
        {"same", t->explanation.same()},
        {"operations", t->explanation.operations.size()},
        {"operations_found", t->explanation.found},
        {"first_differences", explanation_differences(t->explanation)}};
  return j;
}

}  // namespace

void explain_record(const RecordRequest& r) {
  const RecordStory s = record_story(record_named(r.name), r.exact, false);
  if (s.stands_in_for) log("cde: {}\n", stand_in_text(s.board, *s.stands_in_for));
  const std::optional<ExplainedPair> t = explained_pair(s);
  if (r.json) {
    print_json(json_of(s, r, t), 2);
  } else {
    print(Text(s, r.most).text());
    if (t)
      print(fmt::format("\nPrimary {} and secondary {} in the pipe alone\n\n{}", s.primary,
                        t->secondary, explanation_text(t->options, t->explanation, r.most)));
  }
  if (!s.same() || (t && !t->explanation.same())) exit_code = exit_status(ErrorCode::kMismatch);
}

}  // namespace cde::cli
