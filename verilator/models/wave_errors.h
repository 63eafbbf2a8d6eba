// SPDX-License-Identifier: Apache-2.0
// Connects fst_writer.cpp, which writes waves, with wave_file.h, which checks for errors, adds
// comments and selects signals.
#pragma once

class VerilatedFstC;

/// Adds a comment to an open file among the names of signals, where readers look for it.
void comment_waves(VerilatedFstC& file, const char* text);

/// Opens a file for the signals that match one of these patterns of * and ?, one per line; an empty
/// text selects all. A pattern matches a signal with or without its scopes, or a scope of it.
/// Returns the first pattern that matches nothing, or -1.
[[nodiscard]] int open_waves(VerilatedFstC& file, const char* path, const char* patterns);

/// Where the writer stores the errno of the first failure in this thread; null: nowhere.
extern thread_local int* wave_error;
