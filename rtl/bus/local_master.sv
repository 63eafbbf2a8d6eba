// Master of the local bus in the core's clock domain: serves requests that come out of the request FIFO in order, and sends what is
// read, and changes of the card's interrupt line, into the response FIFO.
// A request is a write of one beat, or a read of as many beats as its data word says, at ascending offsets.
// Latency: none from the FIFO to the bus. Throughput: one beat a clock. Stall: bus_ready_i; reads also while the response FIFO could
// overflow. The clock of its registers is gated while there is nothing to do.
module local_master #(
    parameter int ROOM_W = 5,  // of the response FIFO's room
    localparam int REQUEST_W = 1 + 1 + 2 + 32 + 64
) (
    input logic clk_i,
    input logic rst_i,
    output logic clk_o,  // gated, for this domain's side of the FIFOs

    input logic request_valid_i,
    input logic [REQUEST_W-1:0] request_i,  // {tag, write, space, offset, data or number of beats}
    output logic request_pop_o,
    output logic response_write_o,
    output logic [65:0] response_o,  // {interrupt line changed, tag, data}
    input logic [ROOM_W-1:0] response_room_i,

    output logic bus_valid_o,
    output logic bus_write_o,
    output logic [1:0] bus_space_o,
    output logic [31:0] bus_addr_o,
    output logic [63:0] bus_wdata_o,
    input logic bus_ready_i,
    input logic bus_rvalid_i,
    input logic [63:0] bus_rdata_i,
    input logic irq_i
);
  logic tag, tag_q, write, irq_q, may_read, taken, last, irq_send;
  logic [1:0] space;
  logic [31:0] offset;
  logic [63:0] data;
  logic [15:0] asked_q;
  logic [ROOM_W-1:0] inflight_q;
  clock_gate gate (.clk_i, .enable_i(request_valid_i | inflight_q != 0 | irq_i != irq_q | rst_i), .clk_o);

  assign {tag, write, space, offset, data} = request_i;
  // Answers carry the tag of the last read: another one waits for them. One place is kept for the interrupt line.
  assign may_read = response_room_i > inflight_q + 1 && (inflight_q == 0 || tag == tag_q);
  assign bus_valid_o = request_valid_i && (write || may_read);
  assign bus_write_o = write;
  assign bus_space_o = space;
  assign bus_addr_o = offset + {13'b0, asked_q, 3'b0};
  assign bus_wdata_o = data;
  assign taken = bus_valid_o && bus_ready_i;
  assign last = write || asked_q + 1 == data[15:0];
  assign request_pop_o = taken && last;
  assign irq_send = irq_i != irq_q && !bus_rvalid_i && response_room_i > inflight_q;
  assign response_write_o = bus_rvalid_i || irq_send;
  assign response_o = bus_rvalid_i ? {1'b0, tag_q, bus_rdata_i} : {1'b1, 1'b0, 63'b0, irq_i};

  always_ff @(posedge clk_o) begin
    if (taken) asked_q <= last ? '0 : asked_q + 1;
    if (taken && !write) tag_q <= tag;
    inflight_q <= inflight_q + ROOM_W'(taken && !write) - ROOM_W'(bus_rvalid_i);
    if (irq_send) irq_q <= irq_i;
    if (rst_i) begin
      asked_q <= '0;
      inflight_q <= '0;
      irq_q <= 0;
    end
  end
endmodule
