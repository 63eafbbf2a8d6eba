// SPDX-License-Identifier: Apache-2.0
// Makes records, one per cycle: from the output FIFO during a pass, from the update buffers at its end. With normals, a
// second record follows each: n in the words of CP, the signed distance in T.
// Latency: 1 cycle.
// Throughput: one record per cycle.
// Stall: ready_o is low while the ring is full, and for the first of two records.
module record_maker #(
    parameter config_pkg::config_t CONFIG,
    localparam int CW = formats_pkg::container(CONFIG.exp, CONFIG.man),
    localparam int WORDS = records_pkg::RECORD_WORDS,
    localparam int POINTS = (CONFIG.normals != 0) ? 6 : 3,
    localparam int PRIM_W = $clog2(CONFIG.primaries)
) (
    input logic clk_i,
    input logic rst_i,
    input logic flush_i,  // drops waiting records
    input logic normals_i,
    input logic streaming_i,
    input pairs_pkg::pair_t second_pair_i,  // of the pass
    input logic [1:0] solid_i,        // a pair of solids: T is the size of a signed distance
    input logic [PRIM_W-1:0] split_i,

    input card_pkg::streamed_t streamed_i,
    input card_pkg::writeback_t writeback_i,
    input logic writeback_bad_i,
    input logic result_f_i,
    input logic [31:0] result_index_i,  // of a write-back or streamed result
    input logic [CW-1:0] result_t_i,
    input logic [POINTS-1:0][CW-1:0] result_point_i,
    output logic ready_o,

    input logic sram_full_i,
    input logic sram_nearly_full_i,
    output logic write_o,
    output logic [WORDS-1:0][CW-1:0] record_o
);
  localparam logic [CW-1:0] SIGN = CW'(formats_pkg::sign_bit(CONFIG.exp, CONFIG.man));
  localparam logic [CW-1:0] QNAN = CW'(formats_pkg::quiet_nan(CONFIG.exp, CONFIG.man));
  records_pkg::record_flags_t flags;
  logic [WORDS-1:0][CW-1:0] record;
  logic normals, record_f, record_bad, record_solid, record_valid, second_q;
  logic sram_ready;  // counts the record under way
  logic [CW-1:0] record_t;
  logic [31:0] record_index;
  logic [PRIM_W-1:0] record_primary;
  assign sram_ready = !sram_full_i && !(write_o && sram_nearly_full_i);
  assign normals = CONFIG.normals != 0 && normals_i;  // a constant if the card has no normals
  assign ready_o = sram_ready && (!normals || second_q);
  assign record_valid = streaming_i ? streamed_i.valid : writeback_i.valid;
  // For solids, the update buffers hold signed distances.
  assign record_solid = (CONFIG.parallel != 0 && second_pair_i != pairs_pkg::NO_PAIR &&
      writeback_i.primary[PRIM_W-1:0] >= split_i) ?
      solid_i[1] : solid_i[0];
  assign flags = {normals && second_q, record_bad, record_f};
  assign record_bad = streaming_i ? streamed_i.bad : writeback_bad_i;
  assign record_f = streaming_i ? streamed_i.f :
      result_f_i && (!record_solid || (result_t_i & SIGN) != 0) && !record_bad;
  assign record_t = record_bad ? QNAN : record_solid ? result_t_i & ~SIGN : result_t_i;
  assign record_index = !streaming_i ? result_index_i :
      (streamed_i.f || (record_solid && !streamed_i.bad)) ? streamed_i.index : '1;
  assign record_primary = streaming_i ? PRIM_W'(32'(streamed_i.row) * 32'(CONFIG.lanes) + 32'(streamed_i.lane)) :
      writeback_i.primary[PRIM_W-1:0];
  always_comb begin
    record[records_pkg::RECORD_CP+:3] = record_bad ? {3{QNAN}} : result_point_i[2:0];
    record[records_pkg::RECORD_FLAGS] = CW'(flags);
    record[records_pkg::RECORD_INDEX] = CW'(record_index);
    record[records_pkg::RECORD_T] = record_t;
    record[records_pkg::RECORD_PRIMARY] = CW'(record_primary);
    if (flags.normal) begin
      record[records_pkg::RECORD_CP+:3] = record_bad ? {3{QNAN}} : result_point_i[POINTS-1:POINTS-3];
      record[records_pkg::RECORD_T] = (record_f && record_solid) ? record_t | SIGN : record_t;
    end
  end
  always_ff @(posedge clk_i) begin
    write_o <= !rst_i && !flush_i && record_valid && sram_ready;
    if (record_valid) record_o <= record;
    second_q <= !rst_i && !flush_i && (record_valid && sram_ready ? normals && !second_q : second_q);
  end
endmodule
