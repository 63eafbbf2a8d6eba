// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <sstream>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/four_state.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {
namespace {

constexpr std::string_view kMask = "|mask";
/// Limits for the comments `forms` of a file.
constexpr std::size_t kMostPatterns = 1000;
constexpr std::uint64_t kMostSteps = std::uint64_t{1} << 31;
constexpr unsigned kMostDecimal = 4096;  ///< bits; longer values take too long in decimal

std::string hexadecimal(std::string_view bits) {
  std::string text;
  const std::size_t odd = bits.size() % 4;
  for (std::size_t at = 0; at < bits.size();) {
    const std::string_view digit = bits.substr(at, at == 0 && odd != 0 ? odd : 4);
    at += digit.size();
    unsigned value = 0;
    char unknown = 0;
    for (const char own : digit) {
      const char c = four_state(own);
      // U, W and - are shown as the file has them.
      const char shown = c != 'x' || own == 'X' ? c : own;
      if (c != '0' && c != '1') unknown = unknown == 0 || unknown == shown ? shown : 'x';
      value = value << 1 | (c == '1' ? 1u : 0u);
    }
    text.push_back(unknown != 0 ? unknown : "0123456789abcdef"[value]);
  }
  return text;
}

/// Decimal text of any width, by long division.
std::string decimal(std::string_view bits) {
  std::vector<std::uint32_t> digits = {0};  // base 10^9, lowest first
  constexpr std::size_t kAtOnce = 29;       // less than a digit
  for (std::size_t at = 0; at < bits.size();) {
    const std::string_view part =
        bits.substr(at, at == 0 ? (bits.size() - 1) % kAtOnce + 1 : kAtOnce);
    at += part.size();
    std::uint64_t carry = 0;
    for (const char c : part) carry = 2 * carry + (c == '1' ? 1 : 0);
    for (std::uint32_t& d : digits) {
      const std::uint64_t next = (std::uint64_t{d} << part.size()) + carry;
      d = static_cast<std::uint32_t>(next % 1000000000u);
      carry = next / 1000000000u;
    }
    if (carry != 0) digits.push_back(static_cast<std::uint32_t>(carry));
  }
  std::string text = fmt::format("{}", digits.back());
  for (std::size_t i = digits.size() - 1; i-- > 0;) text += fmt::format("{:09}", digits[i]);
  return text;
}

/// The bits without leading zeros, as in Names.
std::string_view significant(std::string_view bits) {
  return bits.substr(std::min(bits.find_first_not_of('0'), bits.size() - 1));
}

bool known(std::string_view bits) {
  return bits.find_first_not_of("01") == std::string_view::npos;
}

/// The shortest decimal that reads back as this word.
std::string decimal_of(std::string_view bits, const FpFormat& format) {
  const auto w = word(bits);
  if (!w) return "x";
  if (format.is_nan(*w)) return "nan";
  const double value = format.decode(*w);
  if (format == FpFormat{11, 52}) return fmt::format("{}", value);
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", value, digits);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    if (format.encode(back) == *w) return fmt::format("{}", back);  // gives 30, not 3e+01
  }
  return fmt::format("{}", value);
}

/// Replaces H and L by 1 and 0.
std::string as_numbers(std::string_view bits) {
  std::string all(bits);
  std::transform(all.begin(), all.end(), all.begin(), four_state);
  return all;
}

std::string one_text(std::string_view bits, const Form& form) {
  if (form.kind != Form::Kind::kBinary && bits.find_first_of("hHlL") != std::string_view::npos)
    return one_text(as_numbers(bits), form);
  switch (form.kind) {
    case Form::Kind::kBinary:
      return std::string(bits);
    case Form::Kind::kUnsigned:
      return known(bits) ? decimal(bits) : "x";
    case Form::Kind::kSigned: {
      if (!known(bits)) return "x";
      if (bits.front() == '0') return decimal(bits);
      // The magnitude is the complement plus one.
      std::string magnitude(bits);
      std::size_t at = magnitude.rfind('1');
      while (at-- > 0) magnitude[at] = magnitude[at] == '0' ? '1' : '0';
      return fmt::format("-{}", decimal(magnitude));
    }
    case Form::Kind::kNames: {
      const auto name = form.names->find(significant(bits));
      return name != form.names->end() ? name->second : hexadecimal(bits);
    }
    case Form::Kind::kFloat:
      if (form.mask && bits.find_first_not_of('1') == std::string_view::npos) return "true";
      return decimal_of(bits.substr(bits.size() - static_cast<std::size_t>(form.format.width())),
                        form.format);
    case Form::Kind::kHex:
    case Form::Kind::kFile:
      break;
  }
  return hexadecimal(bits);
}

/// Bits per lane of the form in a signal, or 0.
unsigned lane_bits(const Form& form, unsigned width) {
  if (form.lane != 0) return form.lane;
  if (form.kind != Form::Kind::kFloat) return 0;
  const auto own = static_cast<unsigned>(form.format.width());
  const auto container =
      static_cast<unsigned>(contract::container(form.format.exp_bits, form.format.man_bits));
  return width % own == 0 || width % container != 0 ? own : container;
}

struct Word {
  std::string name, index, form;
};

/// Splits NAME[INDEX]:FORM; index and form are optional.
Word split(const std::string& word) {
  Word w;
  w.name = word;
  const std::size_t colon = w.name.rfind(':');
  if (colon != std::string::npos && w.name.find(']', colon) == std::string::npos) {
    w.form = w.name.substr(colon + 1);
    if (w.form.empty()) throw_usage(fmt::format("{} ends in a colon", in_quotes(word)));
    w.name.resize(colon);
  }
  return w;
}

unsigned character(const Signal& s, int bit, const std::string& word) {
  const int low = std::min(s.left, s.right), high = std::max(s.left, s.right);
  if (bit < low || bit > high)
    throw_usage(fmt::format("{}: {} has the bits [{}:{}]", in_quotes(word), printable_name(s.name),
                            s.left, s.right));
  return static_cast<unsigned>(std::abs(s.left - bit));
}

/// Selects the bits or the lane of an index.
void narrow(View& v, const std::string& index, const std::string& word) {
  int left = 0, right = 0;
  const char* const stop = index.data() + index.size();
  const auto a = std::from_chars(index.data(), stop, left);
  bool range = false;
  bool fits = a.ec == std::errc();
  if (fits && a.ptr != stop) {
    range = true;
    const auto b = *a.ptr == ':' ? std::from_chars(a.ptr + 1, stop, right)
                                 : std::from_chars_result{a.ptr, std::errc::invalid_argument};
    fits = b.ec == std::errc() && b.ptr == stop;
  }
  if (!fits) throw_usage(fmt::format("{}: the index must be [N] or [LEFT:RIGHT]", in_quotes(word)));
  if (v.signal.real || v.signal.text)
    throw_usage(fmt::format("{}: a signal of kind {} has no bits", in_quotes(word), v.signal.kind));
  const unsigned lane = range ? 0 : lane_bits(v.form, v.width);
  if (lane != 0 && lane < v.width) {
    if (v.width % lane != 0)
      throw_usage(fmt::format("{}: {} bits are not a multiple of the lane width {}",
                              in_quotes(word), v.width, lane));
    const unsigned lanes = v.width / lane;
    if (left < 0 || static_cast<unsigned>(left) >= lanes)
      throw_usage(fmt::format("{}: there are lanes 0 to {}", in_quotes(word), lanes - 1));
    v.first = v.width - lane * (static_cast<unsigned>(left) + 1);
    v.width = lane;
    return;
  }
  const unsigned from = character(v.signal, left, word),
                 to = character(v.signal, range ? right : left, word);
  if (from > to)
    throw_usage(fmt::format("{}: the range has the opposite direction of the signal's, [{}:{}]",
                            in_quotes(word), v.signal.left, v.signal.right));
  v.first = from;
  v.width = to - from + 1;
}

void check_form(const View& v, const std::string& word) {
  if (v.signal.real || v.signal.text) return;
  const unsigned lane = lane_bits(v.form, v.width);
  if (lane == 0) return;
  if (v.width % lane != 0)
    throw_usage(fmt::format(
        "{}: {} bits are not a multiple of the lane width {}; NAME[LEFT:RIGHT] takes some of them",
        in_quotes(word), v.width, lane));
  if (v.form.kind == Form::Kind::kFloat && lane < static_cast<unsigned>(v.form.format.width()))
    throw_usage(fmt::format("{}: {} has {} bits; a lane has {}", in_quotes(word),
                            v.form.format.name(), v.form.format.width(), lane));
}

std::string no_signal(Trace& trace, std::string_view name) {
  const std::string_view last = name.substr(name.rfind('.') + 1);
  // Views, since the names of a large file take much memory.
  std::set<std::string_view> whole, inner;
  for (const Signal& s : trace.signals()) {
    whole.insert(s.name);
    inner.insert(std::string_view(s.name).substr(s.name.rfind('.') + 1));
  }
  const auto near = nearest_word(name, std::vector<std::string_view>(whole.begin(), whole.end()));
  std::vector<std::string> offered;
  if (near) offered.push_back(*near);
  const auto near_last =
      nearest_word(last, std::vector<std::string_view>(inner.begin(), inner.end()));
  for (const std::string_view one : whole) {
    if (offered.size() >= 3) break;
    const std::string_view own = one.substr(one.rfind('.') + 1);
    if ((own == last || (near_last && own == *near_last)) && (!near || one != *near))
      offered.emplace_back(one);
  }
  const std::string text =
      fmt::format("{} has no signal {}", printable_name(trace.file().string()), in_quotes(name));
  return offered.empty()
             ? text + "; `cde wave ls FILE` lists them"
             : printable_name(text + fmt::format("; did you mean {}?", fmt::join(offered, " or ")));
}

}  // namespace

std::optional<std::uint64_t> word(std::string_view bits) {
  if (bits.size() > 64) return std::nullopt;
  std::uint64_t value = 0;
  for (const char own : bits) {
    const char c = four_state(own);
    if (c != '0' && c != '1') return std::nullopt;
    value = value << 1 | (c == '1' ? 1u : 0u);
  }
  return value;
}

std::optional<double> number(std::string_view bits, const FpFormat& format) {
  const auto own = static_cast<std::size_t>(format.width());
  const auto w = word(bits.substr(bits.size() - std::min(own, bits.size())));
  if (!w) return std::nullopt;
  return format.decode(*w);
}

std::optional<Form> parse_form(std::string_view text) {
  Form form;
  const std::size_t slash = text.find('/');
  const std::string_view name = text.substr(0, slash);
  if (slash != std::string_view::npos) {
    const std::string_view lane = text.substr(slash + 1);
    const auto read = std::from_chars(lane.data(), lane.data() + lane.size(), form.lane);
    if (read.ec != std::errc() || read.ptr != lane.data() + lane.size() || form.lane == 0)
      return std::nullopt;
  }
  if (name == "hex") return form;
  if (name == "auto")
    form.kind = Form::Kind::kFile;
  else if (name == "dec")
    form.kind = Form::Kind::kUnsigned;
  else if (name == "signed")
    form.kind = Form::Kind::kSigned;
  else if (name == "bin")
    form.kind = Form::Kind::kBinary;
  else {
    form.mask = name.ends_with(kMask);
    try {
      form.format = FpFormat::parse(name.substr(0, name.size() - (form.mask ? kMask.size() : 0)));
    } catch (const Error&) {
      return std::nullopt;
    }
    form.kind = Form::Kind::kFloat;
  }
  return form;
}

std::vector<std::string> form_names() {
  std::vector<std::string> all = {"auto", "hex", "dec", "signed", "bin"};
  for (const NamedFpFormat& f : kFpFormats) all.emplace_back(f.name);
  return all;
}

std::string form_name(const Form& form) {
  std::string name = "hex";
  if (form.kind == Form::Kind::kFile) name = "auto";
  if (form.kind == Form::Kind::kNames) name = "names";
  if (form.kind == Form::Kind::kUnsigned) name = "dec";
  if (form.kind == Form::Kind::kSigned) name = "signed";
  if (form.kind == Form::Kind::kBinary) name = "bin";
  if (form.kind == Form::Kind::kFloat)
    name = fmt::format("{}{}", form.format.name(), form.mask ? kMask : "");
  return form.lane == 0 ? name : fmt::format("{}/{}", name, form.lane);
}

Form fitting(const Form& form, unsigned width) {
  const unsigned lane = lane_bits(form, width);
  return lane == 0 || (width != 0 && width % lane == 0) ? form : Form{};
}

FileForms::FileForms(Trace& trace)
    : file_(printable_name(trace.file().string())),
      steps_(kMostSteps + 256 * trace.structure().bytes) {
  for (const std::string& comment : trace.comments()) {
    std::istringstream words(comment);
    std::string word;
    if (!(words >> word) || word != "forms") continue;
    while (words >> word) {
      const std::size_t sign = word.rfind('=');
      if (sign == std::string::npos) continue;
      const std::string_view what = std::string_view(word).substr(sign + 1);
      const std::size_t star = what.find('*');
      const auto form = parse_form(what.substr(0, star));
      if (!form || form->kind == Form::Kind::kFile) continue;
      Rule rule{word.substr(0, sign), *form, 0};
      if (star != std::string_view::npos) {
        const char* const stop = what.data() + what.size();
        const auto read = std::from_chars(what.data() + star + 1, stop, rule.words);
        if (read.ec != std::errc() || read.ptr != stop || rule.words == 0) continue;
      }
      if (rules_.size() == kMostPatterns)
        throw Error(ErrorCode::kFile,
                    fmt::format("{}: its comments `forms` have more than {} patterns", file_,
                                kMostPatterns));
      rules_.push_back(std::move(rule));
    }
  }
}

Form FileForms::of(const Signal& signal, const Form& asked) const {
  if (asked.kind != Form::Kind::kFile) return fitting(asked, signal.width);
  if (signal.names != nullptr) {
    Form form;
    form.kind = Form::Kind::kNames;
    form.names = signal.names;
    return form;
  }
  if (signal.real || signal.text) return {};
  for (const Rule& rule : rules_) {
    const unsigned lane = std::max(lane_bits(rule.form, signal.width), 1u);
    if (rule.words != 0 && std::uint64_t{lane} * rule.words != signal.width) continue;
    if (matches(rule.pattern, signal.name, steps_)) {
      const bool decimal =
          rule.form.kind == Form::Kind::kUnsigned || rule.form.kind == Form::Kind::kSigned;
      return decimal && signal.width > kMostDecimal ? Form{} : fitting(rule.form, signal.width);
    }
    if (steps_ == 0)
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: comparing the patterns of its comments `forms` with its signals "
                              "takes too long; expected fewer or shorter ones",
                              file_));
  }
  return {};
}

std::string_view View::bits(std::string_view value) const {
  if (signal.real || signal.text || value.size() != signal.width) return value;
  return value.substr(first, width);
}

std::string View::text(std::string_view value) const {
  if (signal.text) return utf8_text(std::string(value));
  if (signal.real) return std::string(value);
  const std::string_view own = bits(value);
  const unsigned lane = lane_bits(form, width);
  if (lane == 0 || lane >= own.size() || own.size() % lane != 0)
    return own.size() < static_cast<std::size_t>(lane) ? std::string("x") : one_text(own, form);
  std::string text;
  for (std::size_t at = own.size(); at >= lane; at -= lane)
    text +=
        fmt::format("{}{}", text.empty() ? "{" : " ", one_text(own.substr(at - lane, lane), form));
  return text + "}";
}

bool matches(std::string_view pattern, std::string_view name, std::uint64_t& steps) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, resume = 0;
  while (n < name.size()) {
    if (steps == 0) return false;
    --steps;
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*') {
      ++p;
      ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}
bool matches(std::string_view pattern, std::string_view name) {
  std::uint64_t steps = UINT64_MAX;
  return matches(pattern, name, steps);
}

namespace {

/// A name as a trace has it: without the blank that ends SystemVerilog's escaped names.
std::string without_blanks(std::string_view name) {
  std::string own;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char next = i + 1 < name.size() ? name[i + 1] : '.';
    if (name[i] != ' ' || std::string_view(".[: ").find(next) == std::string_view::npos)
      own.push_back(name[i]);
  }
  return own;
}

/// The outermost signal of a name, or null.
const Signal* outermost(Trace& trace, std::string_view name) {
  const Signal* found = nullptr;
  const Signal* other = nullptr;  // another signal at the same depth
  std::ptrdiff_t depth = 0;
  for (const Signal& s : trace.signals()) {
    if (s.name == name) return &s;
    const std::size_t more = s.name.size() - std::min(s.name.size(), name.size());
    if (more < 2 || s.name[more - 1] != '.' || !s.name.ends_with(name)) continue;
    const auto scopes = std::count(s.name.begin(), s.name.end(), '.');
    if (found == nullptr || scopes < depth) {
      found = &s;
      other = nullptr;
      depth = scopes;
    } else if (scopes == depth && s.handle != found->handle && other == nullptr) {
      other = &s;
    }
  }
  if (other != nullptr)
    throw_usage(printable_name(fmt::format("{} may be {} or {}; name more of its scopes",
                                           in_quotes(name), found->name, other->name)));
  return found;
}

/// The outermost array element of that name within a scope of its array: mem[1] is mem.mem[1] in
/// waves of Verilator since 5.048. Null if there is none.
const Signal* element(Trace& trace, std::string_view name) {
  const Signal* found = nullptr;
  std::ptrdiff_t depth = 0;
  if (!name.ends_with(']')) return found;
  for (const Signal& s : trace.signals()) {
    if (!s.name.ends_with(name.substr(name.rfind('[')))) continue;
    const std::string plain = without_array_scope(s.name);
    if (plain == s.name || (plain != name && !plain.ends_with('.' + std::string(name)))) continue;
    const auto scopes = std::count(plain.begin(), plain.end(), '.');
    if (found == nullptr || scopes < depth) {
      found = &s;
      depth = scopes;
    }
  }
  return found;
}

}  // namespace

const Signal& find_signal(Trace& trace, std::string_view asked) {
  const std::string name = without_blanks(asked);
  const Signal* found = outermost(trace, name);
  if (found == nullptr) found = element(trace, name);
  if (found == nullptr && name.ends_with("#1")) {
    found = outermost(trace, std::string_view(name).substr(0, name.size() - 2));
    if (found != nullptr && found->number == 1) return *found;
    found = nullptr;
  }
  if (found == nullptr) throw_usage(no_signal(trace, name));
  if (found->number == 1)
    throw_usage(
        printable_name(fmt::format("several signals have the name {}; ask for {}#1, {}#2 "
                                   "and so on, in the order of the file",
                                   found->name, found->name, found->name)));
  return *found;
}

std::vector<View> views(Trace& trace, const std::string& asked, const Form& form) {
  const std::string text = without_blanks(asked);
  Word w = split(text);
  // A colon may belong to an escaped name.
  if (!w.form.empty() &&
      std::any_of(trace.signals().begin(), trace.signals().end(),
                  [&](const Signal& s) { return s.name == text || s.name.ends_with('.' + text); }))
    w = {text, {}, {}};
  Form wanted = form;
  if (!w.form.empty()) {
    const auto own = parse_form(w.form);
    if (!own)
      throw_usage(fmt::format("{}: no form {}; there are: {}, and eEmM", in_quotes(text),
                              in_quotes(w.form), fmt::join(form_names(), ", ")));
    wanted = *own;
  }
  std::vector<const Signal*> found;
  // An array element has brackets in its name; other brackets are an index.
  const std::string inner = "*." + w.name;
  const auto named = [&](const std::string& name, const std::string& in_a_scope) {
    return std::any_of(trace.signals().begin(), trace.signals().end(), [&](const Signal& s) {
      return matches(name, s.name) || matches(in_a_scope, s.name);
    });
  };
  bool whole = named(w.name, inner);
  // A memory element under an escaped name: mem[1] is \mem[1].
  if (const std::size_t open = w.name.rfind('[');
      !whole && open != std::string::npos &&
      !named(w.name.substr(0, open), inner.substr(0, open + 2))) {
    std::string escaped = w.name;
    const std::size_t dot = escaped.rfind('.', open);
    escaped.insert(dot == std::string::npos ? 0 : dot + 1, 1, '\\');
    whole = named(escaped, "*." + escaped);
    const Signal* const s = whole ? nullptr : element(trace, w.name);
    if (whole) w.name = escaped;
    if (s != nullptr) w.name = s->name;
    whole = whole || s != nullptr;
  }
  const std::size_t bracket = w.name.rfind('[');
  if (!whole && bracket != std::string::npos && w.name.ends_with(']')) {
    w.index = w.name.substr(bracket + 1, w.name.size() - bracket - 2);
    w.name.resize(bracket);
    if (w.index.empty())
      throw_usage(fmt::format("{}: the index must be [N] or [LEFT:RIGHT]", in_quotes(text)));
  }
  if (found.empty() && w.name.find_first_of("*?") != std::string::npos) {
    const std::string inside = "*." + w.name;  // perhaps shorter than before
    for (const Signal& s : trace.signals())
      if (matches(w.name, s.name) || matches(inside, s.name)) found.push_back(&s);
    if (found.empty()) throw_usage(no_signal(trace, w.name));
  } else if (found.empty()) {
    found.push_back(&find_signal(trace, w.name));
  }
  std::vector<View> all;
  std::optional<FileForms> forms;
  if (wanted.kind == Form::Kind::kFile) forms.emplace(trace);
  for (const Signal* s : found) {
    View v;
    v.signal = *s;
    v.width = s->width;
    v.form = forms ? forms->of(*s, wanted) : wanted;
    v.label = s->name;
    if (!w.index.empty()) {
      narrow(v, w.index, text);
      v.indexed = true;
      v.label += "[" + w.index + "]";
    }
    // A form for all signals skips those that it does not fit.
    if (w.form.empty() || wanted.kind == Form::Kind::kFile) {
      v.form = fitting(v.form, v.width);
    } else if (found.size() > 1) {
      if (const unsigned lane = lane_bits(v.form, v.width); lane != 0 && v.width % lane != 0)
        continue;
    } else {
      check_form(v, text);
    }
    all.push_back(std::move(v));
  }
  if (all.empty()) throw_usage(fmt::format("{}: the form fits no signal", in_quotes(text)));
  return all;
}

std::string_view View::short_label() const {
  const std::size_t escaped = label.find('\\');
  const std::size_t dot = label.rfind('.', escaped);
  return std::string_view(label).substr(dot == std::string::npos ? 0 : dot + 1);
}

View view(Trace& trace, const std::string& text, const Form& form) {
  std::vector<View> all = views(trace, text, form);
  if (all.size() > 1)
    throw_usage(fmt::format("{} names {} signals; it must name one", in_quotes(text), all.size()));
  return std::move(all.front());
}

}  // namespace cde::wave
