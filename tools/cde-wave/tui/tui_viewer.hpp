// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/support/text_map.hpp"
#include "cde/wave/follow.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/transaction.hpp"
#include "tui/tui_canvas.hpp"
#include "tui/tui_rows.hpp"

/// The viewer of `cde wave tui`, without a terminal: it takes keys and draws a canvas.
namespace cde::wave::tui {

/// A character, or one of the keys below, which are not characters.
using Key = char32_t;
namespace key {
inline constexpr Key kUp = 0x110000, kDown = 0x110001, kLeft = 0x110002, kRight = 0x110003,
                     kHome = 0x110004, kEnd = 0x110005, kPageUp = 0x110006, kPageDown = 0x110007,
                     kDelete = 0x110008, kBackspace = 0x110009, kF1 = 0x11000a,
                     kShiftLeft = 0x11000b, kShiftRight = 0x11000c, kEnter = U'\n', kEscape = 0x1b,
                     kTab = U'\t', kInterrupt = 0x03, kErase = 0x15,
                     kOther = 0x1100ff;  ///< a key without a function
}  // namespace key

/// The first state of a viewer.
struct Begin {
  std::string clock;  ///< signal whose edges count cycles; empty: found by its name
  Form form;          ///< default form of added signals
  bool ascii = false;
  Stretch window{};
  std::uint64_t cursor = 0;
  std::vector<View> views;
};

class Viewer {
 public:
  static constexpr std::size_t kLeastColumns = 40, kLeastRows = 7;

  /// The traces must outlive the viewer. `other` may be null. Error kUsage.
  Viewer(Trace& trace, Trace* other, Begin begin);

  void resize(std::size_t columns, std::size_t rows);
  /// Handles a key. Returns false to end the viewer.
  [[nodiscard]] bool press(Key key);
  /// Reads or searches one piece. Returns false if there is nothing more to do.
  bool work();
  /// Whether a search is in progress; keys wait for its end.
  [[nodiscard]] bool searches() const { return static_cast<bool>(search_); }
  [[nodiscard]] Canvas draw();

  [[nodiscard]] std::uint64_t cursor() const { return cursor_; }
  [[nodiscard]] std::optional<std::uint64_t> second_cursor() const { return second_; }
  [[nodiscard]] const std::string& message() const { return message_; }
  /// The number of tracks read from the file.
  [[nodiscard]] std::size_t loads() const { return tracks_.loads(); }
  [[nodiscard]] std::size_t blocks() const { return tracks_.blocks().size(); }
  [[nodiscard]] Stretch window() const { return {scale().from(), scale().to()}; }

 private:
  struct Row {
    Wave wave;
    std::optional<Wave> other;
    std::map<std::size_t, std::vector<Stretch>> differ;  ///< by block: differences found so far
  };
  enum class Ask { kNothing, kTime, kName, kExpression, kForm, kKind, kList };
  enum class Show { kWaves, kHelp };
  /// Does a piece of a search. Returns true at its end.
  using Search = std::function<bool()>;
  struct Found {
    std::uint64_t begin, end;
    std::string kind, text;
  };

  // tui_viewer.cpp
  [[nodiscard]] Row row_of(View view);
  [[nodiscard]] Scale scale() const { return {from_, span_, wave_columns()}; }
  [[nodiscard]] std::size_t wave_columns() const;
  [[nodiscard]] std::size_t lines_of(const Row& row) const { return beside_ && row.other ? 2 : 1; }
  [[nodiscard]] std::size_t rows_shown() const;
  [[nodiscard]] bool too_small() const { return columns_ < kLeastColumns || rows_ < kLeastRows; }
  void lay_out();
  void choose(std::size_t row);
  void move_to(std::uint64_t time);
  void set_window(std::uint64_t from, std::uint64_t span);
  void zoom(bool in);
  void scroll(bool forward, std::size_t columns);
  void show_message(std::string text, bool error = false);
  bool read_piece();
  [[nodiscard]] bool read_differences();
  bool load(Tracks& tracks, std::size_t block, const std::vector<std::uint32_t>& handles);
  const std::vector<Stretch>& differences_of(Row& row, std::size_t block);
  [[nodiscard]] std::optional<std::uint64_t> cycle(std::uint64_t time);

  // tui_keys.cpp
  bool wave_key(Key k);
  bool move_key(Key k);
  bool row_key(Key k);
  bool ask_key(Key k);
  void view_key(Key k);
  void search_key(Key k);
  void help_key(Key k);
  void begin_ask(Ask what);
  void answer();
  void prompt_key(Key k);
  void list_key(Key k);
  void go_to(const std::string& text);
  void fill_list();
  void add_listed(const std::string& word);
  void toggle_listed();
  [[nodiscard]] std::string suffix() const;
  void next_form();
  void set_form(const std::string& text);
  void remove_row();
  void move_row(bool down);

  // tui_search.cpp
  void next_edge(bool forward);
  void next_name(bool forward);
  void next_match(bool forward);
  void match_forward();
  void match_backward();
  void next_transaction(bool forward);
  void show_transaction(bool forward);
  void next_difference(bool forward);
  void begin_search(const std::string& what, Search piece);
  void no_more(const std::string& what, bool forward);
  void at_progress(std::uint64_t time) { progress_ = time; }

  // tui_draw.cpp
  void draw_title(Canvas& canvas);
  void draw_ruler(Canvas& canvas, std::size_t row);
  void draw_rows(Canvas& canvas);
  void draw_line(Canvas& canvas, std::size_t line, Row& row, bool other, bool chosen);
  void mark_differences(Canvas& canvas, std::size_t line, const Row& row);
  void draw_cursors(Canvas& canvas);
  void draw_status(Canvas& canvas, std::size_t row);
  void draw_message(Canvas& canvas, std::size_t row);
  void draw_prompt(Canvas& canvas, std::size_t row);
  void draw_list(Canvas& canvas);
  void draw_help(Canvas& canvas);
  [[nodiscard]] std::string when(std::uint64_t time);

  Trace& trace_;
  Trace* other_trace_;
  Tracks tracks_;
  std::optional<Tracks> other_tracks_;
  TextViewMap<const Signal*> others_;  ///< by name
  Times times_;
  Form form_;
  bool ascii_;
  std::vector<Row> list_;
  std::size_t columns_ = 80, rows_ = 24, names_ = 8, values_ = 8, scope_ = 0;
  std::size_t top_ = 0, chosen_ = 0;
  std::uint64_t from_, span_, cursor_;
  std::optional<Stretch> before_;  ///< the window before the last zoom
  std::optional<std::uint64_t> second_;
  bool beside_ = true, cycles_known_ = false, no_cycles_ = false;
  std::string message_;
  bool is_error_ = false;

  Ask ask_ = Ask::kNothing;
  Show show_ = Show::kWaves;
  std::u32string typed_;
  std::map<Ask, std::u32string> asked_;  ///< texts typed earlier
  std::vector<std::size_t> listed_;      ///< matching signals
  std::size_t list_at_ = 0, help_top_ = 0;

  Search search_;
  std::string searched_;  ///< the text of the current search
  std::uint64_t progress_ = 0;
  std::deque<Key> waiting_;
  std::string name_, expression_, kind_;
  bool last_was_name_ = false;
  std::map<std::string, std::vector<Found>> transactions_;  ///< by kind
  std::optional<std::size_t> transaction_;                  ///< index of the shown transaction
  std::string shown_kind_;
  std::size_t batch_ = 4;  ///< signals read at once
};

}  // namespace cde::wave::tui
