// SPDX-License-Identifier: Apache-2.0
// Slots and records, in words of the container width. host/include/cde/contract/records.hpp is the same in C++.
package records_pkg;
  // words of a DDR beat, 288 bits in fp32; slots are packed, one word per word of the shape
  localparam int DDR_WORDS = 9;
  localparam int MOST_PRIMARIES = 256;  // most slots of the primary register file

  localparam int RECORD_WORDS = 7;
  localparam int RECORD_CP = 0;       // 3 words
  localparam int RECORD_FLAGS = 3;    // record_flags_t
  localparam int RECORD_INDEX = 4;    // secondary index; all ones if nothing was found
  localparam int RECORD_T = 5;
  localparam int RECORD_PRIMARY = 6;
  // With normals, a second record follows: n x y z in the words of CP, the signed distance in T, the same index and
  // primary.
  typedef struct packed {
    logic normal;  // this is the second record
    logic bad;     // bad input
    logic f;       // F
  } record_flags_t;

  // ---- Entries of the object tables, in words of the container width. Both parts are written in ascending order. The
  // range takes effect with its second word, the transform with its last ----
  localparam int OBJECT_WORDS = 16;        // distance between entries
  localparam int OBJECT_FIRST = 0;         // first slot
  localparam int OBJECT_COUNT = 1;         // slots
  localparam int OBJECT_ROTATION = 2;      // 9 words, row by row
  localparam int OBJECT_TRANSLATION = 11;  // 3 words
  localparam int OBJECT_END = 14;          // words in use
endpackage
