// SPDX-License-Identifier: Apache-2.0
// Object table: ENTRIES entries, each a range of slots and a rigid transform (records_pkg::OBJECT_*). The local bus
// writes it, 64 bits per beat, into two block RAMs. Every entry is checked when it is written. Its range must lie in
// the memory of the slots, its rotation must be orthonormal as an OBB's, and its translation must be finite. For AABBs
// the rotation must be the identity. An entry never written is out of contract. The range takes effect with its second
// word, the transform with its last.
// Latency: 1 cycle to read ranges and transforms; check results of transforms take shape_check's latency (busy_o).
// Throughput: one beat written, and one range and one transform read, per cycle.
// Stall: none.
module object_table #(
    parameter config_pkg::config_t CONFIG,
    parameter int ENTRIES = 1024,  // 2 to 2,048
    parameter int PRIMARY = 0,  // 1: slots of primaries, CAPACITY slots; 0: slots in a memory of CAPACITY words
    parameter int CAPACITY = 1,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int ENTRY_W = $clog2(ENTRIES)
) (
    input logic clk_bus_i,   // gated: runs while a beat is served
    input logic clk_core_i,  // not gated
    input logic clk_i,         // clock of the read port of ranges
    input logic clk_moving_i,  // clock of the read port of transforms
    input logic rst_i,
    input logic write_i,
    input logic [31:0] addr_i,  // byte offset in the table, 8-byte aligned
    input logic [63:0] data_i,
    output logic range_write_o,

    input logic [31:0] count_i,       // entries in use
    input pairs_pkg::shape_t [1:0] shapes_i,  // shapes of their slots
    output logic good_o,              // all entries in use are in contract
    output logic busy_o,              // a check result is outstanding

    input logic [ENTRY_W-1:0] range_entry_i,
    output logic [1:0][31:0] range_o,  // first, count
    input logic [ENTRY_W-1:0] transform_entry_i,
    output logic [8:0][CW-1:0] rotation_o,
    output logic [2:0][CW-1:0] translation_o
);
  localparam int BEATS = records_pkg::OBJECT_WORDS * CW / 64;
  localparam int USED = (records_pkg::OBJECT_END * CW + 63) / 64;  // beats with words in use
  localparam int T_CHECK = config_pkg::check_latency(LAT);
  localparam logic [CW-1:0] ONE = CW'((1 << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  if (ENTRIES < 2 || ENTRIES > 2048) begin : g_illegal
    $error("object_table: ENTRIES must be 2 to 2048");
  end

  // ---- The staging register gathers words ----
  logic [31:0] beat;
  logic [ENTRY_W-1:0] entry, entry_q;
  logic [records_pkg::OBJECT_END-1:0][CW-1:0] words, words_q;
  logic [1:0][31:0] range;
  logic transform_write, commit_q;
  assign beat = (addr_i >> 3) % 32'(BEATS);
  assign entry = ENTRY_W'((addr_i >> 3) / 32'(BEATS));
  for (genvar b = 0; b < USED; b++) begin : gather
    assign words[b*64/CW+:64/CW] = (beat == 32'(b)) ? data_i : words_q[b*64/CW+:64/CW];
  end
  assign range = {words[records_pkg::OBJECT_COUNT][31:0], words[records_pkg::OBJECT_FIRST][31:0]};
  assign range_write_o = write_i && beat == 32'(records_pkg::OBJECT_COUNT * CW / 64);
  assign transform_write = write_i && beat == 32'((records_pkg::OBJECT_END - 1) * CW / 64);
  always_ff @(posedge clk_bus_i) begin
    commit_q <= transform_write && !rst_i;
    if (write_i) words_q <= words;
    if (transform_write) entry_q <= entry;
  end

  // ---- The RAMs ----
  logic [1:0][31:0] ranges[ENTRIES];
  logic [11:0][CW-1:0] transforms[ENTRIES];
  always_ff @(posedge clk_bus_i) begin
    if (range_write_o) ranges[entry] <= range;
    if (transform_write) transforms[entry] <= words[records_pkg::OBJECT_END-1:records_pkg::OBJECT_ROTATION];
  end
  always_ff @(posedge clk_i) range_o <= ranges[range_entry_i];
  always_ff @(posedge clk_moving_i) {translation_o, rotation_o} <= transforms[transform_entry_i];

  // ---- Check results ----
  logic [ENTRIES-1:0] present, bad_transform_q, turned_q;
  logic clk_check, checked, bad_checked, turned;
  logic [ENTRY_W-1:0] checked_entry;
  logic [14:0][0:0][CW-1:0] box;  // an OBB with that rotation, and the translation as its centre
  logic [0:0][CW-1:0] bad;
  check_clock #(.NUMBER_W(ENTRY_W), .T_CHECK(T_CHECK)) check_time (
      .clk_i(clk_core_i), .rst_i, .commit_i(commit_q), .number_i(entry_q), .clk_o(clk_check), .busy_o,
      .checked_o(checked), .number_o(checked_entry));
  assign box = {words_q[records_pkg::OBJECT_TRANSLATION-1:records_pkg::OBJECT_ROTATION], {3{ONE}},
      words_q[records_pkg::OBJECT_END-1:records_pkg::OBJECT_TRANSLATION]};
  shape_check #(.SHAPE(pairs_pkg::SHAPE_OBB), .EXP(EXP), .MAN(MAN), .LANES(1), .LAT(LAT), .ARITH(ARITH)) check (
      .clk_i(clk_check), .en_i(1'b1), .words_i(box), .bad_o(bad));
  pipe_delay #(.W(1), .FROM((ARITH != "rtl") ? 0 : T_CHECK), .TO(T_CHECK)) delay_bad (
      .clk_i(clk_check), .d_i(bad[0][0]),
      .q_o(bad_checked));
  always_comb begin
    turned = 0;
    for (int k = 0; k < 9; k++) turned = turned | (((k % 4 == 0) ?
        words_q[records_pkg::OBJECT_ROTATION+k] ^ ONE :
            words_q[records_pkg::OBJECT_ROTATION+k] & ~SIGN) != 0);
  end
  always_ff @(posedge clk_check) begin
    if (checked) bad_transform_q[checked_entry] <= bad_checked;
    if (commit_q) turned_q[entry_q] <= turned;
    if (rst_i) bad_transform_q <= '1;
  end

  logic [pairs_pkg::SHAPES-1:0][ENTRIES-1:0] bad_shape;
  for (genvar k = 0; k < pairs_pkg::SHAPES; k++) begin : shape
    if (pairs_pkg::uses_shape(PAIRS, k, PRIMARY != 0, SWAP != 0)) begin : g_present
      localparam int SLOTS = (PRIMARY != 0) ? CAPACITY : CAPACITY / pairs_pkg::shape_words(k);
      logic [ENTRIES-1:0] bad_range_q;
      logic [32:0] stop;
      assign stop = {1'b0, range[0]} + {1'b0, range[1]};
      always_ff @(posedge clk_bus_i) begin
        if (range_write_o) bad_range_q[entry] <= range[1] == 0 || stop > 33'(SLOTS);
        if (rst_i) bad_range_q <= '1;
      end
      assign bad_shape[k] = bad_range_q | bad_transform_q | ((k == pairs_pkg::SHAPE_AABB) ? turned_q : '0);
    end else begin : g_absent
      assign bad_shape[k] = '1;
    end
  end
  assign present = ~({ENTRIES{1'b1}} << count_i);
  assign good_o = count_i <= 32'(ENTRIES) && (present & (bad_shape[shapes_i[0][pairs_pkg::SHAPE_INDEX-1:0]] |
      bad_shape[shapes_i[1][pairs_pkg::SHAPE_INDEX-1:0]])) == '0;
endmodule
