// SPDX-License-Identifier: Apache-2.0
// Latency in cycles of each kind of operator, as one structure: the parameter LAT of pipes and their units. A module
// ignores the latency of operators that it does not have. Tops have LAT_ADD and so on as separate parameters.
// If Verilator reads a module alone, LAT is a literal of 160 bits, add first.
package latency_pkg;
  typedef struct packed {
    int add;   // add, sub
    int mul;
    int div;
    int sqrt;
    int cmp;   // comparisons, min, max
  } latency_t;
  localparam logic [159:0] ONES = {5{32'd1}};
  function automatic latency_t latencies(input int add, input int mul, input int div, input int sqrt, input int cmp);
    latencies = {add, mul, div, sqrt, cmp};
  endfunction
  function automatic int mean(input latency_t lat);  // average, rounded up
    mean = (lat.add + lat.mul + lat.div + lat.sqrt + lat.cmp + 4) / 5;
  endfunction
endpackage
