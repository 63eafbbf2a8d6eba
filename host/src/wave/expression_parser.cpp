// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "wave/expression_tree.hpp"

namespace cde::wave::expression {
namespace {

constexpr std::array<std::string_view, 12> kFunctions = {
    "isnan", "isinf", "isunknown", "changed",  "rose",      "fell",
    "prev",  "past",  "signed",    "unsigned", "countones", "abs"};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool is_of_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '$' ||
         c == '#';  // NAME#2
}

class ExpressionParser {
 public:
  ExpressionParser(Trace& trace, const std::string& text, const std::string& option,
                   Expression::Parsed& to)
      : trace_(trace), text_(text), option_(option), to_(to) {}

  Tree parse() {
    Tree root = choice();
    skip();
    if (at_ < text_.size()) fail(at_, "an operator or the end is expected here");
    no_text(*root);
    alone(*root);
    return root;
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    const std::string shown = printable_name(text_);
    // Printing lengthens unprintable characters.
    const std::size_t column = printable_name(text_.substr(0, at)).size();
    throw Error(ErrorCode::kUsage,
                fmt::format("{}: {}\n  {}\n  {}^", option_, what, shown, std::string(column, ' ')));
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool take(std::string_view token) {
    skip();
    if (!std::string_view(text_).substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }
  /// The longest operator at this place, if it belongs to the level.
  std::string operator_of(std::initializer_list<std::string_view> level) {
    constexpr std::array<std::string_view, 24> kAll = {
        "===", "!==", ">>>", "&&", "||", "==", "!=", "<=", ">=", "<<", ">>", "~&",
        "~|",  "~^",  "^~",  "&",  "|",  "^",  "<",  ">",  "+",  "-",  "*",  "/"};
    skip();
    for (const std::string_view op : kAll) {
      if (!std::string_view(text_).substr(at_).starts_with(op)) continue;
      if (std::find(level.begin(), level.end(), op) == level.end()) return "";
      at_ += op.size();
      return std::string(op);
    }
    if (at_ < text_.size() && text_[at_] == '%' &&
        std::find(level.begin(), level.end(), "%") != level.end()) {
      ++at_;
      return "%";
    }
    return "";
  }

  Tree make(Node::Kind kind, std::string op, std::size_t at, std::vector<Tree> kids) {
    auto n = std::make_unique<Node>();
    n->kind = kind;
    n->op = std::move(op);
    n->at = at;
    n->kids = std::move(kids);
    return n;
  }
  template <class... Kids>
  static std::vector<Tree> list(Kids&&... kids) {
    std::vector<Tree> all;
    (all.push_back(std::forward<Kids>(kids)), ...);
    return all;
  }

  /// Passes width and sign down to the operands before evaluation (IEEE 1800, 11.6.1 and 11.8.2). A
  /// self-determined expression passes its own.
  void alone(Node& n) { fit(n, n.width, n.is_signed); }

  void fit(Node& n, unsigned width, bool is_signed) {
    const bool computes =
        (n.kind == Node::Kind::kBinary && !is_comparison(n.op) && !is_logical(n.op)) ||
        (n.kind == Node::Kind::kUnary && (n.op == "-" || n.op == "+" || n.op == "~")) ||
        n.kind == Node::Kind::kChoice;
    if (n.real) {
      for (const Tree& kid : n.kids) alone(*kid);
    } else if (computes) {
      if (width > 64 && n.kind != Node::Kind::kChoice)
        fail(n.at, fmt::format("the other operand extends this to {} bits; put {{}} around it to "
                               "keep its own width, since at most 64 bits are computed",
                               width));
      n.width = width;
      n.is_signed = is_signed;
      for (std::size_t i = 0; i < n.kids.size(); ++i) {
        const bool operand = n.kind == Node::Kind::kChoice ? i > 0 : i == 0 || !is_shift(n.op);
        if (operand)
          fit(*n.kids[i], width, is_signed);
        else
          alone(*n.kids[i]);
      }
    } else {
      n.context = width;
      n.context_signed = is_signed;
      if (n.kind == Node::Kind::kBinary && is_comparison(n.op) && !n.kids[0]->real &&
          !n.kids[1]->real) {
        const unsigned both = std::max(n.kids[0]->width, n.kids[1]->width);
        const bool sign = n.kids[0]->is_signed && n.kids[1]->is_signed;
        for (const Tree& kid : n.kids) fit(*kid, both, sign);
      } else {
        for (const Tree& kid : n.kids) alone(*kid);
      }
    }
  }
  void narrow_enough(const Node& n) {
    if (!n.real && n.width > 64)
      fail(n.at,
           fmt::format("this has {} bits; only ===, !==, ==, !=, changed, isunknown, reductions "
                       "and logical operators take more than 64",
                       n.width));
  }
  void no_text(const Node& n) {
    if (n.text)
      fail(n.at, "a text can only be compared: NAME == \"TEXT\", NAME != \"TEXT\", changed(NAME)");
  }
  /// Reads a signal as a floating-point number, if the file gives it such a format.
  void as_number(Node& n) {
    if (!n.may_be_real) return;
    n.may_be_real = false;
    n.real = true;
    n.is_signed = false;
    n.width = 1;
    to_.numbers[n.view] = 1;
    to_.values[n.view] = unknown_of(1, true);
  }
  /// A signal with a number format is a number beside a number or a literal without base. Beside
  /// bits it is bits.
  void as_numbers(const std::string& op, Node& a, Node& b) {
    const bool bits = op == "&" || op == "|" || op == "^" || op == "===" || op == "!==" ||
                      is_logical(op) || is_shift(op);
    const auto is_number = [](const Node& n) { return n.real || n.may_be_real || n.plain; };
    if (bits || !is_number(a) || !is_number(b)) return;
    as_number(a);
    as_number(b);
  }
  /// A text beside a signal is a value's name in the file, or the signal's own text.
  void as_text(const std::string& op, Node& text, Node& other) {
    if (op != "==" && op != "!=" && op != "===" && op != "!==") no_text(text);
    if (text.kind != Node::Kind::kText || other.text) {
      if (!other.text) no_text(text);
      return;
    }
    const View* const v = other.kind == Node::Kind::kView ? &to_.views[other.view] : nullptr;
    if (v == nullptr || v->form.kind != Form::Kind::kNames)
      fail(text.at, "a text needs a signal beside it whose values have names, or a signal of text");
    std::vector<std::string> known;
    for (const auto& [bits, name] : *v->form.names) {
      known.push_back(name);
      if (name != text.op || bits.size() > v->width) continue;
      text.kind = Node::Kind::kConstant;
      text.text = false;
      text.constant = of_bits(std::string(v->width - bits.size(), '0') + bits, false);
      text.width = v->width;
      return;
    }
    fail(text.at, fmt::format("{} has no value {}; {}", printable_name(v->signal.name),
                              in_quotes(text.op), suggestion_text(text.op, known)));
  }
  void no_real(const Node& n, const std::string& op) {
    if (n.real) fail(n.at, fmt::format("{} takes bits, and this is a floating-point number", op));
  }

  Tree binary(std::string op, std::size_t at, Tree a, Tree b) {
    if (a->text) as_text(op, *a, *b);
    if (b->text) as_text(op, *b, *a);
    if (a->text && op.size() == 2) op += '=';  // texts are only equal or not
    as_numbers(op, *a, *b);
    const bool real = a->real || b->real, comparison = is_comparison(op);
    const unsigned width = std::max(a->width, b->width);
    const bool any_width = op == "==" || op == "!=" || op == "===" || op == "!==" || is_logical(op);
    if (!any_width) {
      narrow_enough(*a);
      narrow_enough(*b);
    }
    if (op == "&" || op == "|" || op == "^" || is_shift(op) || op == "===" || op == "!==") {
      no_real(*a, op);
      no_real(*b, op);
    }
    if (real) {
      narrow_enough(*a);
      narrow_enough(*b);
    }
    Tree n = make(Node::Kind::kBinary, op, at, {});
    if (!comparison && !is_logical(op)) {
      n->real = real;
      n->width = real ? 1 : is_shift(op) ? a->width : width;
      n->is_signed = is_shift(op) ? a->is_signed : a->is_signed && b->is_signed;
    }
    n->kids = list(std::move(a), std::move(b));
    return n;
  }

  Tree choice() {
    if (++depth_ > 200) fail(at_, "this is nested too deeply");
    Tree condition = level(0);
    skip();
    const std::size_t at = at_;
    if (take("?")) {
      Tree a = choice();
      if (!take(":")) fail(at_, "the : of ? : is expected here");
      Tree b = choice();
      for (const Tree* part : {&condition, &a, &b}) no_text(**part);
      as_numbers("?", *a, *b);
      Tree n = make(Node::Kind::kChoice, "?", at, {});
      n->real = a->real || b->real;
      n->width = n->real ? 1 : std::max(a->width, b->width);
      n->is_signed = a->is_signed && b->is_signed;
      n->kids = list(std::move(condition), std::move(a), std::move(b));
      condition = std::move(n);
    }
    --depth_;
    return condition;
  }

  Tree level(unsigned l) {
    static const std::array<std::initializer_list<std::string_view>, 10> kLevels = {
        {{"||"},
         {"&&"},
         {"|"},
         {"^"},
         {"&"},
         {"==", "!=", "===", "!=="},
         {"<", "<=", ">", ">="},
         {"<<", ">>", ">>>"},
         {"+", "-"},
         {"*", "/", "%"}}};
    if (l == kLevels.size()) return unary();
    Tree a = level(l + 1);
    for (;;) {
      skip();
      const std::size_t at = at_;
      std::string op = operator_of(kLevels.at(l));
      if (op.empty()) return a;
      a = binary(std::move(op), at, std::move(a), level(l + 1));
    }
  }

  Tree unary() {
    if (++depth_ > 200) fail(at_, "this is nested too deeply");
    skip();
    const std::size_t at = at_;
    Tree n;
    for (const std::string_view op : {"~&", "~|", "~^", "^~", "!", "~", "-", "+", "&", "|", "^"}) {
      const std::string_view rest = std::string_view(text_).substr(at_);
      if (rest.starts_with("&&") || rest.starts_with("||") || !take(op)) continue;
      Tree a = unary();
      no_text(*a);
      if (op == "-" || op == "+") as_number(*a);
      n = make(Node::Kind::kUnary, op == "^~" ? "~^" : std::string(op), at, {});
      if (op == "-" || op == "+" || op == "~") {
        narrow_enough(*a);
        if (op == "~") no_real(*a, "~");
        n->width = a->width;
        n->is_signed = a->is_signed;
        n->real = a->real;
      } else if (op != "!") {
        no_real(*a, std::string(op));
      }
      n->kids = list(std::move(a));
      break;
    }
    if (!n) n = primary();
    --depth_;
    return n;
  }

  Tree primary() {
    skip();
    const std::size_t at = at_;
    if (at_ >= text_.size()) fail(at_, "something is missing here");
    if (take("(")) {
      Tree n = choice();
      if (!take(")"))
        fail(at_, fmt::format("the ) of the ( in column {} is expected here", at + 1));
      return n;
    }
    if (take("{")) {
      Tree n = make(Node::Kind::kJoin, "{", at, {});
      n->width = 0;
      do {
        Tree part = choice();
        no_text(*part);
        no_real(*part, "{}");
        n->width += part->width;
        n->kids.push_back(std::move(part));
      } while (take(","));
      if (!take("}")) fail(at_, "a , or } is expected here");
      return n;
    }
    const char c = text_[at_];
    if (c == '"') return quoted();
    if (is_digit(c) || c == '\'') return literal();
    if (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$' || c == '\\')
      return word();
    fail(at_, "a signal, a number, a function or ( is expected here");
  }

  Tree quoted() {
    const std::size_t at = at_, stop = text_.find('"', at + 1);
    if (stop == std::string::npos) fail(at, "the second \" of this text is missing");
    at_ = stop + 1;
    Tree n = make(Node::Kind::kText, text_.substr(at + 1, stop - at - 1), at, {});
    n->text = true;
    n->constant = of_text(n->op);
    return n;
  }

  Tree constant(std::size_t at, Value v) {
    Tree n = make(Node::Kind::kConstant, "", at, {});
    n->width = v.width;
    n->is_signed = v.is_signed;
    n->real = v.real;
    n->constant = std::move(v);
    return n;
  }

  Tree literal() {
    const std::size_t at = at_;
    const std::string_view rest = std::string_view(text_).substr(at_);
    std::size_t digits = 0;
    while (digits < rest.size() && is_digit(rest[digits])) ++digits;
    if (digits < rest.size() && rest[digits] == '\'') return sized(at, digits);
    if (rest.starts_with("0x")) fail(at, "numbers in hexadecimal are written 32'h1f, or 'h1f");
    // 1_000 is 1000, as in SystemVerilog.
    const std::size_t end = std::min(rest.find_first_not_of("0123456789_"), rest.size());
    std::string number(rest.substr(0, end));
    std::erase(number, '_');
    double real = 0;
    const auto read = std::from_chars(rest.data(), rest.data() + rest.size(), real);
    const auto length = static_cast<std::size_t>(read.ptr - rest.data());
    if (length > end) {
      if (read.ec != std::errc()) fail(at, "this number is too large or too small");
      at_ += length;
      return constant(at, of_real(real));
    }
    std::uint64_t whole = 0;
    if (std::from_chars(number.data(), number.data() + number.size(), whole).ec != std::errc())
      fail(at, "this number has more than 64 bits");
    at_ += end;
    Value v;
    v.width = whole > 0x7fffffff ? 64 : 32;
    v.is_signed = whole <= 0x7fffffff;
    v.v = whole;
    Tree n = constant(at, v);
    n->plain = true;
    return n;
  }

  /// Reads 8'hff, 'b01x, 4'sd7, '0, '1.
  Tree sized(std::size_t at, std::size_t digits) {
    std::size_t width = 32;
    if (digits != 0) {
      const auto read = std::from_chars(text_.data() + at, text_.data() + at + digits, width);
      if (read.ec != std::errc() || width == 0 || width > 65536)
        fail(at, "a width must be 1 to 65536 bits");
    }
    at_ = at + digits + 1;
    bool is_signed = false;
    if (at_ < text_.size() && (text_[at_] == 's' || text_[at_] == 'S')) {
      is_signed = true;
      ++at_;
    }
    const char base = at_ < text_.size()
                          ? static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_])))
                          : ' ';
    const unsigned each = base == 'h' ? 4 : base == 'o' ? 3 : base == 'b' ? 1 : 0;
    if (each == 0 && base != 'd') fail(at_, "a base is expected here: h, d, o or b");
    const std::size_t first = ++at_;
    std::string bits;
    std::string number;
    for (; at_ < text_.size(); ++at_) {
      const char c = static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_])));
      if (c == '_') continue;
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '?') break;
      if (each == 0) {
        if (!is_digit(c)) fail(at_, "this is not a digit of this base");
        number.push_back(c);
      } else if (c == 'x' || c == 'z' || c == '?') {
        bits.append(each, c == 'x' ? 'x' : 'z');
      } else {
        const int digit = c >= 'a' ? c - 'a' + 10 : c - '0';
        if (digit >= 1 << each) fail(at_, "this is not a digit of this base");
        for (unsigned i = each; i-- > 0;) bits.push_back((digit >> i & 1) != 0 ? '1' : '0');
      }
    }
    if (each == 0) {
      std::uint64_t v = 0;
      const auto read = std::from_chars(number.data(), number.data() + number.size(), v);
      if (number.empty() || read.ec != std::errc())
        fail(first, "a number of up to 64 bits is expected here");
      for (unsigned i = 64; i-- > 0;) bits.push_back((v >> i & 1) != 0 ? '1' : '0');
    }
    if (bits.empty()) fail(first, "digits are expected here");
    if (bits.size() < width) {
      const char top = bits[0] == 'x' || bits[0] == 'z' ? bits[0] : '0';
      bits.insert(0, width - bits.size(), top);
    }
    const std::size_t over = bits.size() - width;
    if (bits.find_first_not_of('0') < over) {
      if (digits != 0) fail(at, fmt::format("this does not fit into {} bits", width));
      width = bits.size() - bits.find_first_not_of('0');
    }
    return constant(at, of_bits(std::string_view(bits).substr(bits.size() - width), is_signed));
  }

  Tree word() {
    const std::size_t at = at_;
    std::string name;
    if (text_[at_] == '\\') {  // an escaped name goes to the next space
      for (++at_; at_ < text_.size() && text_[at_] != ' '; ++at_) name.push_back(text_[at_]);
      // Some writers keep the backslash in the name.
      std::string index;
      if (at_ + 1 < text_.size() && text_[at_ + 1] == '[') {
        const std::size_t stop = text_.find(']', at_);
        if (stop == std::string::npos) fail(at_ + 1, "the ] of this [ is missing");
        index = text_.substr(at_ + 1, stop - at_);
        at_ = stop + 1;
      }
      const auto ends = [&](const Signal& s) { return s.name.ends_with('\\' + name); };
      const auto& all = trace_.signals();
      return signal(at,
                    std::any_of(all.begin(), all.end(), ends) ? '\\' + name + index : name + index);
    }
    while (at_ < text_.size() && is_of_name(text_[at_])) name.push_back(text_[at_++]);
    const std::size_t behind = at_;
    skip();
    if (at_ < text_.size() && text_[at_] == '(') return function(at, name);
    at_ = behind;
    if (name == "inf") return constant(at, of_real(std::numeric_limits<double>::infinity()));
    // An index, or an instance's index within a name.
    while (at_ < text_.size() && text_[at_] == '[') {
      const std::size_t stop = text_.find(']', at_);
      if (stop == std::string::npos) fail(at_, "the ] of this [ is missing");
      name += text_.substr(at_, stop + 1 - at_);
      at_ = stop + 1;
      if (at_ >= text_.size() || text_[at_] != '.') continue;
      while (at_ < text_.size() && is_of_name(text_[at_])) name.push_back(text_[at_++]);
    }
    // The : of ? : does not begin a form.
    bool formed = false;
    if (at_ < text_.size() && text_[at_] == ':') {
      std::size_t stop = at_ + 1;
      while (stop < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[stop])) != 0))
        ++stop;
      if (stop < text_.size() && text_[stop] == '/' &&
          is_digit(text_[std::min(stop + 1, text_.size() - 1)]))
        for (++stop; stop < text_.size() && is_digit(text_[stop]);) ++stop;
      if (parse_form(std::string_view(text_).substr(at_ + 1, stop - at_ - 1))) {
        name += text_.substr(at_, stop - at_);
        at_ = stop;
        formed = true;
      }
    }
    return signal(at, name, formed);
  }

  /// Whether a format covers the whole view, not several lanes of it.
  static bool is_one_lane(const View& v) {
    const auto own = static_cast<unsigned>(v.form.format.width());
    return v.width <= 64 &&
           (v.width == own || v.width == static_cast<unsigned>(contract::container(
                                             v.form.format.exp_bits, v.form.format.man_bits)));
  }

  /// `formed`: the name is followed by its form. Otherwise the file gives the form.
  Tree signal(std::size_t at, const std::string& name, bool formed = false) {
    View v;
    try {
      v = view(trace_, name, Form{});
    } catch (const Error& e) {
      fail(at, e.what());
    }
    Tree n = make(Node::Kind::kView, "", at, {});
    n->text = v.signal.text;
    n->real = v.signal.real || (v.form.kind == Form::Kind::kFloat && !v.signal.text);
    if (n->real && !v.signal.real && !is_one_lane(v))
      fail(at, fmt::format("this has several lanes; {}[N]:{} is one of them", v.signal.name,
                           v.form.format.name()));
    if (!formed && !v.indexed && !n->real && !n->text) {
      Form file;
      file.kind = Form::Kind::kFile;
      if (!file_forms_) file_forms_.emplace(trace_);
      v.form = file_forms_->of(v.signal, file);
      n->may_be_real = v.form.kind == Form::Kind::kFloat && is_one_lane(v);
    }
    n->is_signed = signed_view(v);
    n->width = n->real || n->text ? 1 : v.width;
    n->view = to_.views.size();
    to_.numbers.push_back(n->real && !v.signal.real ? 1 : 0);
    to_.views.push_back(v);
    to_.values.push_back(unknown_of(n->width, n->real));
    return n;
  }

  Tree function(std::size_t at, std::string name) {
    if (name.starts_with('$')) name.erase(0, 1);
    if (std::find(kFunctions.begin(), kFunctions.end(), name) == kFunctions.end())
      fail(at, fmt::format("no function {}; {}", in_quotes(name),
                           suggestion_text(name, {kFunctions.begin(), kFunctions.end()})));
    (void)take("(");
    Tree a = choice();
    if (!take(")")) fail(at_, fmt::format("the ) of {}( is expected here", name));
    if (name != "changed") no_text(*a);
    if (name == "isnan" || name == "isinf" || name == "abs") as_number(*a);
    if ((name == "isnan" || name == "isinf") && !a->real)
      fail(a->at,
           fmt::format("{} takes a floating-point number: NAME:fp32, or another format", name));
    if (name == "signed" || name == "unsigned" || name == "countones") no_real(*a, name);
    if (name == "rose" || name == "fell") no_real(*a, name);
    Tree n = make(Node::Kind::kCall, name, at, {});
    if (name == "signed" || name == "unsigned" || name == "abs" || name == "prev" ||
        name == "past") {
      n->width = a->width;
      n->real = a->real;
      n->is_signed = name == "signed" || (name != "unsigned" && a->is_signed);
    }
    if (name == "countones") n->width = 32;
    if (name == "abs") narrow_enough(*a);
    to_.needs_history = to_.needs_history || is_back(name);
    n->kids = list(std::move(a));
    return n;
  }

  Trace& trace_;
  std::optional<FileForms> file_forms_;
  const std::string& text_;
  const std::string& option_;
  Expression::Parsed& to_;
  std::size_t at_ = 0;
  unsigned depth_ = 0;
};

}  // namespace

Tree parse(Trace& trace, const std::string& text, const std::string& option,
           Expression::Parsed& to) {
  return ExpressionParser(trace, text, option, to).parse();
}

}  // namespace cde::wave::expression
