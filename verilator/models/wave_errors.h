// SPDX-License-Identifier: Apache-2.0
// Between fst_writer.cpp, which writes waves, and wave_file.h, which wants to know whether they
// were written, to say what they are of and to leave signals out.
#pragma once

class VerilatedFstC;

/// Leaves a comment in an open file, where readers look for them: among the names of signals.
void comment_waves(VerilatedFstC& file, const char* text);

/// Opens a file with the signals alone that one of these patterns of * and ? names, one a line,
/// with or without the scopes around it, or whose scope one names; empty: all. The first pattern
/// that names nothing, or -1.
[[nodiscard]] int open_waves(VerilatedFstC& file, const char* path, const char* patterns);

/// Where the writer leaves the errno of the first thing that fails in this thread; null: nowhere.
extern thread_local int* wave_error;
