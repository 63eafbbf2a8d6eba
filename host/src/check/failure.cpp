// SPDX-License-Identifier: Apache-2.0
#include "cde/check/failure.hpp"

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

namespace cde {
namespace {

using Json = nlohmann::ordered_json;

// The bits of floats.
std::vector<std::uint32_t> bits_of(const std::vector<float>& words) {
  std::vector<std::uint32_t> bits;
  for (const float w : words) bits.push_back(std::bit_cast<std::uint32_t>(w));
  return bits;
}
std::vector<float> floats_of(const Json& bits) {
  std::vector<float> words;
  for (const Json& b : bits) words.push_back(std::bit_cast<float>(b.get<std::uint32_t>()));
  return words;
}

Json config_json(const PairConfig& c) {
  return {{"pair", static_cast<unsigned>(c.pair)},
          {"algorithm", static_cast<unsigned>(c.algorithm)},
          {"box", c.box},
          {"plane", static_cast<unsigned>(c.plane)},
          {"exp_bits", c.format.exp_bits},
          {"man_bits", c.format.man_bits},
          {"lanes", c.lanes},
          {"arithmetic", static_cast<unsigned>(c.arithmetic)},
          {"sat_interval", c.sat_interval},
          {"latencies", cycles_of(c.latency)}};
}
PairConfig config_of(const Json& j) {
  PairConfig c;
  c.pair = static_cast<Pair>(j.at("pair").get<unsigned>());
  c.algorithm = static_cast<Algorithm>(j.at("algorithm").get<unsigned>());
  c.box = j.at("box").get<bool>();
  c.plane = static_cast<PlaneSide>(j.at("plane").get<unsigned>());
  c.format = {j.at("exp_bits").get<int>(), j.at("man_bits").get<int>()};
  c.lanes = j.at("lanes").get<unsigned>();
  c.arithmetic = static_cast<Arithmetic>(j.at("arithmetic").get<unsigned>());
  c.sat_interval = j.at("sat_interval").get<unsigned>();
  const auto cycles = j.at("latencies").get<std::array<unsigned, 5>>();
  c.latency = {cycles[0], cycles[1], cycles[2], cycles[3], cycles[4]};
  return c;
}

Json iterations_json(const PairIterations& b) {
  return {b.samples, b.circle, b.free};
}
PairIterations iterations_of(const Json& j) {
  const auto b = j.get<std::array<unsigned, 3>>();
  return {.samples = b[0], .circle = b[1], .free = b[2]};
}

Json result_words(const PairResult& r) {
  return {{"f", r.f}, {"bad", r.bad}, {"t", r.t}, {"cp", r.cp}, {"n", r.n}};
}
PairResult result_of(const Json& j) {
  PairResult r{.f = j.at("f").get<bool>(), .bad = j.at("bad").get<bool>(), .t = j.at("t")};
  for (std::size_t i = 0; i < 3; ++i) r.cp[i] = j.at("cp").at(i), r.n[i] = j.at("n").at(i);
  return r;
}

std::vector<std::uint32_t> bits_of(const Eigen::Vector3f& v) {
  return bits_of(std::vector<float>{v.x(), v.y(), v.z()});
}
Eigen::Vector3f vector_of(const Json& bits) {
  const std::vector<float> v = floats_of(bits);
  return {v.at(0), v.at(1), v.at(2)};
}

Json record_json(const std::optional<Record>& r) {
  if (!r) return nullptr;
  return {{"cp", bits_of(r->cp)},
          {"f", r->f},
          {"bad", r->bad},
          {"index", r->index},
          {"t", std::bit_cast<std::uint32_t>(r->t)},
          {"primary", r->primary},
          {"n", bits_of(r->n)}};
}
std::optional<Record> record_of(const Json& j) {
  if (j.is_null()) return std::nullopt;
  Record r;
  r.cp = vector_of(j.at("cp")), r.n = vector_of(j.at("n"));
  r.f = j.at("f").get<bool>(), r.bad = j.at("bad").get<bool>();
  r.index = j.at("index").get<std::uint32_t>(), r.primary = j.at("primary").get<std::uint32_t>();
  r.t = std::bit_cast<float>(j.at("t").get<std::uint32_t>());
  return r;
}

Json difference_json(const Difference& d) {
  Json secondaries = Json::array();
  for (const auto& [index, words] : d.secondaries) secondaries.push_back({index, bits_of(words)});
  return {{"card", record_json(d.card)},
          {"reference", record_json(d.reference)},
          {"primary", bits_of(d.primary)},
          {"secondaries", secondaries}};
}
Difference difference_of(const Json& j) {
  Difference d;
  d.card = record_of(j.at("card")), d.reference = record_of(j.at("reference"));
  d.primary = floats_of(j.at("primary"));
  for (const Json& s : j.at("secondaries"))
    d.secondaries.emplace_back(s.at(0).get<std::uint32_t>(), floats_of(s.at(1)));
  return d;
}

Json kind_json(const PairFailure& f) {
  return {{"kind", "pair"},
          {"config", config_json(f.config)},
          {"iterations", iterations_json(f.iterations)},
          {"options", f.options},
          {"a", f.a},
          {"b", f.b},
          {"at", f.at},
          {"card", result_words(f.card)},
          {"reference", result_words(f.reference)}};
}
Json kind_json(const CardFailure& f) {
  return {{"kind", "card"},
          {"pipe", config_json(f.pipe)},
          {"iterations", f.iterations},
          {"swap", f.swap},
          {"mode", static_cast<unsigned>(f.mode)},
          {"difference", difference_json(f.difference)},
          {"place", f.place},
          {"cycles", f.cycles}};
}
Json kind_json(const HangFailure& f) {
  return {{"kind", "hang"}, {"cycle", f.cycle}, {"unit", f.unit}, {"shown", f.shown}};
}

PairFailure pair_of(const Json& j) {
  PairFailure f;
  f.config = config_of(j.at("config")), f.iterations = iterations_of(j.at("iterations"));
  f.options = j.at("options").get<std::string>();
  f.a = j.at("a").get<std::vector<std::uint64_t>>();
  f.b = j.at("b").get<std::vector<std::uint64_t>>();
  f.at = j.at("at").get<std::size_t>();
  f.card = result_of(j.at("card")), f.reference = result_of(j.at("reference"));
  return f;
}
CardFailure card_of(const Json& j) {
  CardFailure f;
  f.pipe = config_of(j.at("pipe")), f.iterations = j.at("iterations").get<std::string>();
  f.swap = j.at("swap").get<bool>(), f.mode = static_cast<Mode>(j.at("mode").get<unsigned>());
  f.difference = difference_of(j.at("difference"));
  f.place = j.at("place").get<std::uint32_t>(), f.cycles = j.at("cycles").get<std::uint64_t>();
  return f;
}
HangFailure hang_of(const Json& j) {
  return {.cycle = j.at("cycle").get<std::uint64_t>(),
          .unit = j.at("unit").get<bool>(),
          .shown = j.at("shown").get<std::vector<std::string>>()};
}

}  // namespace

bool is_hang(const Error& error) {
  return error.code() == ErrorCode::kTimeout || error.code() == ErrorCode::kDevice;
}

Json to_json(const Failure& f) {
  Json j = std::visit([](const auto& kind) { return kind_json(kind); }, f.kind);
  j.update(
      {{"message", f.message}, {"repeat", f.repeat}, {"details", f.details}, {"files", f.files}});
  return j;
}

Failure failure_from_json(const Json& j) {
  try {
    Failure f;
    const auto kind = j.at("kind").get<std::string>();
    if (kind == "pair")
      f.kind = pair_of(j);
    else if (kind == "card")
      f.kind = card_of(j);
    else
      f.kind = hang_of(j);
    f.message = j.at("message").get<std::string>(), f.repeat = j.at("repeat").get<std::string>();
    f.details = j.at("details").get<std::string>();
    f.files = j.at("files").get<std::vector<std::pair<std::string, std::string>>>();
    return f;
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::kBadInput, fmt::format("failure: {}", e.what()));
  }
}

Json to_json(const TraceOptions& w) {
  return {{"from", w.from},
          {"to", w.to},
          {"secondary", w.secondary ? Json(*w.secondary) : Json()},
          {"cycles", w.cycles},
          {"scopes", w.scopes}};
}

TraceOptions trace_options_from_json(const Json& j) {
  TraceOptions w;
  w.from = j.at("from").get<std::uint64_t>(), w.to = j.at("to").get<std::uint64_t>();
  if (!j.at("secondary").is_null()) w.secondary = j.at("secondary").get<std::uint32_t>();
  w.cycles = j.at("cycles").get<std::uint64_t>();
  w.scopes = j.at("scopes").get<std::vector<std::string>>();
  return w;
}

}  // namespace cde
