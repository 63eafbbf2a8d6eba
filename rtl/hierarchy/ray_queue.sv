// SPDX-License-Identifier: Apache-2.0
// Rays on their way into a pass: a ring in memory that the bus writes, ray n of the pass at byte 32 (n mod RAYS), and
// from which they are taken as far as the host has said that they are there. Each is held against the input contract.
// Latency: 2 clocks and shape_check's. Throughput: a ray a clock. Stall: pop_i.
module ray_queue #(
    parameter config_pkg::config_t CONFIG,
    parameter int RAYS = hierarchy_pkg::RAYS,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int AW = $clog2(RAYS)
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,

    input logic clk_i,
    input logic rst_i,  // between passes: the next ray is number 0
    input logic [31:0] provided_i,  // rays that are there
    output logic [31:0] taken_o,  // whose place is free again
    output logic valid_o,
    output logic [7:0][31:0] ray_o,
    output logic [31:0] number_o,
    output logic bad_o,
    input logic pop_i
);
  localparam int T_CHECK = config_pkg::check_latency(CONFIG.lat_add, CONFIG.lat_mul, CONFIG.lat_cmp);
  localparam int DEPTH = 1 << $clog2(T_CHECK + 4);
  localparam int DW = $clog2(DEPTH);
  logic [3:0][63:0] ring[RAYS];
  logic [DW:0] places_q, queue_count;
  logic unused;
  assign unused = &{1'b0, addr_i, queue_count};
  always_ff @(posedge clk_bus_i) if (write_i) ring[addr_i[5+:AW]][addr_i[4:3]] <= data_i;

  // ---- As many are under way as the queue has places ----
  logic ask, asked_q, checked;
  logic [31:0] number_q, number;
  logic [7:0][31:0] ray_q, ray;
  assign ask = taken_o != provided_i && places_q != 0;
  always_ff @(posedge clk_i) begin
    ray_q <= ring[taken_o[AW-1:0]];
    number_q <= taken_o;
    asked_q <= ask && !rst_i;
    if (ask) taken_o <= taken_o + 1;
    places_q <= places_q + (DW + 1)'(pop_i) - (DW + 1)'(ask);
    if (rst_i) begin
      taken_o <= '0;
      places_q <= (DW + 1)'(DEPTH);
    end
  end

  // ---- The check ----
  logic [7:0][0:0][31:0] words;
  logic [0:0][31:0] bad_now, bad;
  assign words = ray_q;
  shape_check #(
      .SHAPE(pairs_pkg::SHAPE_RAY), .EXP(CONFIG.exp), .MAN(CONFIG.man), .LAT_ADD(CONFIG.lat_add),
      .LAT_MUL(CONFIG.lat_mul), .LAT_CMP(CONFIG.lat_cmp), .ARITH(ARITH)
  ) contract (
      .clk_i, .on_i(1'b1), .words_i(words), .bad_o(bad_now));
  align #(.W(32), .FROM(ARITH == "rtl" ? T_CHECK : 0), .TO(T_CHECK)) align_bad (.clk_i, .d_i(bad_now), .q_o(bad));
  align #(.W(9 * 32), .TO(T_CHECK)) align_ray (.clk_i, .d_i({number_q, ray_q}), .q_o({number, ray}));
  align_valid #(.TO(T_CHECK)) align_asked (.clk_i, .rst_i, .valid_i(asked_q), .valid_o(checked));
  sync_fifo #(.W(1 + 9 * 32), .DEPTH(DEPTH)) queue (
      .clk_i, .rst_i, .write_i(checked), .wdata_i({bad[0][0], number, ray}), .room_o(), .count_o(queue_count),
      .rdata_o({bad_o, number_o, ray_o}), .read_i(pop_i));
  assign valid_o = queue_count != 0;
endmodule
