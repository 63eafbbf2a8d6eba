// SPDX-License-Identifier: Apache-2.0
// The actions of the viewer's keys.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "tui/tui_viewer.hpp"

namespace cde::wave::tui {
namespace {

/// The forms that key v cycles through.
constexpr std::array<const char*, 6> kForms = {"hex", "dec", "signed", "bin", "fp32", "fp64"};
constexpr std::size_t kMostTyped = 1000;

std::string without_spaces_around(std::string text) {
  text.erase(0, text.find_first_not_of(' '));
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace

bool Viewer::press(Key k) {
  if (searches()) {
    if (k == key::kEscape || k == key::kInterrupt) {
      search_ = nullptr;
      waiting_.clear();
      show_message("stopped", true);
    } else if (k == U'q' && ask_ == Ask::kNothing) {
      return false;
    } else {
      waiting_.push_back(k);
    }
    return true;
  }
  if (show_ == Show::kHelp) {
    help_key(k);
    return true;
  }
  if (ask_ != Ask::kNothing) {
    if (ask_ == Ask::kList)
      list_key(k);
    else
      prompt_key(k);
    return true;
  }
  show_message("");
  if (k == U'q' || k == key::kInterrupt) return false;
  try {
    if (!move_key(k) && !row_key(k) && !ask_key(k)) search_key(k);
  } catch (const Error& e) {
    show_message(e.what(), true);
  }
  return true;
}

/// Keys for the cursor and the window.
bool Viewer::move_key(Key k) {
  const Scale now = scale();
  const bool visible = cursor_ >= now.from() && cursor_ <= now.to();
  const std::size_t column = visible ? now.column(cursor_) : now.columns() / 2;
  switch (k) {
    case U'h':
    case key::kLeft:
      if (cursor_ == trace_.start()) break;
      move_to(column > 0 && visible
                  ? std::min(now.time(column - 1), cursor_ - 1)
                  : cursor_ - std::min(cursor_ - trace_.start(),
                                       std::max<std::uint64_t>(1, span_ / now.columns())));
      break;
    case U'l':
    case key::kRight:
      move_to(column + 1 < now.columns() && visible
                  ? std::max(now.first(column + 1), cursor_ + 1)
                  : cursor_ + std::min(trace_.end() - cursor_,
                                       std::max<std::uint64_t>(1, span_ / now.columns())));
      break;
    case U'H':
    case key::kShiftLeft:
      scroll(false, std::max<std::size_t>(now.columns() / 2, 1));
      break;
    case U'L':
    case key::kShiftRight:
      scroll(true, std::max<std::size_t>(now.columns() / 2, 1));
      break;
    case U'0':
    case key::kHome:
      move_to(trace_.start());
      break;
    case U'$':
    case key::kEnd:
      move_to(trace_.end());
      break;
    default:
      view_key(k);
      return k == U'+' || k == U'-' || k == U'i' || k == U'o' || k == U'=' || k == U'z' ||
             k == U'u' || k == U'c' || k == U'm' || k == U'\'';
  }
  return true;
}

/// Keys for zoom and the second cursor.
void Viewer::view_key(Key k) {
  if (k == U'+' || k == U'i') zoom(true);
  if (k == U'-' || k == U'o') zoom(false);
  if (k == U'=') {
    before_ = Stretch{from_, span_};
    set_window(trace_.start(), UINT64_MAX);
  }
  if (k == U'u' && before_) {
    const Stretch now{from_, span_};
    set_window(before_->begin, before_->end);
    before_ = now;
  }
  if (k == U'c') set_window(cursor_ - std::min(cursor_, span_ / 2), span_);
  if (k == U'm')
    second_ = second_ == cursor_ ? std::nullopt : std::optional<std::uint64_t>(cursor_);
  if (k != U'z' && k != U'\'') return;
  if (!second_) {
    show_message("there is no second cursor; m sets it at the cursor", true);
    return;
  }
  if (k == U'\'') {
    const std::uint64_t time = cursor_;
    move_to(*second_);
    second_ = time;
    return;
  }
  before_ = Stretch{from_, span_};
  const std::uint64_t first = std::min(cursor_, *second_), last = std::max(cursor_, *second_);
  set_window(first, last - first + (last - first != UINT64_MAX ? 1 : 0));
}

/// Keys for the list of signals.
bool Viewer::row_key(Key k) {
  const std::size_t page = std::max<std::size_t>(rows_shown(), 2) - 1;
  switch (k) {
    case U'j':
    case key::kDown:
      choose(chosen_ + 1);
      break;
    case U'k':
    case key::kUp:
      choose(chosen_ - std::min<std::size_t>(chosen_, 1));
      break;
    case key::kPageDown:
      choose(chosen_ + page);
      break;
    case key::kPageUp:
      choose(chosen_ - std::min(chosen_, page));
      break;
    case U'G':
      choose(SIZE_MAX);
      break;
    case U'^':
      choose(0);
      break;
    case U'J':
      move_row(true);
      break;
    case U'K':
      move_row(false);
      break;
    case U'x':
    case key::kDelete:
      remove_row();
      break;
    case U'v':
      next_form();
      break;
    case U'B':
      beside_ = !beside_;
      choose(chosen_);
      break;
    default:
      return false;
  }
  return true;
}

bool Viewer::ask_key(Key k) {
  switch (k) {
    case U'g':
    case U':':
      begin_ask(Ask::kTime);
      break;
    case U'/':
      begin_ask(Ask::kName);
      break;
    case U'f':
      begin_ask(Ask::kExpression);
      break;
    case U'V':
      begin_ask(Ask::kForm);
      break;
    case U'y':
      begin_ask(Ask::kKind);
      break;
    case U'a':
      begin_ask(Ask::kList);
      list_at_ = 0;
      fill_list();
      break;
    case U'?':
    case key::kF1:
      show_ = Show::kHelp;
      help_top_ = 0;
      break;
    default:
      return false;
  }
  return true;
}

void Viewer::search_key(Key k) {
  switch (k) {
    case U'w':
    case U'b':
      next_edge(k == U'w');
      break;
    case U'n':
    case U'N':
      if (last_was_name_)
        next_name(k == U'n');
      else
        next_match(k == U'n');
      break;
    case U't':
    case U'T':
      next_transaction(k == U't');
      break;
    case U'd':
    case U'D':
      next_difference(k == U'd');
      break;
    case key::kEscape:
      break;
    default:
      show_message("no such key; ? lists the keys", true);
  }
}

void Viewer::help_key(Key k) {
  if (k == U'j' || k == key::kDown)
    ++help_top_;
  else if (k == U'k' || k == key::kUp)
    help_top_ -= std::min<std::size_t>(help_top_, 1);
  else if (k == U' ' || k == key::kPageDown)
    help_top_ += rows_ / 2;
  else if (k == key::kPageUp)
    help_top_ -= std::min(help_top_, rows_ / 2);
  else
    show_ = Show::kWaves;
}

void Viewer::begin_ask(Ask what) {
  if (what == Ask::kForm && list_.empty()) return;
  ask_ = what;
  typed_.clear();
}

void Viewer::prompt_key(Key k) {
  if (k == key::kEscape || k == key::kInterrupt) {
    ask_ = Ask::kNothing;
  } else if (k == key::kEnter) {
    asked_[ask_] = typed_;
    answer();
  } else if (k == key::kBackspace) {
    if (typed_.empty()) ask_ = Ask::kNothing;
    if (!typed_.empty()) typed_.pop_back();
  } else if (k == key::kErase) {
    typed_.clear();
  } else if (k == key::kUp) {
    typed_ = asked_[ask_];
  } else if (k >= U' ' && k < key::kUp && k != 0x7f && typed_.size() < kMostTyped) {
    typed_.push_back(k);
  }
}

void Viewer::answer() {
  const Ask what = ask_;
  ask_ = Ask::kNothing;
  const std::string text = without_spaces_around(utf8(typed_));
  show_message("");
  if (text.empty() && what != Ask::kKind) return;
  try {
    if (what == Ask::kTime) go_to(text);
    if (what == Ask::kForm) set_form(text);
    if (what == Ask::kName) {
      name_ = text;
      last_was_name_ = true;
      next_name(true);
    }
    if (what == Ask::kExpression) {
      expression_ = text;
      last_was_name_ = false;
      next_match(true);
    }
    if (what != Ask::kKind) return;
    const auto& kinds = transaction_kinds();
    if (!text.empty() && std::find(kinds.begin(), kinds.end(), text) == kinds.end())
      throw Error(ErrorCode::kUsage, fmt::format("no kind {}; there are: {}", in_quotes(text),
                                                 fmt::join(kinds, ", ")));
    kind_ = text;
    next_transaction(true);
  } catch (const Error& e) {
    show_message(e.what(), true);
  }
}

/// Goes to a time, or to a window given by two times with a space between.
void Viewer::go_to(const std::string& text) {
  const std::size_t space = text.find(' ');
  const std::uint64_t first = times_.parse(text.substr(0, space));
  if (space != std::string::npos) {
    const std::uint64_t last = times_.parse(without_spaces_around(text.substr(space)));
    if (last < first)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is after {}", times_.text(first), times_.text(last)));
    before_ = Stretch{from_, span_};
    set_window(first, last - first + (last - first != UINT64_MAX ? 1 : 0));
  }
  move_to(first);
}

/// Lists the signals that match the typed text, a pattern or a part of the name.
void Viewer::fill_list() {
  listed_.clear();
  std::string pattern = utf8(typed_);
  const std::string form = suffix();
  pattern.resize(pattern.size() - form.size());
  // An index is not part of the name.
  if (!form.empty() && pattern.ends_with(']')) pattern.resize(pattern.rfind('['));
  const bool glob = pattern.find_first_of("*?") != std::string::npos;
  const auto& all = trace_.signals();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (glob ? matches(pattern, all[i].name) || matches("*." + pattern, all[i].name)
             : all[i].name.find(pattern) != std::string::npos)
      listed_.push_back(i);
  list_at_ = listed_.empty() ? 0 : std::min(list_at_, listed_.size() - 1);
}

/// ":FORM" at the end of the typed text.
std::string Viewer::suffix() const {
  const std::string text = utf8(typed_);
  const std::size_t colon = text.rfind(':');
  return colon == std::string::npos || text.find(']', colon) != std::string::npos
             ? ""
             : text.substr(colon);
}

void Viewer::add_listed(const std::string& word) {
  std::vector<Row> added;
  for (View& v : views(trace_, word, form_)) added.push_back(row_of(std::move(v)));
  const std::size_t at = list_.empty() ? 0 : chosen_ + 1;
  list_.insert(list_.begin() + static_cast<std::ptrdiff_t>(at),
               std::make_move_iterator(added.begin()), std::make_move_iterator(added.end()));
  chosen_ = at + added.size() - 1;
  lay_out();
  show_message(fmt::format("{} added", added.size()));
}

/// Adds the marked signal, or removes it if it is already in the list.
void Viewer::toggle_listed() {
  if (listed_.empty()) return;
  const Signal& s = trace_.signals()[listed_[list_at_]];
  const auto shown = std::find_if(list_.begin(), list_.end(), [&](const Row& r) {
    return r.wave.view().signal.name == s.name;
  });
  if (shown != list_.end() && suffix().empty()) {
    chosen_ = static_cast<std::size_t>(shown - list_.begin());
    remove_row();
  } else {
    add_listed(s.name + suffix());
  }
}

void Viewer::list_key(Key k) {
  const std::size_t page = std::max<std::size_t>(rows_, 6) - 4;
  const std::size_t last = listed_.empty() ? 0 : listed_.size() - 1;
  try {
    if (k == key::kUp) {
      list_at_ -= std::min<std::size_t>(list_at_, 1);
    } else if (k == key::kDown) {
      list_at_ = std::min(list_at_ + 1, last);
    } else if (k == key::kPageUp) {
      list_at_ -= std::min(list_at_, page);
    } else if (k == key::kPageDown) {
      list_at_ = std::min(list_at_ + page, last);
    } else if (k == key::kEnter) {
      toggle_listed();
    } else if (k == key::kTab) {
      const std::string word = without_spaces_around(utf8(typed_));
      const bool plain = word.find_first_of("*?[:") == std::string::npos;
      add_listed(plain ? "*" + word + "*" : word);
    } else if (k == key::kDelete) {
      std::vector<std::string> names;
      for (const std::size_t i : listed_) names.push_back(trace_.signals()[i].name);
      std::sort(names.begin(), names.end());
      const std::size_t before = list_.size();
      std::erase_if(list_, [&](const Row& r) {
        return std::binary_search(names.begin(), names.end(), r.wave.view().signal.name);
      });
      lay_out();
      show_message(fmt::format("{} removed", before - list_.size()));
    } else {
      prompt_key(k);
      if (ask_ == Ask::kList) fill_list();
    }
  } catch (const Error& e) {
    show_message(e.what(), true);
  }
}

void Viewer::next_form() {
  if (list_.empty()) return;
  const View& v = list_[chosen_].wave.view();
  const auto now = std::find(kForms.begin(), kForms.end(), form_name(v.form));
  // The next form that fits the width.
  for (std::size_t step = 1; step <= kForms.size(); ++step) {
    const std::size_t at =
        now == kForms.end() ? step - 1 : static_cast<std::size_t>(now - kForms.begin()) + step;
    const std::string name = kForms[at % kForms.size()];
    const Form form = parse_form(name).value_or(Form{});
    if (form.kind == Form::Kind::kFloat &&
        (v.width == 0 || v.width % static_cast<unsigned>(form.format.width()) != 0))
      continue;
    set_form(name);
    return;
  }
}

/// Sets the form, as the word NAME:FORM does.
void Viewer::set_form(const std::string& text) {
  Row& row = list_[chosen_];
  View v = row.wave.view();
  const auto form = parse_form(text);
  if (!form)
    throw Error(ErrorCode::kUsage, fmt::format("no form {}; there are: {}, and eEmM",
                                               in_quotes(text), fmt::join(form_names(), ", ")));
  if (v.first == 0 && v.width == v.signal.width) {
    (void)view(trace_, v.signal.name + ":" + text, form_);  // throws if it does not fit
  } else if (form->kind == Form::Kind::kFloat &&
             v.width % static_cast<unsigned>(form->format.width()) != 0) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{} has {} bits and not {}", v.label, v.width, form->format.width()));
  }
  const Form shown =
      form->kind == Form::Kind::kFile ? FileForms(trace_).of(v.signal, *form) : *form;
  row.wave.set_form(shown);
  if (row.other && row.other->view().signal.width == v.signal.width) row.other->set_form(shown);
  lay_out();
  show_message(fmt::format("{} as {}", v.label, form_name(*form)));
}

void Viewer::remove_row() {
  if (list_.empty()) return;
  list_.erase(list_.begin() + static_cast<std::ptrdiff_t>(chosen_));
  lay_out();
}

void Viewer::move_row(bool down) {
  if (list_.empty() || (down ? chosen_ + 1 >= list_.size() : chosen_ == 0)) return;
  const std::size_t to = down ? chosen_ + 1 : chosen_ - 1;
  std::swap(list_[chosen_], list_[to]);
  choose(to);
}

}  // namespace cde::wave::tui
