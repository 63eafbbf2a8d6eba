// SPDX-License-Identifier: Apache-2.0
// Scatter-gather DMA: serves a ring of descriptors in host memory (pci_pkg::PCI_DESCRIPTOR_*). It moves data between
// host memory and the local bus, and writes a completion record per descriptor into a second ring.
//
// Every host address is a mapped address. The module looks up all pages of a descriptor before its first bus cycle, and
// again the page of each burst at its start. A burst does not cross a page. The master never waits. A burst to the card
// starts when there is room for its data, and a burst to the host when all its data is present.
// After an error, data already moved stays moved. The completion record says how much it is, and the ring halts. If the
// descriptor or the record itself cannot be reached, only the registers report the error.
// Latency: 9 cycles per descriptor and 4 per burst, plus the bus.
// Throughput: one word per cycle.
// Stall: FIFO room and the bus.
module pci_dma (
    input logic clk_i,
    input logic rst_i,
    output logic active_o,

    input logic run_i,
    input logic clear_i,
    input logic [23:0] ring_base_i,
    input logic [15:0] ring_size_i,
    input logic [15:0] ring_tail_i,
    input logic [23:0] completion_base_i,
    input logic [12:0] burst_i,
    output logic [15:0] head_o,
    output logic busy_o,
    output logic completion_o,
    output logic fault_o,
    output logic [7:0] code_o,
    output logic [7:0] where_o,
    output logic [31:0] fault_addr_o,
    input logic [15:0] pci_status_i,

    output logic [11:0] page_o,
    input logic page_valid_i,
    input logic page_writable_i,
    input logic [31:pci_pkg::PCI_PAGE_BITS] page_frame_i,

    output logic start_o,
    output logic write_o,
    output logic [31:3] addr_o,
    output logic [9:0] qwords_o,
    output logic [63:0] wdata_o,
    input logic wpop_i,
    input logic rvalid_i,
    input logic [63:0] rdata_i,
    input logic done_i,
    input logic [7:0] done_code_i,
    input logic [31:0] done_addr_i,
    input logic [9:0] moved_i,

    output logic local_valid_o,  // a request for the local bus: a word to write, or a number of words to read
    output logic local_write_o,
    output logic [registers_pkg::SPACE_BITS-1:0] local_space_o,
    output logic [31:0] local_offset_o,
    output logic [63:0] local_data_o,
    input logic local_ready_i,
    input logic local_rvalid_i,
    input logic [63:0] local_rdata_i
);
  import pci_pkg::*;
  localparam int DEPTH = 1024;  // words: two bursts of the greatest length
  localparam int CHUNK = 32;    // words per request on the local bus
  localparam int DW = $clog2(DEPTH) + 1;
  localparam logic [3:0] IDLE = 0, LOOKUP = 1, LOOKED = 2, READY = 3, MOVE = 4, DECODE = 5, NEXT_PAGE = 6, DRAIN = 7,
      FLUSH = 8, RECORD = 9, NEXT = 10;

  // ---- State ----
  logic [3:0] state_q;
  logic [7:0] purpose_q;  // PCI_WHERE_*: purpose of the address lookup
  logic checking_q;       // the pages of a descriptor are being looked up
  logic [15:0] head_q, head_next;
  logic lap_q, word_q;    // parity of the lap; next word of the descriptor or record
  logic [31:0] mapped_q;  // address to look up
  logic [31:3] bus_q;     // bus address found
  logic [31:0] host_q, bytes_q, remaining_q;  // of the descriptor: address, bytes, bytes still to move
  logic [31:0] offset_q;
  logic [registers_pkg::SPACE_BITS-1:0] space_q;
  logic to_host_q, irq_q, bad_flags_q;
  logic [1:0] fetched_q;
  logic [7:0] code_q;
  logic [31:0] fault_q;
  logic [12:0] to_page_end, burst, burst_q;
  logic refused;
  logic [7:0] refused_code;

  // ---- FIFOs ----
  logic in_some;
  logic [DW-1:0] in_free, out_free, out_count;
  logic [63:0] in_head, out_head;
  logic data_read, flush;
  logic [DW-1:0] outstanding_q;  // words requested and not received
  assign data_read = purpose_q == PCI_WHERE_DATA;
  assign flush = state_q == FLUSH && outstanding_q == 0;
  sync_fifo #(.W(64), .DEPTH(DEPTH)) inbound (
      .clk_i, .rst_i, .write_i(rvalid_i && data_read), .wdata_i(rdata_i), .free_o(in_free), .count_o(),
      .some_o(in_some), .rdata_o(in_head), .read_i(local_valid_o && local_ready_i && local_write_o));
  sync_fifo #(.W(64), .DEPTH(DEPTH)) outbound (
      .clk_i, .rst_i(rst_i | flush), .write_i(local_rvalid_i), .wdata_i(local_rdata_i), .free_o(out_free),
      .count_o(out_count), .some_o(), .rdata_o(out_head), .read_i(wpop_i && data_read));

  // ---- Local bus ----
  logic [28:0] unrequested_q;   // words of the descriptor not requested yet
  logic [31:0] local_q;     // offset of the next request
  logic [5:0] chunk;
  logic local_read;
  assign chunk = unrequested_q < 29'(CHUNK) ? unrequested_q[5:0] : 6'(CHUNK);
  assign local_read = unrequested_q != 0 && out_free >= outstanding_q + DW'(CHUNK);
  assign local_write_o = in_some;
  assign local_valid_o = local_write_o || local_read;
  assign local_space_o = space_q;
  assign local_offset_o = local_q;
  assign local_data_o = local_write_o ? in_head : 64'(chunk);

  // ---- Bursts and records ----
  logic [63:0] record_first, record_second;
  always_comb begin
    record_first = {bytes_q - remaining_q, fault_q};
    record_first[PCI_COMPLETION_LAP_FIRST] = lap_q;  // bytes are a multiple of 8
    record_second = '0;
    record_second[PCI_COMPLETION_NUMBER+:16] = head_q;
    record_second[PCI_COMPLETION_PCI+:16] = pci_status_i;
    record_second[PCI_COMPLETION_CODE+:8] = code_q;
    record_second[PCI_COMPLETION_LAP] = lap_q;
  end
  assign to_page_end = 13'd4096 - {1'b0, mapped_q[11:0]};
  assign burst = remaining_q < 32'(burst_i) ? (remaining_q[12:0] < to_page_end ? remaining_q[12:0] : to_page_end) :
      (burst_i < to_page_end ? burst_i : to_page_end);
  assign start_o = state_q == MOVE;
  assign write_o = (data_read && to_host_q) || purpose_q == PCI_WHERE_COMPLETION;
  assign addr_o = bus_q;
  assign qwords_o = purpose_q == PCI_WHERE_DESCRIPTOR ? 10'd4 : purpose_q == PCI_WHERE_COMPLETION ? 10'd2 :
      burst_q[12:3];
  assign wdata_o = data_read ? out_head : word_q ? record_second : record_first;
  assign page_o = mapped_q[23:12];
  assign refused = mapped_q[31:24] != 0 || !page_valid_i || (write_o && !page_writable_i);
  assign refused_code = (mapped_q[31:24] != 0 || !page_valid_i) ? PCI_CODE_UNMAPPED : PCI_CODE_READ_ONLY;

  assign head_next = head_q + 1 == ring_size_i ? '0 : head_q + 1;
  assign head_o = head_q;
  assign busy_o = state_q != IDLE;
  assign active_o = busy_o || (run_i && head_q != ring_tail_i) || clear_i || local_valid_o;
  assign completion_o = state_q == NEXT && irq_q;
  assign fault_o = (state_q == NEXT && code_q != PCI_CODE_OK) ||
      (flush && !in_some && purpose_q != PCI_WHERE_DATA);
  assign code_o = code_q;
  assign where_o = state_q == NEXT ? PCI_WHERE_DATA : purpose_q;
  assign fault_addr_o = fault_q;

  // After an error in any state, data in flight is received or dropped before the error is reported.
  logic [7:0] error;
  logic [31:0] error_addr;
  always_comb begin
    error = PCI_CODE_OK;
    error_addr = mapped_q;
    if (state_q == LOOKED && refused) error = refused_code;
    else if (state_q == MOVE && done_i) begin
      error = done_code_i;
      error_addr = done_addr_i;
    end else if (state_q == DECODE) begin
      error_addr = host_q;
      if (bytes_q == 0 || bytes_q[2:0] != 0) error = PCI_CODE_LENGTH;
      else if (host_q[2:0] != 0 || offset_q[2:0] != 0 || bad_flags_q) error = PCI_CODE_ALIGNMENT;
    end
  end

  always_ff @(posedge clk_i) begin
    case (state_q)
      IDLE:
      if (run_i && head_q != ring_tail_i) begin
        state_q <= LOOKUP;
        purpose_q <= PCI_WHERE_DESCRIPTOR;
        mapped_q <= {8'b0, ring_base_i} + {11'b0, head_q, 5'b0};
        fetched_q <= '0;
        {bytes_q, remaining_q} <= '0;
        irq_q <= 0;
        code_q <= PCI_CODE_OK;
        fault_q <= '0;
      end
      LOOKUP: state_q <= LOOKED;
      LOOKED: begin
        burst_q <= burst;
        bus_q <= {page_frame_i, mapped_q[11:3]};
        state_q <= checking_q ? NEXT_PAGE : READY;
      end
      NEXT_PAGE: begin
        if (remaining_q <= 32'(to_page_end)) begin
          checking_q <= 0;
          mapped_q <= host_q;
          remaining_q <= bytes_q;
          unrequested_q <= to_host_q ? bytes_q[31:3] : '0;
        end else begin
          mapped_q <= mapped_q + 32'(to_page_end);
          remaining_q <= remaining_q - 32'(to_page_end);
        end
        state_q <= LOOKUP;
      end
      READY:
      if (!data_read || (to_host_q ? out_count >= DW'(burst_q[12:3]) : in_free >= DW'(burst_q[12:3]))) state_q <= MOVE;
      MOVE:
      if (done_i) begin
        if (purpose_q == PCI_WHERE_DESCRIPTOR) state_q <= DECODE;
        else if (purpose_q == PCI_WHERE_COMPLETION) state_q <= NEXT;
        else begin
          mapped_q <= mapped_q + {19'b0, moved_i, 3'b0};
          remaining_q <= remaining_q - {19'b0, moved_i, 3'b0};
          state_q <= remaining_q == 32'(burst_q) ? DRAIN : LOOKUP;
        end
      end
      DECODE: begin
        state_q <= LOOKUP;
        purpose_q <= PCI_WHERE_DATA;
        checking_q <= 1;
        mapped_q <= host_q;
        local_q <= offset_q;
      end
      DRAIN: if (!in_some) state_q <= RECORD;
      FLUSH: begin
        unrequested_q <= '0;
        if (flush && !in_some) state_q <= purpose_q == PCI_WHERE_DATA ? RECORD : IDLE;
      end
      RECORD: begin
        state_q <= LOOKUP;
        purpose_q <= PCI_WHERE_COMPLETION;
        mapped_q <= {8'b0, completion_base_i} + {12'b0, head_q, 4'b0};
        word_q <= 0;
      end
      NEXT: begin
        state_q <= IDLE;
        head_q <= head_next;
        lap_q <= lap_q ^ (head_next == 0);
      end
      default: state_q <= IDLE;
    endcase
    if (error != PCI_CODE_OK) begin
      state_q <= FLUSH;
      checking_q <= 0;
      code_q <= error;
      fault_q <= error_addr;
      if (state_q == DECODE) purpose_q <= PCI_WHERE_DATA;
      if (checking_q || state_q == DECODE) remaining_q <= bytes_q;
      unrequested_q <= '0;
    end
    if (rvalid_i && purpose_q == PCI_WHERE_DESCRIPTOR) begin
      fetched_q <= fetched_q + 1;
      if (fetched_q == 0) begin
        {bytes_q, host_q} <= rdata_i;
        remaining_q <= rdata_i[63:32];
      end
      if (fetched_q == 1) begin
        offset_q <= rdata_i[31:0];
        space_q <= rdata_i[PCI_DESCRIPTOR_SPACE+:registers_pkg::SPACE_BITS];
        to_host_q <= rdata_i[PCI_DESCRIPTOR_TO_HOST];
        irq_q <= rdata_i[PCI_DESCRIPTOR_IRQ];
        bad_flags_q <= |rdata_i[63:PCI_DESCRIPTOR_IRQ+1] ||
            |rdata_i[PCI_DESCRIPTOR_TO_HOST-1:PCI_DESCRIPTOR_SPACE+registers_pkg::SPACE_BITS];
      end
    end
    if (wpop_i && purpose_q == PCI_WHERE_COMPLETION) word_q <= 1;
    if (local_valid_o && local_ready_i) begin
      local_q <= local_q + (local_write_o ? 32'd8 : {23'b0, chunk, 3'b0});
      if (!local_write_o) unrequested_q <= unrequested_q - 29'(chunk);
    end
    outstanding_q <= outstanding_q + ((local_valid_o && local_ready_i && !local_write_o) ? DW'(chunk) :
        '0) - DW'(local_rvalid_i);
    if (clear_i) begin
      head_q <= '0;
      lap_q <= 1;
    end
    if (rst_i) begin
      state_q <= IDLE;
      head_q <= '0;
      lap_q <= 1;
      checking_q <= 0;
      unrequested_q <= '0;
      outstanding_q <= '0;
      purpose_q <= PCI_WHERE_DATA;
    end
  end
endmodule
