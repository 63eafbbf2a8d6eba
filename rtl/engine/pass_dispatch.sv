// SPDX-License-Identifier: Apache-2.0
// Gives a pass to its unit (card_pkg::UNIT_*). A request waits for its unit, which takes the pass in the cycle in which
// valid_o and ready_i meet. From the next cycle on the unit is busy. It stays busy until it reports done or, if
// aborted, is idle. There is one pass at a time.
// An abort goes to all units, which share the record ring, and drops a waiting request. Without a pass it is harmless.
// Together with a go, the abort comes first.
// With one unit, which is ready whenever it is not busy, the module is wires.
// Latency: none.
// Throughput: one pass at a time.
// Stall: ready_i.
module pass_dispatch #(
    parameter int UNITS = card_pkg::UNITS  // 1 to 2^UNIT_BITS
) (
    input logic clk_i,
    input logic rst_i,
    input logic go_i,  // not while busy_o
    input logic [card_pkg::UNIT_BITS-1:0] unit_i,  // unit of the pass that starts
    input logic abort_i,
    output logic busy_o,
    output logic done_o,  // one cycle

    output logic [UNITS-1:0] valid_o,
    input logic [UNITS-1:0] ready_i,
    output logic [UNITS-1:0] abort_o,
    input logic [UNITS-1:0] busy_i,
    input logic [UNITS-1:0] done_i
);
  if (UNITS < 1 || UNITS > (1 << card_pkg::UNIT_BITS)) begin : g_units
    $error("pass_dispatch: UNITS must be 1 to %0d", 1 << card_pkg::UNIT_BITS);
  end
  assign abort_o = {UNITS{abort_i}};
  assign done_o = |done_i;
  if (UNITS == 1) begin : g_one
    assign valid_o = go_i;
    assign busy_o = busy_i[0];
    logic unused_one;
    assign unused_one = &{1'b0, clk_i, rst_i, unit_i, ready_i};
  end else begin : g_several
    logic waiting_q, requested;
    logic [card_pkg::UNIT_BITS-1:0] unit_q, unit_requested;
    assign requested = go_i || (waiting_q && !abort_i);
    assign unit_requested = go_i ? unit_i : unit_q;
    assign valid_o = requested ? UNITS'(1) << unit_requested : '0;
    assign busy_o = waiting_q || busy_i != 0;
    always_ff @(posedge clk_i) begin
      waiting_q <= !rst_i && requested && (valid_o & ready_i) == 0;
      if (go_i) unit_q <= unit_i;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(go_i && busy_o)) else $error("pass_dispatch: go while busy");
      assert (!(go_i && 32'(unit_i) >= UNITS)) else $error("pass_dispatch: a pass for a missing unit");
      assert ((busy_i & (busy_i - 1'b1)) == 0) else $error("pass_dispatch: two units busy with one pass");
      assert (!(UNITS == 1 && go_i && ready_i == 0)) else $error("pass_dispatch: the only unit is not ready");
    end
`endif
endmodule
