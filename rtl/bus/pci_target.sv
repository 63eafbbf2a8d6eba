// SPDX-License-Identifier: Apache-2.0
// PCI target: configuration space and BAR0 (memory, 32- and 64-bit data phases). All bus signals are active high, and
// outputs are registers.
//
// Writes are posted into a FIFO. Reads are delayed transactions: the first attempt is latched and retried. The read is
// served after the FIFO before it, and a later attempt takes the data. Data that the master does not fetch is dropped
// after 2^15 cycles. Reads and writes leave through one port in order.
// An access is to a register of 64 bits: a 64-bit phase, two 32-bit phases of one burst, or a lone low half. A lone low
// half writes 0 to the upper half. Other responses:
//   Retry: there is no room, or the read data is not present yet.
//   Disconnect with data: the room ends, BAR0 ends, a read goes beyond one register, a burst is not linear, or the
//   access is to configuration space.
//   Disconnect without data: there is no room in the middle of a burst.
//   Target abort: byte enables select part of a half, an upper half comes without its lower half, or the offset is
//   unused.
// Latency: medium DEVSEL#; TRDY# one cycle after it.
// Throughput: one data phase per 2 cycles, since byte enables are checked first.
// Stall: retry and disconnect, as above.
module pci_target (
    input logic clk_i,
    input logic rst_i,
    output logic active_o,  // not idle: the clock must run

    input logic [63:0] ad_i,
    input logic [7:0] cbe_i,
    input logic frame_i,
    input logic irdy_i,
    input logic idsel_i,
    input logic req64_i,
    input logic own_i,            // the card's master holds the bus
    input logic parity_error_i,   // PAR does not match the bus of the previous cycle
    input logic parity64_error_i, // PAR64 does not match it
    output logic [63:0] ad_o,
    output logic ad_oe_o,
    output logic ad64_oe_o,
    output logic oe_o,  // enable of TRDY#, STOP#, DEVSEL#, ACK64#
    output logic trdy_o,
    output logic stop_o,
    output logic devsel_o,
    output logic ack64_o,
    output logic perr_o,  // drives PERR# in this cycle
    output logic detected_parity_o,
    output logic address_parity_o,
    output logic target_abort_o,

    input logic memory_i,  // bits of the command register
    input logic [31:pci_pkg::PCI_BAR_BITS] bar_i,
    output logic config_write_o,
    output logic [5:0] config_index_o,
    output logic [3:0] config_enable_o,
    output logic [31:0] config_wdata_o,
    input logic [31:0] config_rdata_i,

    output logic request_valid_o,  // oldest access
    output logic request_write_o,
    output logic [15:0] request_offset_o,
    output logic [63:0] request_wdata_o,
    input logic request_pop_i,
    input logic rvalid_i,  // response to the read
    input logic [63:0] rdata_i
);
  import pci_pkg::*;
  localparam logic [2:0] IDLE = 0, DECODE = 1, DECIDE = 2, TRANSFER = 3, BACKOFF = 4;
  localparam int FIFO_DEPTH = 16;

  // ---- The transaction on the bus ----
  logic [2:0] state_q;
  logic frame_q, req64_q, idsel_q, wide_q, linear_q, config_q, write_q;
  logic [31:0] addr_q;
  logic [3:0] command_q;
  logic start, config_hit, memory_hit, memory_write;
  assign start = frame_i && !frame_q && !own_i;
  assign config_hit = idsel_q && (command_q == PCI_CONFIG_READ ||
      command_q == PCI_CONFIG_WRITE) && addr_q[1:0] == 0 && addr_q[10:8] == 0;
  assign memory_write = command_q == PCI_MEMORY_WRITE || command_q == PCI_WRITE_INVALIDATE;
  assign memory_hit = memory_i && addr_q[31:PCI_BAR_BITS] == bar_i &&
      (memory_write || command_q == PCI_MEMORY_READ || command_q == PCI_READ_LINE ||
      command_q == PCI_READ_MULTIPLE);
  assign address_parity_o = state_q == DECODE && (parity_error_i || (req64_q && parity64_error_i));

  // ---- Response to this data phase ----
  logic [7:0] be;
  logic offset_valid, be_ok, fifo_ready, abort, same_read, read_ready, last_of_bar;
  logic low_taken;  // the previous phase was the lower half of this register
  logic [4:0] fifo_free;
  logic fifo_some;
  assign be = ~cbe_i;
  assign offset_valid = addr_q[15:0] < PCI_REGISTERS_END || addr_q[15:0] >= PCI_PAGE_TABLE;
  assign be_ok = wide_q ? (be == 8'hFF || be == 8'h0F || be == 8'h00) :
      (be[3:0] == 4'h0 || (be[3:0] == 4'hF && (!addr_q[2] || low_taken)));
  assign abort = !config_q && (!offset_valid || (write_q && !be_ok) || (wide_q && addr_q[2]));
  assign fifo_ready = fifo_free >= 2;  // one entry may be under way
  assign last_of_bar = wide_q ? &addr_q[15:3] : &addr_q[15:2];

  // ---- Delayed read ----
  logic read_pending_q, read_done_q;
  logic [15:2] read_addr_q;
  logic [3:0] read_command_q;
  logic read_wide_q;
  logic [63:0] read_data_q;
  logic [15:0] read_age_q;
  logic read_latch, read_take, read_second_q;  // second half of a register read in halves
  assign same_read = read_pending_q && read_addr_q == addr_q[15:2] && read_command_q == command_q &&
      read_wide_q == wide_q;
  assign read_ready = (same_read && read_done_q) || read_second_q;

  logic transfer, finish, in_valid_q, in_end_q, low_end_q, low_valid_q;  // in_*, low_*: below
  assign transfer = state_q == TRANSFER && irdy_i;
  assign finish = irdy_i && !frame_i && (state_q == TRANSFER || state_q == BACKOFF);
  assign read_latch = state_q == DECIDE && !config_q && !write_q && !abort && !read_pending_q && !read_second_q &&
      fifo_ready;
  assign read_take = transfer && !config_q && !write_q;
  assign target_abort_o = state_q == DECIDE && abort;
  assign active_o = state_q != IDLE || oe_o || frame_i || frame_q || in_valid_q || in_end_q || low_end_q ||
      low_valid_q || perr_o || read_pending_q || fifo_some;

  always_ff @(posedge clk_i) begin
    frame_q <= frame_i;
    if (finish) begin
      state_q <= IDLE;
      {trdy_o, stop_o, devsel_o, ack64_o, ad_oe_o, ad64_oe_o} <= '0;
      read_second_q <= 0;
    end else
      case (state_q)
        IDLE: oe_o <= 0;
        DECODE: begin
          state_q <= IDLE;
          if ((config_hit || memory_hit) && !address_parity_o) begin
            state_q <= DECIDE;
            oe_o <= 1;
            devsel_o <= 1;
            ack64_o <= req64_q && memory_hit;
            wide_q <= req64_q && memory_hit;
            config_q <= config_hit;
            write_q <= config_hit ? command_q[0] : memory_write;
            ad_oe_o <= config_hit ? !command_q[0] : !memory_write;
            ad64_oe_o <= memory_hit && !memory_write && req64_q;
          end
        end
        DECIDE: begin
          state_q <= BACKOFF;
          if (abort) begin
            devsel_o <= 0;
            ack64_o <= 0;
            stop_o <= 1;
          end else if (config_q || (write_q ? fifo_ready : read_ready)) begin
            state_q <= TRANSFER;
            trdy_o <= 1;
            stop_o <= config_q || !linear_q || last_of_bar || (write_q ? fifo_free == 2 && (wide_q ||
                addr_q[2]) : wide_q || addr_q[2]);
            ad_o <= config_q ? {32'b0, config_rdata_i} : (!wide_q && addr_q[2]) ? {32'b0,
                read_data_q[63:32]} : read_data_q;
          end else stop_o <= 1;  // retry, or a disconnect if data has moved
        end
        TRANSFER:
        if (irdy_i) begin
          trdy_o <= 0;
          state_q <= stop_o ? BACKOFF : DECIDE;
          addr_q <= addr_q + (wide_q ? 32'd8 : 32'd4);
          read_second_q <= !config_q && !write_q;
        end
        default: ;
      endcase
    if (start) begin
      state_q <= DECODE;
      addr_q <= ad_i[31:0];
      command_q <= cbe_i[3:0];
      req64_q <= req64_i;
      idsel_q <= idsel_i;
      linear_q <= ad_i[1:0] == 0;
      read_second_q <= 0;
      wide_q <= 0;
    end
    if (rst_i) begin
      state_q <= IDLE;
      frame_q <= 0;
      read_second_q <= 0;
      {oe_o, trdy_o, stop_o, devsel_o, ack64_o, ad_oe_o, ad64_oe_o} <= '0;
    end
  end
  assign config_write_o = transfer && config_q && write_q;
  assign config_index_o = addr_q[7:2];
  assign config_enable_o = be[3:0];
  assign config_wdata_o = ad_i[31:0];

  // ---- Written data, a cycle later, when its parity is known ----
  logic in_wide_q, in_memory_q, in_low, in_error;
  logic [15:2] in_addr_q;
  logic [63:0] in_data_q;
  logic [1:0] in_be_q;  // upper and lower half
  logic [15:3] low_addr_q;
  logic [31:0] low_data_q;
  logic push_write, low_alone;
  logic [63:0] push_data;
  assign in_error = in_valid_q && (parity_error_i || (in_wide_q && parity64_error_i));
  assign detected_parity_o = in_error;
  assign in_low = in_valid_q && in_memory_q && !in_wide_q && !in_addr_q[2] && in_be_q[0];
  assign low_taken = in_low && in_addr_q[15:3] == addr_q[15:3];
  assign low_alone = low_valid_q && low_end_q;  // the burst is over
  always_comb begin
    push_write = 0;
    push_data = in_data_q;
    if (in_valid_q && in_memory_q && !in_error) begin
      if (in_wide_q) begin
        push_write = in_be_q[0];
        if (!in_be_q[1]) push_data[63:32] = '0;
      end else begin
        push_write = in_addr_q[2] && low_valid_q;
        push_data = {in_be_q[0] ? in_data_q[31:0] : 32'b0, low_data_q};
      end
    end else if (low_alone) begin
      push_write = 1;
      push_data = {32'b0, low_data_q};
    end
  end
  always_ff @(posedge clk_i) begin
    in_valid_q <= transfer && write_q;
    in_end_q <= finish;
    in_memory_q <= !config_q;
    in_wide_q <= wide_q;
    in_addr_q <= addr_q[15:2];
    in_data_q <= ad_i;
    in_be_q <= {be[7], be[0]};
    perr_o <= in_error;
    low_end_q <= in_end_q;
    if (in_low) begin
      low_valid_q <= !in_error && !target_abort_o;
      low_addr_q <= in_addr_q[15:3];
      low_data_q <= in_data_q[31:0];
    end else if (in_valid_q || low_end_q) low_valid_q <= 0;
    if (rst_i) {in_valid_q, in_end_q, low_end_q, low_valid_q, perr_o} <= '0;
  end

  // ---- Accesses in order ----
  logic [15:3] push_addr;
  assign push_addr = read_latch ? addr_q[15:3] : low_alone ? low_addr_q : in_addr_q[15:3];
  sync_fifo #(.W(1 + 13 + 64), .DEPTH(FIFO_DEPTH)) posted (
      .clk_i, .rst_i, .write_i(push_write | read_latch), .wdata_i({!read_latch, push_addr, push_data}),
      .free_o(fifo_free), .count_o(), .some_o(fifo_some),
      .rdata_o({request_write_o, request_offset_o[15:3], request_wdata_o}),
      .read_i(request_pop_i));
  assign request_offset_o[2:0] = '0;
  assign request_valid_o = fifo_some;

  always_ff @(posedge clk_i) begin
    if (read_latch) begin
      read_pending_q <= 1;
      read_done_q <= 0;
      read_addr_q <= addr_q[15:2];
      read_command_q <= command_q;
      read_wide_q <= wide_q;
    end
    if (rvalid_i) begin
      read_done_q <= 1;
      read_data_q <= rdata_i;
    end
    read_age_q <= read_done_q ? read_age_q + 1 : '0;
    if (read_pending_q && read_done_q && (read_take || read_age_q[15])) begin
      read_pending_q <= 0;
      read_done_q <= 0;
    end
    if (rst_i) {read_pending_q, read_done_q} <= '0;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(push_write && read_latch)) else $error("pci_target: a write and a read enter the FIFO together");
      assert (!(rvalid_i && !read_pending_q)) else $error("pci_target: read data without a request");
    end
`endif
endmodule
