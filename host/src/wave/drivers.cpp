// SPDX-License-Identifier: Apache-2.0
// Finds the statements of a design that drive given bits of a signal.
#include <algorithm>
#include <set>

#include "cde/wave/elaborated.hpp"

namespace cde::wave {
namespace {

constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::int64_t kMostTurns = 256;  // of a loop, from 0 on, and as many below 0

char guard_holds(Context c, const Guard& g) {
  c.place = g.first;
  switch (g.kind) {
    case Guard::Kind::kIf:
      return holds(c, *g.what, g.swapped);
    case Guard::Kind::kElse: {
      const char h = holds(c, *g.what, g.swapped);
      return h == '1' ? '0' : h == '0' ? '1' : 'x';
    }
    case Guard::Kind::kItem:
    case Guard::Kind::kDefault: {
      if (g.what->child(0) == nullptr) return 'x';
      // The first matching item counts. The default may stand anywhere.
      char before = '0';
      for (const netlist::Element* other : g.what->children()) {
        if (other->tag() != "caseitem" || (g.kind == Guard::Kind::kDefault && other == g.item))
          continue;
        const char is = is_item(c, *g.what, *other);
        if (other == g.item) return is == '1' && before == 'x' ? 'x' : is;
        if (is == '1') return '0';
        if (is == 'x') before = 'x';
      }
      return before == 'x' ? 'x' : '1';
    }
    case Guard::Kind::kUnknown:
      break;
  }
  return 'x';
}

std::vector<ClockEdge> edges_of(const Context& c, const netlist::Element& sentree) {
  std::vector<ClockEdge> all;
  for (const netlist::Element* item : sentree.children()) {
    std::vector<Slice> signal;
    if (item->child(0) != nullptr) collect_sources(c, *item->child(0), signal);
    const std::string_view edge = item->attribute("edgeType");
    if (signal.size() == 1)
      all.push_back({signal[0], edge == "POS" || edge == "BOTH", edge == "NEG" || edge == "BOTH"});
  }
  return all;
}

}  // namespace

/// Collects the drivers of given bits.
class Drivers {
 public:
  Drivers(const Design& design, const Design::Elaborated& all, const Slice& wanted,
          const Values* values)
      : design_(design), all_(all), wanted_(wanted), values_(values) {}

  std::vector<Driver> take() {
    statements();
    outputs();
    input();
    if (found_.empty()) constant();
    return std::move(found_);
  }

 private:
  void statements() {
    const Body& body = all_.body(wanted_.unit);
    const Variable& v = all_.variable(wanted_);
    std::uint32_t settled = 0;  // process whose later statement decides
    std::vector<Driver> backwards;
    for (auto d = v.drives.rbegin(); d != v.drives.rend(); ++d) {
      const Drive& drive = body.drives[*d];
      if (settled != 0 && drive.process == settled) continue;
      const Context c{all_, wanted_.unit, drive.scope, values_, turn_of(drive, *d), &drive, *d};
      std::vector<Overlap> overlaps;
      collect_overlaps(c, *drive.target, wanted_, overlaps);
      if (overlaps.empty()) continue;
      Driver driver;
      bool never = false, covers = false;
      for (const Guard& g : drive.guards) {
        const char h = values_ == nullptr ? 'x' : guard_holds(c, g);
        never = never || h == '0';
        driver.sure = driver.sure && h == '1';
        if (g.kind != Guard::Kind::kUnknown)
          collect_sources(c, g.what->tag() == "case" ? *g.what->child(0) : *g.what,
                          driver.controls);
      }
      if (never) continue;
      if (drive.edges != nullptr && !v.in_process) {
        driver.kind = Driver::Kind::kRegister;
        driver.edges = edges_of(c, *drive.edges);
      }
      const auto from = backwards.size();
      for (const Overlap& o : overlaps) {
        driver.sure = driver.sure && o.exact;
        covers = covers || (o.exact && o.width == wanted_.width);
      }
      for (const Piece& piece : pieces(c, drive, overlaps)) {
        if (drive.edges == nullptr && covers && is_other(c, piece)) continue;
        Driver own = driver;
        own.place = place_of(design_, all_.netlist, piece.at);
        own.sure = own.sure && piece.sure;
        for (const netlist::Element* condition : piece.conditions)
          collect_sources(c, *condition, own.controls);
        for (const Overlap& o : piece.overlaps)
          collect_sources(c, *piece.value, o.low, o.width, own.sources,
                          values_ == nullptr ? nullptr : &own.controls);
        if (is_through(drive, own, covers)) own.kind = Driver::Kind::kWire;
        forget_itself(c, own);
        backwards.push_back(std::move(own));
      }
      std::reverse(backwards.begin() + static_cast<std::ptrdiff_t>(from), backwards.end());
      if (values_ != nullptr && driver.sure && covers) settled = drive.process;
    }
    found_.assign(std::make_move_iterator(backwards.rbegin()),
                  std::make_move_iterator(backwards.rend()));
  }

  /// A blocking assignment may read its own target as it was earlier in the instant. The waves do
  /// not have that value, so it is no cause.
  void forget_itself(const Context& c, Driver& driver) const {
    if (!driver.edges.empty() || !c.drive->blocking) return;
    for (std::vector<Slice>* const all : {&driver.sources, &driver.controls})
      std::erase_if(*all, [&](const Slice& s) {
        return s.unit == wanted_.unit && s.variable == wanted_.variable && is_passing(c, s);
      });
  }

  /// The iteration of a loop in which a statement assigns the wanted bits; nothing if there is
  /// none.
  [[nodiscard]] std::optional<Turn> turn_of(const Drive& drive, std::uint32_t number) const {
    if (values_ == nullptr) return std::nullopt;
    Context c{all_, wanted_.unit, drive.scope, values_, {}, &drive, number};
    std::optional<Turn> turn;
    std::vector<const netlist::Element*> read = {drive.target};
    for (std::size_t i = 0; i < read.size(); ++i) {
      read.insert(read.end(), read[i]->children().begin(), read[i]->children().end());
      if (!is_reference(*read[i])) continue;
      const auto s = all_.referred(wanted_.unit, drive.scope, *read[i]);
      if (!s || s->variable == wanted_.variable) continue;
      if (!all_.variable(*s).local && (drive.loop == nullptr || !is_passing(c, *s))) continue;
      if (turn && turn->variable != s->variable) return std::nullopt;
      turn = Turn{s->variable, 0};
    }
    for (std::int64_t i = 0; turn && i < 2 * kMostTurns; ++i) {
      std::vector<Overlap> overlaps;
      turn->number = static_cast<std::uint64_t>(i < kMostTurns ? i : kMostTurns - 1 - i);
      c.turn = turn;
      collect_overlaps(c, *drive.target, wanted_, overlaps);
      if (overlaps.size() == 1 && overlaps[0].exact && overlaps[0].width == wanted_.width)
        return turn;
    }
    return std::nullopt;
  }

  /// A value that is assigned, and its place.
  struct Piece {
    const netlist::Element* value = nullptr;
    const netlist::Element* at = nullptr;
    std::vector<Overlap> overlaps;
    std::vector<const netlist::Element*> conditions = {};  ///< conditions for this piece
    bool sure = true;  ///< with values: whether it is the assigned one
  };
  /// Whether the piece is known to differ from the current value of the wanted bits.
  [[nodiscard]] bool is_other(const Context& c, const Piece& piece) const {
    if (values_ == nullptr || piece.overlaps.size() != 1) return false;
    const Overlap& o = piece.overlaps[0];
    const Value now = of_bits((*values_)(wanted_), false);
    const auto value = evaluate(c, *piece.value);
    if (now.width != o.width || now.unknown() || !value || value->value.unknown()) return false;
    const std::string bits = characters(value->value);
    return bits.size() >= o.low + o.width &&
           bits.substr(bits.size() - o.low - o.width, o.width) != characters(now);
  }
  /// Verilator merges adjacent assignments. This splits them again by source line.
  [[nodiscard]] std::vector<Piece> pieces(const Context& c, const Drive& drive,
                                          const std::vector<Overlap>& overlaps) const {
    const netlist::Element* const value = drive.value != nullptr ? drive.value : drive.statement;
    std::vector<Piece> all;
    if (value->tag() == "concat")
      for (const Overlap& o : overlaps) take_apart(c, *value, o, all);
    if (all.size() == 1 && overlaps.size() == 1) return all;
    if (value->tag() == "cond") {
      Context unknown = c;
      unknown.values = nullptr;
      branches(unknown, {value, drive.statement, overlaps}, all);
    }
    std::set<std::pair<std::string, unsigned>> lines;
    for (const Piece& p : all) {
      const netlist::Line line = all_.netlist.line(*p.at);
      lines.emplace(line.file, line.line);
    }
    if (lines.size() <= 1) return {{value, drive.statement, overlaps}};
    if (value->tag() == "cond") {
      all.clear();
      branches(c, {value, drive.statement, overlaps}, all);
    }
    return all;
  }
  /// Verilator also merges the assignments of an if and its else. With values, this keeps only the
  /// taken branch.
  void branches(const Context& c, const Piece& piece, std::vector<Piece>& all) const {
    const netlist::Element& e = *piece.value;
    if (e.tag() != "cond" || e.child(2) == nullptr) {
      all.push_back(piece);
      return;
    }
    const char h = c.values == nullptr ? 'x'
                   : is_if_else(c, e)  ? holds(c, *e.child(0))
                                       : chosen(c, *e.child(0));
    for (const std::size_t branch : {1u, 2u}) {
      if (h == (branch == 1 ? '0' : '1')) continue;
      Piece own = piece;
      own.value = own.at = e.child(branch);
      own.conditions.push_back(e.child(0));
      own.sure = piece.sure && h != 'x';
      branches(c, own, all);
    }
  }
  void take_apart(const Context& c, const netlist::Element& e, const Overlap& o,
                  std::vector<Piece>& all) const {
    const std::uint64_t right =
        e.tag() == "concat" && e.child(1) != nullptr ? all_.netlist.type_of(*e.child(1)).width : 0;
    if (right == 0 || !o.exact) {
      all.push_back({&e, &e, {o}});
      return;
    }
    const std::uint64_t end = o.low + o.width;
    if (end > right) {
      const std::uint64_t low = std::max(o.low, right);
      take_apart(c, *e.child(0), {low - right, end - low, true}, all);
    }
    if (o.low < right) take_apart(c, *e.child(1), {o.low, std::min(end, right) - o.low, true}, all);
  }

  /// Adds the outputs of instances that connect to the signal.
  void outputs() {
    const Body& body = all_.body(wanted_.unit);
    for (const Output& o : body.outputs[wanted_.variable]) {
      const Part& part = body.parts[o.part];
      const Port& port = part.ports[o.port];
      const Context c{all_, wanted_.unit, part.scope, values_};
      std::vector<Overlap> overlaps;
      collect_overlaps(c, *port.expression, wanted_, overlaps);
      const std::int64_t inner = all_.units[wanted_.unit].parts[o.part];
      for (const Overlap& overlap : overlaps) {
        Driver driver;
        driver.place = place_of(design_, all_.netlist, port.expression);
        driver.kind = Driver::Kind::kPort;
        if (inner >= 0) {
          const auto unit = static_cast<std::uint32_t>(inner);
          const auto v = all_.body(unit).by_path.find(port.name);
          if (v == all_.body(unit).by_path.end()) continue;
          Slice s = all_.whole(unit, v->second);
          if (overlap.exact && overlap.low < s.width) {
            driver.kind =
                overlap.width == wanted_.width ? Driver::Kind::kWire : Driver::Kind::kPort;
            s.low = overlap.low;
            s.width = std::min(overlap.width, s.width - overlap.low);
          }
          driver.sources.push_back(s);
        } else {  // unknown inside: all inputs count
          for (const Port& other : part.ports)
            if (other.input && other.expression != nullptr)
              collect_sources(c, *other.expression, driver.sources);
        }
        found_.push_back(std::move(driver));
      }
    }
  }

  /// Adds the outside connection of an input.
  void input() {
    const Unit& unit = all_.units[wanted_.unit];
    const Variable& v = all_.variable(wanted_);
    if (unit.parent < 0 || !v.input) return;
    const auto outside = static_cast<std::uint32_t>(unit.parent);
    const Part& part = all_.body(outside).parts[unit.part];
    for (const Port& port : part.ports) {
      if (!port.input || port.name != v.path || port.expression == nullptr) continue;
      const Context c{all_, outside, part.scope, values_};
      Driver driver;
      driver.kind = Driver::Kind::kPort;
      driver.place = place_of(design_, all_.netlist, port.expression);
      collect_sources(c, *port.expression, wanted_.low, wanted_.width == 0 ? kAll : wanted_.width,
                      driver.sources);
      if (is_plain(*port.expression) && driver.sources.size() == 1 &&
          driver.sources[0].width == wanted_.width)
        driver.kind = Driver::Kind::kWire;
      found_.push_back(std::move(driver));
    }
  }
  /// Whether an output is an input of the same module, such as a delay of zero cycles.
  [[nodiscard]] bool is_through(const Drive& drive, const Driver& driver, bool covers) const {
    const Variable& v = all_.variable(wanted_);
    return covers && drive.statement->tag() == "contassign" && v.output &&
           driver.sources.size() == 1 && driver.sources[0].width == wanted_.width &&
           all_.variable(driver.sources[0]).input && is_plain(*drive.value);
  }
  /// Adds the constant of a signal that is assigned nothing else. Verilator makes it the initial
  /// value.
  void constant() {
    const netlist::Element* const value = all_.variable(wanted_).declared->child(0);
    if (value == nullptr || value->tag() != "const") return;
    Driver driver;
    driver.place = place_of(design_, all_.netlist, value);
    found_.push_back(std::move(driver));
  }
  /// Whether this is a signal, a part of one, or a concatenation, without computation.
  static bool is_plain(const netlist::Element& e) {
    if (is_reference(e)) return true;
    if (e.tag() == "sel" || e.tag() == "arraysel")
      return e.child(0) != nullptr && is_plain(*e.child(0));
    return e.tag() == "concat" &&
           std::all_of(e.children().begin(), e.children().end(),
                       [](const netlist::Element* child) { return is_plain(*child); });
  }

  const Design& design_;
  const Design::Elaborated& all_;
  const Slice wanted_;
  const Values* values_;
  std::vector<Driver> found_;
};

std::vector<Driver> Design::drivers(const Slice& slice, const Values* values) const {
  return Drivers(*this, *all_, slice, values).take();
}

std::optional<Design::Places> Design::places_of(std::string_view name) const {
  const auto slice = find(name);
  if (!slice) return std::nullopt;
  Places places{declaration(*slice), {}};
  std::set<std::pair<std::string, unsigned>> seen;
  std::set<Slice> visited;
  std::vector<Slice> waiting = {*slice};
  while (!waiting.empty()) {
    const Slice s = waiting.back();
    waiting.pop_back();
    if (!visited.insert(s).second) continue;
    for (Driver& d : drivers(s, nullptr)) {
      if (d.kind == Driver::Kind::kWire) {
        waiting.insert(waiting.end(), d.sources.begin(), d.sources.end());
      } else if (seen.emplace(d.place.file, d.place.line).second) {
        places.drivers.push_back(std::move(d.place));
      }
    }
  }
  std::sort(places.drivers.begin(), places.drivers.end(), [](const Place& a, const Place& b) {
    return std::tie(a.file, a.line) < std::tie(b.file, b.line);
  });
  return places;
}

}  // namespace cde::wave
