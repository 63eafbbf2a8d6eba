// SPDX-License-Identifier: Apache-2.0
// Master of the local bus in the core's clock domain. It serves requests from the request FIFO in order. Read data and
// changes of the card's interrupt line go to the response FIFO.
// A request is a write of one beat, or a read at ascending offsets. The data word of a read is its number of beats.
// Latency: 0 cycles from the FIFO to the bus.
// Throughput: one beat per cycle.
// Stall: bus_ready_i; reads also while the response FIFO could overflow. The clock of its registers is gated while it
// is idle.
module local_master #(
    parameter int FREE_W = 5  // bits of response_free_i
) (
    input logic clk_i,
    input logic rst_i,
    output logic clk_o,  // gated, for this domain's side of the FIFOs

    input logic request_valid_i,
    input card_pkg::local_request_t request_i,
    output logic request_pop_o,
    output logic response_write_o,
    output card_pkg::local_response_t response_o,
    input logic [FREE_W-1:0] response_free_i,

    output registers_pkg::bus_request_t bus_o,
    input registers_pkg::bus_response_t bus_i,
    input logic irq_i
);
  logic tag_q, irq_q, valid, may_read, taken, last, irq_send;
  logic [15:0] requested_q;
  logic [FREE_W-1:0] inflight_q;
  clock_gate gate (.clk_i, .enable_i(request_valid_i | inflight_q != 0 | irq_i != irq_q | rst_i), .clk_o);

  // Responses carry the tag of the last read, so a read with another tag waits. One place is kept for the interrupt
  // line.
  assign may_read = response_free_i > inflight_q + 1 && (inflight_q == 0 || request_i.tag == tag_q);
  assign valid = request_valid_i && (request_i.write || may_read);
  assign bus_o.valid = valid;
  assign bus_o.write = request_i.write;
  assign bus_o.space = request_i.space;
  assign bus_o.addr = request_i.offset + {13'b0, requested_q, 3'b0};
  assign bus_o.wdata = request_i.data;
  assign taken = valid && bus_i.ready;
  assign last = request_i.write || requested_q + 1 == request_i.data[15:0];
  assign request_pop_o = taken && last;
  assign irq_send = irq_i != irq_q && !bus_i.rvalid && response_free_i > inflight_q;
  assign response_write_o = bus_i.rvalid || irq_send;
  assign response_o = bus_i.rvalid ? {1'b0, tag_q, bus_i.rdata} : {1'b1, 1'b0, 63'b0, irq_i};

  always_ff @(posedge clk_o) begin
    if (taken) requested_q <= last ? '0 : requested_q + 1;
    if (taken && !request_i.write) tag_q <= request_i.tag;
    inflight_q <= inflight_q + FREE_W'(taken && !request_i.write) - FREE_W'(bus_i.rvalid);
    if (irq_send) irq_q <= irq_i;
    if (rst_i) begin
      requested_q <= '0;
      inflight_q <= '0;
      irq_q <= 0;
    end
  end
endmodule
